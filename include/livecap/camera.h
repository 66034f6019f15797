// A static pinhole camera with Brown-Conrady distortion, in OpenCV's conventions: x right, y down, z forward, pixel
// centres at integer coordinates.
#pragma once

#include <array>
#include <filesystem>
#include <optional>

namespace livecap {

// The floor that the person stands on, in the camera's frame. A point p is dot(normal, p) + distance_mm above it.
struct FloorPlane {
  std::array<double, 3> normal{0, -1, 0};  // unit, up, out of the floor
  double distance_mm = 0;                  // how far above it the camera is
};

struct Camera {
  int width = 0;                       // px
  int height = 0;                      // px
  double fx = 0;                       // px
  double fy = 0;                       // px
  double cx = 0;                       // px
  double cy = 0;                       // px
  std::array<double, 5> distortion{};  // k1, k2, p1, p2, k3
  std::optional<FloorPlane> floor{};   // where it was measured, or found before

  bool has_distortion() const;
  // Throws ConfigError when a size or focal length is not positive or the principal point is not finite, for a lens
  // that cannot be (angles, focal lengths more than a factor of 2 apart, distortion that folds the picture), and for a
  // floor that cannot be: a normal that is not of unit length (within 0.001) or points down, a camera that is not above
  // it.
  void validate() const;
};

// Reads camera.json: {"width","height","fx","fy","cx","cy","distortion":[k1,k2,p1,p2,k3]} and optionally
// "floor":{"normal":[x,y,z],"distance_mm":d}. Throws IoError naming the file and the field.
Camera load_camera(const std::filesystem::path& path);

// A camera without distortion from its vertical or horizontal field of view, whichever side is longer.
// fov_deg: degrees, in (1, 170). Throws ConfigError.
Camera camera_from_fov(int width, int height, double fov_deg);

// Throws IoError naming the file.
void save_camera(const Camera& camera, const std::filesystem::path& path);

}  // namespace livecap
