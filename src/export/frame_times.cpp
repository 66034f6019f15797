#include "export/frame_times.h"

#include <cmath>

#include "base/text.h"

namespace livecap {

std::vector<double> uneven_times_s(std::span<const double> pts_ms, double fps) {
  std::vector<double> times_s;
  bool uneven = false;
  for (const double pts : pts_ms) {
    const double time_s = (pts - pts_ms[0]) / 1000;
    if (!std::isfinite(time_s) || (!times_s.empty() && time_s <= times_s.back())) return {};
    uneven = uneven || std::abs(time_s * fps - static_cast<double>(times_s.size())) > 0.5;
    times_s.push_back(time_s);
  }
  return uneven ? times_s : std::vector<double>{};
}

std::string uneven_warning(const std::string& source, double fps, const std::string& timed, const std::string& even) {
  return source + format(": its frames do not come evenly at %g a second; ", fps) + timed + " has their times, in " +
         even + " they follow each other at that rate";
}

}  // namespace livecap
