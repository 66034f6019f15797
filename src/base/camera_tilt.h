// How a camera is turned above a floor, as people say it.
#pragma once

#include <algorithm>
#include <cmath>
#include <numbers>

#include "livecap/camera.h"

namespace livecap {

struct CameraTilt {
  double down_deg = 0;  // how far the camera looks down,
  double roll_deg = 0;  //   and how far what is upright leans to the right in its picture
};

inline CameraTilt tilt_above(const FloorPlane& floor) {
  constexpr double kDegPerRad = 180 / std::numbers::pi;
  const auto& [x, y, z] = floor.normal;
  return {std::asin(std::clamp(-z, -1.0, 1.0)) * kDegPerRad, std::atan2(x, -y) * kDegPerRad};
}

}  // namespace livecap
