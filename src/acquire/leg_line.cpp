#include "acquire/leg_line.h"

#include <algorithm>

namespace livecap::acquire {

using Eigen::Vector3d;

Vector3d LegLine::at(double y) const {
  const bool thigh = y > knee.y();
  const Vector3d &top = thigh ? hip : knee, &bottom = thigh ? knee : ankle;
  const double share = (top.y() - y) / std::max(1.0, top.y() - bottom.y());
  return top + std::clamp(share, 0.0, 1.0) * (bottom - top);
}

bool around_both_legs(const LegLine& left, const LegLine& right, const Volume& volume, double y, double slack_mm) {
  const Vector3d from = left.at(y), to = right.at(y);
  constexpr int kSteps = 8;
  for (int i = 0; i <= kSteps; ++i)
    if (volume.at(from + (static_cast<double>(i) / kSteps) * (to - from)) > slack_mm) return false;
  return true;
}

}  // namespace livecap::acquire
