// One picture of the person standing still, and where its camera was.
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "base/image_rgb.h"
#include "livecap/camera.h"

namespace livecap {

struct View {
  std::string name;                      // of the picture
  Camera camera;                         // without distortion, the size of the pictures below
  Eigen::Isometry3d camera_from_world =  // OpenCV axes; in the world's units until move_views (acquire), then mm
      Eigen::Isometry3d::Identity();
  ImageRgb image;           // undistorted
  ImageGray mask;           // > 127 = person; empty: not known
  bool exact_mask = false;  // given with the picture: no other view overrules it
  ImageGray labels;         // LIP ids; empty: not known

  // Where the camera is, in the world.
  Eigen::Vector3d center() const { return camera_from_world.inverse().translation(); }

  // Pixel of a point of the world; false behind the camera.
  bool project(const Eigen::Vector3d& world, Eigen::Vector2d& pixel) const {
    const Eigen::Vector3d p = camera_from_world * world;
    if (!(p.z() > 1e-9)) return false;
    pixel = {camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy};
    return true;
  }
};

}  // namespace livecap
