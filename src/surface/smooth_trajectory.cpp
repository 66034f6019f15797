#include "surface/smooth_trajectory.h"

#include "livecap/error.h"

namespace livecap {
namespace {
constexpr float kNeighborWeight = 0.15f;
constexpr float kOwnWeight = 0.7f;
}  // namespace

void smooth_frame(std::span<const float> previous, std::span<const float> current, std::span<const float> next,
                  std::span<float> out) {
  if (previous.empty()) previous = current;
  if (next.empty()) next = current;
  if (previous.size() != current.size() || next.size() != current.size() || out.size() != current.size()) {
    throw LogicError("smooth_frame: frames of different sizes");
  }
  for (size_t i = 0; i < current.size(); ++i) {
    out[i] = kNeighborWeight * (previous[i] + next[i]) + kOwnWeight * current[i];
  }
}

void smooth_trajectory(std::vector<std::vector<float>>& frames) {
  std::vector<float> previous, original;  // previous: the unsmoothed frame t-1
  for (size_t t = 0; t < frames.size(); ++t) {
    original = frames[t];
    const std::span<const float> next =
        t + 1 < frames.size() ? std::span<const float>(frames[t + 1]) : std::span<const float>();
    smooth_frame(previous, original, next, frames[t]);
    std::swap(previous, original);
  }
}

}  // namespace livecap
