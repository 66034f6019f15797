#include "acquire/leg_line.h"

#include <algorithm>
#include <cmath>

#include "geometry/segment.h"

namespace livecap::acquire {

using Eigen::Vector3d;

Vector3d LegLine::at(double y) const {
  const bool thigh = y > knee.y();
  const Vector3d &top = thigh ? hip : knee, &bottom = thigh ? knee : ankle;
  const double share = (top.y() - y) / std::max(1.0, top.y() - bottom.y());
  return top + std::clamp(share, 0.0, 1.0) * (bottom - top);
}

double LegLine::gap_to(const Vector3d& p) const {
  constexpr double kTopRadius = 0.208, kKneeRadius = 0.147;  // of the thigh's length
  const double length = (knee - hip).norm(), on_thigh = segment_parameter(p, hip, knee),
               on_shank = segment_parameter(p, knee, ankle);
  const double off_thigh =
      (p - hip - on_thigh * (knee - hip)).norm() - length * std::lerp(kTopRadius, kKneeRadius, on_thigh);
  const double off_shank = (p - knee - on_shank * (ankle - knee)).norm() - length * kKneeRadius;
  return std::min(off_thigh, off_shank);
}

LegLine leg_line(const BodyJoints& joints, int thigh) {
  return {joints[thigh], joints[thigh + 1], joints[thigh + 2]};
}

bool around_both_legs(const LegLine& left, const LegLine& right, const Volume& volume, double y, double slack_mm) {
  const Vector3d from = left.at(y), to = right.at(y);
  constexpr int kSteps = 8;
  for (int i = 0; i <= kSteps; ++i)
    if (volume.at(from + (static_cast<double>(i) / kSteps) * (to - from)) > slack_mm) return false;
  return true;
}

}  // namespace livecap::acquire
