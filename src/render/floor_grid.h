// A floor under free views: lines every half metre and a soft shadow, darkest where the body is close to it, so that
// one sees where feet stand and whether they slide or float.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>

#include "base/image_rgb.h"
#include "pose/floor.h"
#include "render/viewpoint.h"

namespace livecap::render {

class FloorGrid {
 public:
  // place_mm: what the lines lie around, camera frame; one of them points to the capturing camera.
  FloorGrid(const Floor& floor, const Eigen::Vector3d& place_mm);

  // Over what is on the canvas, which has the view's size. positions: [3*n] mm, camera frame, of who stands there;
  // empty: nobody. Nothing from below the floor.
  void draw(const Viewpoint& view, std::span<const float> positions, std::span<const int32_t> triangles,
            ImageRgb& canvas) const;

 private:
  Floor floor_;
  Eigen::Vector3d origin_;            // on the floor
  Eigen::Matrix<double, 2, 3> axes_;  // along the lines
};

}  // namespace livecap::render
