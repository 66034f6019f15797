// From where a capture is looked at: the capturing camera at another size, or a camera that stands about the person.
// All points mm; "camera frame" is the capturing camera's.
#pragma once

#include <Eigen/Geometry>
#include <span>

#include "livecap/camera.h"

namespace livecap::render {

struct Viewpoint {
  Camera camera;  // without distortion
  Eigen::Isometry3d view_from_camera = Eigen::Isometry3d::Identity();
};

// Where a picture lies that is made as large as another has room for and put in its middle, px.
struct FittedBox {
  int left = 0, top = 0, width = 0, height = 0;
};
FittedBox fitted_box(int width, int height, int into_width, int into_height);

// The camera of pictures that are fitted so.
Camera fitted_camera(const Camera& camera, int width, int height);

// Where somebody is looked at and what is up there. Azimuth 0 is the side of the capturing camera, 90 the left of a
// person who faces it.
struct Surroundings {
  Eigen::Vector3d place_mm;  // looked at
  Eigen::Vector3d up;        // unit
};

struct Angles {
  double azimuth_deg = 0;
  double elevation_deg = 0;  // -90..90, above the horizon
};

// Looks at the place from a distance. fitted: gives size and focal length; the place is in the middle of the picture.
Viewpoint viewpoint_about(const Camera& fitted, const Surroundings& around, const Angles& from, double distance_mm);

// The least distance from which all points are seen, each as a ball of margin_mm.
double distance_to_see(std::span<const Eigen::Vector3d> points_mm, double margin_mm, const Camera& fitted,
                       const Surroundings& around, const Angles& from);

}  // namespace livecap::render
