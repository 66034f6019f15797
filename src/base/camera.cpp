#include "livecap/camera.h"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "base/floor_plane.h"
#include "base/fov_range.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr double kNarrowestDeg = 0.1;  // the longest telephoto lenses see half a degree
constexpr double kCalibrated = 0.8;    // of the way to a corner
constexpr double kMostSqueezed = 2.2;  // anamorphic lenses have 2
constexpr double kMostMoved = 4;       // a corner, by its lens, as a multiple of its distance from the axis

double degrees(double tangent) {
  return std::atan(tangent) * 180 / M_PI;
}

// Intrinsics in mm, in shares of the picture or of another picture's size are numbers as well.
void validate_angles(const Camera& c) {
  if (!(c.fx / c.fy <= kMostSqueezed && c.fy / c.fx <= kMostSqueezed))
    throw ConfigError(
        format("camera: focal lengths fx %g, fy %g: one is more than %g times the other; both are in pixels "
               "of the picture",
               c.fx, c.fy, kMostSqueezed));
  const double side = degrees(std::max(std::max(std::abs(c.cx), std::abs(c.width - 1 - c.cx)) / c.fx,
                                       std::max(std::abs(c.cy), std::abs(c.height - 1 - c.cy)) / c.fy));
  const double whole = 2 * degrees(0.5 * std::max(c.width / c.fx, c.height / c.fy));
  if (side <= 0.5 * kFovDeg.most && whole >= kNarrowestDeg) return;
  const std::string angle =
      side > 0.5 * kFovDeg.most
          ? format("reaches %.4g degrees to a side of its axis, more than %g", side, 0.5 * kFovDeg.most)
          : format("is %.2g degrees wide, less than %g", whole, kNarrowestDeg);
  throw ConfigError(
      format("camera: a picture of %dx%d with fx %g, fy %g, cx %g, cy %g ", c.width, c.height, c.fx, c.fy, c.cx, c.cy) +
      angle + "; all of them are in pixels of that picture");
}

// A picture is folded where the radius r (1 + k1 r^2 + k2 r^4 + k3 r^6) of a point in it no longer grows with its
// angle. In the corners real calibrations do that: no board was seen there.
void validate_distortion(const Camera& c) {
  constexpr int kSteps = 64;
  const auto& [k1, k2, p1, p2, k3] = c.distortion;
  const double corner = std::hypot(std::max(std::abs(c.cx), std::abs(c.width - 1 - c.cx)) / c.fx,
                                   std::max(std::abs(c.cy), std::abs(c.height - 1 - c.cy)) / c.fy);
  const std::string numbers = format("camera: distortion k1 %g, k2 %g, p1 %g, p2 %g, k3 %g ", k1, k2, p1, p2, k3);
  const char* right = "; of OpenCV's lens model for this picture, without unit, in the order k1, k2, p1, p2, k3";
  double radial = 1;
  for (int i = 1; i <= kSteps * kCalibrated; ++i) {
    const double r = corner * i / kSteps, r2 = r * r;
    if (radial * r >= corner) break;  // outside of the picture
    radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    if (!(1 + r2 * (3 * k1 + r2 * (5 * k2 + r2 * 7 * k3)) > 0))
      throw ConfigError(numbers + format("folds the picture %.0f %% of the way to its corner", 100.0 * i / kSteps) +
                        right);
  }
  const double r2 = corner * corner;
  const double moved = 1 + r2 * (k1 + r2 * (k2 + r2 * k3)) + 3 * corner * (std::abs(p1) + std::abs(p2));
  if (!(moved <= kMostMoved))
    throw ConfigError(
        numbers + format("moves a corner to %.3g times its distance from the axis, more than %g", moved, kMostMoved) +
        right);
}

}  // namespace

bool Camera::has_distortion() const {
  for (double k : distortion) {
    if (k != 0) return true;
  }
  return false;
}

void Camera::validate() const {
  if (width <= 0 || height <= 0) throw ConfigError(format("camera: image size %dx%d is not positive", width, height));
  if (!(fx > 0) || !(fy > 0) || !std::isfinite(fx) || !std::isfinite(fy))
    throw ConfigError(format("camera: focal length fx %g, fy %g must be positive pixels", fx, fy));
  if (!std::isfinite(cx) || !std::isfinite(cy)) throw ConfigError("camera: principal point cx, cy is not finite");
  validate_angles(*this);
  for (double k : distortion) {
    if (!std::isfinite(k)) throw ConfigError("camera: a distortion coefficient is not finite");
  }
  if (has_distortion()) validate_distortion(*this);
  if (!floor) return;
  if (const std::string fault = fault_of(*floor); !fault.empty()) throw ConfigError("camera: " + fault);
}

Camera load_camera(const std::filesystem::path& path) {
  const std::string text = read_file(path);
  nlohmann::json json;
  try {
    json = nlohmann::json::parse(text);
  } catch (const nlohmann::json::exception& e) {
    throw IoError(path.string() + ": not valid JSON: " + e.what());
  }
  if (!json.is_object()) throw IoError(path.string() + ": expected a JSON object with width, height, fx, fy, cx, cy");
  auto number = [&](const char* field) -> double {
    if (!json.contains(field)) throw IoError(path.string() + ": field \"" + field + "\" is missing");
    if (!json[field].is_number()) throw IoError(path.string() + ": field \"" + field + "\" must be a number");
    return json[field].get<double>();
  };
  auto integer = [&](const char* field) -> int {
    const double value = number(field);
    if (!(value >= 1 && value <= 65536) || value != std::floor(value))
      throw IoError(path.string() +
                    format(": field \"%s\" is %g, must be a whole number of pixels in 1..65536", field, value));
    return static_cast<int>(value);
  };
  Camera camera;
  camera.width = integer("width");
  camera.height = integer("height");
  camera.fx = number("fx");
  camera.fy = number("fy");
  camera.cx = number("cx");
  camera.cy = number("cy");
  if (json.contains("distortion")) {
    const auto& list = json["distortion"];
    if (!list.is_array() || list.size() > 5)
      throw IoError(path.string() + ": field \"distortion\" must be a list of at most 5 numbers k1, k2, p1, p2, k3");
    for (size_t i = 0; i < list.size(); ++i) {
      if (!list[i].is_number())
        throw IoError(path.string() + format(": field \"distortion\"[%zu] must be a number", i));
      camera.distortion[i] = list[i].get<double>();
    }
  }
  if (json.contains("floor")) camera.floor = floor_from_json(json["floor"], path.string());
  try {
    camera.validate();
  } catch (const ConfigError& e) {
    throw IoError(path.string() + ": " + e.what());
  }
  return camera;
}

Camera camera_from_fov(int width, int height, double fov_deg) {
  require_within("--fov", fov_deg, kFovDeg, "degrees");
  Camera camera;
  camera.width = width;
  camera.height = height;
  const double longer = std::max(width, height);
  camera.fx = camera.fy = 0.5 * longer / std::tan(0.5 * fov_deg * M_PI / 180);
  camera.cx = 0.5 * (width - 1);
  camera.cy = 0.5 * (height - 1);
  camera.validate();
  return camera;
}

void save_camera(const Camera& camera, const std::filesystem::path& path) {
  nlohmann::ordered_json json;
  json["width"] = camera.width;
  json["height"] = camera.height;
  json["fx"] = camera.fx;
  json["fy"] = camera.fy;
  json["cx"] = camera.cx;
  json["cy"] = camera.cy;
  json["distortion"] = camera.distortion;
  if (camera.floor) json["floor"] = floor_json(*camera.floor);
  write_file_atomically(path, json.dump(2) + "\n");
}

}  // namespace livecap
