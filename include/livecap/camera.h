// A static pinhole camera with Brown-Conrady distortion, in OpenCV's conventions: x right, y down, z forward, pixel
// centres at integer coordinates.
#pragma once

#include <array>
#include <filesystem>

namespace livecap {

struct Camera {
  int width = 0;                       // px
  int height = 0;                      // px
  double fx = 0;                       // px
  double fy = 0;                       // px
  double cx = 0;                       // px
  double cy = 0;                       // px
  std::array<double, 5> distortion{};  // k1, k2, p1, p2, k3

  bool has_distortion() const;
  // Throws ConfigError when a size or focal length is not positive or the principal point is not finite.
  void validate() const;
};

// Reads camera.json: {"width","height","fx","fy","cx","cy","distortion":[k1,k2,p1,p2,k3]}. Throws IoError naming the
// file and the field.
Camera load_camera(const std::filesystem::path& path);

// A camera without distortion from its vertical or horizontal field of view, whichever side is longer.
// fov_deg: degrees, in (1, 170).
Camera camera_from_fov(int width, int height, double fov_deg);

void save_camera(const Camera& camera, const std::filesystem::path& path);

}  // namespace livecap
