#include "render/scene.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "actor/posed_vertices.h"
#include "base/text.h"
#include "eval/body_points.h"
#include "geometry/mesh.h"
#include "livecap/error.h"
#include "picture/overlay.h"
#include "picture/resample.h"
#include "picture/side_by_side.h"
#include "render/bone_lines.h"

namespace livecap::render {
namespace {

constexpr int kMaxDrawnSide = 16384;   // samples; a picture of this side squared takes 2.7 GB while it is painted
constexpr double kElevationDeg = 8;    // of views about the person: enough to see the floor
constexpr double kBodyMarginMm = 170;  // from a joint to what is farthest out around it, and some air
constexpr int kOrbitSteps = 24;        // from which it is found how far away the camera has to be
constexpr float kChecksMm = 50;
constexpr double kWireShare = 1 / 900.0;  // of the picture's height

double azimuth_of(const RenderOptions& options) {
  if (options.azimuth_deg) return *options.azimuth_deg;
  return options.view == "left" ? 90 : options.view == "back" ? 180 : options.view == "right" ? -90 : 0;
}

Angles angles_at(const RenderOptions& options, double share) {
  return {azimuth_of(options) + (options.orbit ? 360 * share : 0), options.elevation_deg.value_or(kElevationDeg)};
}

// A bar with the colours of the scale at the lower left.
void draw_scale(double largest_mm, ImageRgb& canvas) {
  cv::Mat picture(canvas.height, canvas.width, CV_8UC3, canvas.pixels.data());
  const double font = std::max(0.35, canvas.height / 1700.0);
  const int unit = std::max(4, canvas.height / 100), left = 2 * unit, top = canvas.height - 3 * unit;
  const int length = std::max(20, canvas.width / 3);
  for (int x = 0; x < length; ++x) {
    const Rgb color = heat_color(static_cast<double>(x) / (length - 1));
    cv::line(picture, {left + x, top}, {left + x, top + unit}, {color[0], color[1], color[2]});
  }
  for (const bool outline : {true, false}) {
    const cv::Scalar color = outline ? cv::Scalar(255, 255, 255) : cv::Scalar(30, 30, 30);
    const int thickness = outline ? 3 : 1;
    cv::putText(picture, "0", {left, top - unit / 2}, cv::FONT_HERSHEY_SIMPLEX, font, color, thickness, cv::LINE_AA);
    cv::putText(picture, format("%g mm", largest_mm), {left + length - 3 * unit, top - unit / 2},
                cv::FONT_HERSHEY_SIMPLEX, font, color, thickness, cv::LINE_AA);
  }
}

std::vector<float> moved(const std::vector<float>& positions, const Eigen::Isometry3d& transform) {
  std::vector<float> out(positions.size());
  for (size_t i = 0; i < positions.size(); i += 3)
    Eigen::Vector3f::Map(&out[i]) = (transform * Eigen::Vector3f::Map(&positions[i]).cast<double>()).cast<float>();
  return out;
}

// What was painted over black and over white, as colour and opacity.
ScenePicture separated(const ImageRgb& over_black, const ImageRgb& over_white) {
  ScenePicture picture{over_black, {over_black.width, over_black.height, {}}};
  for (size_t i = 0; i < over_black.pixels.size(); i += 3) {
    int alpha = 0;
    for (size_t k = i; k < i + 3; ++k)
      alpha = std::max(alpha, 255 - std::clamp(over_white.pixels[k] - over_black.pixels[k], 0, 255));
    for (size_t k = i; k < i + 3 && alpha > 0; ++k)
      picture.color.pixels[k] = static_cast<uint8_t>(std::min(255, (255 * over_black.pixels[k] + alpha / 2) / alpha));
    picture.alpha.pixels.push_back(static_cast<uint8_t>(alpha));
  }
  return picture;
}

// Displacement is measured from the captured pose, which is every angle of the actor's skeleton.
void require_angles(const CaptureFolder& capture) {
  const std::string file = (capture.path / "angles.csv").string();
  if (capture.angles.empty()) throw IoError(file + ": is missing; --style displacement needs it");
  const std::vector<std::string>& names = capture.angles.names;
  for (const Dof& dof : capture.actor.skeleton.dofs)
    if (std::find(names.begin(), names.end(), dof.name) == names.end())
      throw IoError(file + ": has no column \"" + dof.name +
                    "\"; --style displacement needs every angle of the actor's skeleton: capture it again");
}

}  // namespace

Scene::Scene(const Clip& clip, const RenderOptions& options)
    : clip_(clip),
      options_(options),
      fitted_(fitted_camera(clip.capture.camera, options.width > 0 ? options.width : clip.capture.camera.width,
                            options.height > 0 ? options.height : clip.capture.camera.height)),
      width_(options.side_by_side ? 2 * fitted_.width : fitted_.width),
      around_{clip.place_mm, clip.floor.up} {
  fitted_.distortion = {};
  if (const int64_t side = std::max(fitted_.width, fitted_.height); side * options.samples > kMaxDrawnSide)
    throw ConfigError(format("--samples %d: pictures of %dx%d are too large for it, at most %d px a side; see --size",
                             options.samples, fitted_.width, fitted_.height, kMaxDrawnSide / options.samples));
  backdrop_.emplace(options, fitted_.width, fitted_.height);
  if (options.skeleton) bones_ = bone_lines(clip.capture.actor.skeleton, clip.capture.joints.names);
  if (options.style == "displacement") require_angles(clip.capture);
  if (!options.is_about_person()) return;
  if (options.floor && !backdrop_->is_transparent()) floor_.emplace(clip.floor, clip.place_mm);
  if (options.distance_m) {
    distance_mm_ = 1000 * *options.distance_m;
    return;
  }
  std::vector<Eigen::Vector3d> points;
  for (int64_t row : clip.rows) {
    for (const Eigen::Vector3d& joint : clip.joints(row)) points.push_back(joint);
  }
  if (points.empty()) points.push_back(clip.place_mm);
  const int steps = options.orbit ? kOrbitSteps : 1;
  for (int step = 0; step < steps; ++step)
    distance_mm_ = std::max(distance_mm_, distance_to_see(points, kBodyMarginMm, fitted_, around_,
                                                          angles_at(options, static_cast<double>(step) / steps)));
}

Viewpoint Scene::viewpoint(double share) const {
  if (!options_.is_about_person()) return {fitted_, Eigen::Isometry3d::Identity()};
  return viewpoint_about(fitted_, around_, angles_at(options_, share), distance_mm_);
}

ScenePicture Scene::paint(const SceneFrame& frame) const {
  const Viewpoint view = viewpoint(frame.share);
  if (backdrop_->is_transparent()) {
    const auto over = [&](float gray) {
      return paint_over(plain_picture(fitted_.width, fitted_.height, {gray, gray, gray}), frame, view);
    };
    return separated(over(0), over(255));
  }
  ImageRgb picture = paint_over(backdrop_->picture(frame.video), frame, view);
  if (options_.style == "displacement") draw_scale(options_.scale_mm.value_or(kScaleMm), picture);
  if (options_.side_by_side) {
    const ImageRgb halves[] = {fitted_picture(frame.video, fitted_.width, fitted_.height), std::move(picture)};
    picture = side_by_side(halves);
  }
  return {std::move(picture), {}};
}

ImageRgb Scene::paint_over(ImageRgb picture, const SceneFrame& frame, const Viewpoint& view) const {
  const Actor& actor = clip_.capture.actor;
  if (floor_) floor_->draw(view, frame.vertices, actor.mesh.triangles, picture);
  if (frame.vertices.empty()) return picture;
  const std::vector<float> positions = moved(frame.vertices, view.view_from_camera);
  const std::vector<float> vertex_colors = colors(frame, positions);
  const int n = options_.samples;
  OverlayOptions look;
  look.alpha = static_cast<float>(options_.opacity);
  look.texture = options_.style == "texture";
  look.shading = options_.style != "normals";
  look.key_light = options_.style == "clay" || options_.style == "wire";
  look.colors = vertex_colors;
  if (options_.style == "checks") look.checks_mm = kChecksMm;
  if (options_.style == "wire") look.wire_px = static_cast<float>(std::max(0.7, kWireShare * picture.height) * n);
  picture = n == 1 ? render_overlay(actor, positions, view.camera, picture, look)
                   : averaged(render_overlay(actor, positions,
                                             fitted_camera(view.camera, n * view.camera.width, n * view.camera.height),
                                             repeated(picture, n), look),
                              n);
  if (!bones_.empty() && !frame.joints.empty())
    draw_bones(bones_, clip_.capture.joints.names, frame.joints, view, picture);
  return picture;
}

std::vector<float> Scene::colors(const SceneFrame& frame, const std::vector<float>& positions_view) const {
  const Actor& actor = clip_.capture.actor;
  std::vector<float> colors;
  if (options_.style == "normals") {
    // As normal maps have it: red to the right, green up, blue towards the viewer.
    const std::vector<float> normals = vertex_normals(positions_view, actor.mesh.triangles);
    for (size_t i = 0; i < normals.size(); ++i) colors.push_back(0.5f + (i % 3 == 0 ? 0.5f : -0.5f) * normals[i]);
  } else if (options_.style == "materials") {
    for (uint8_t label : actor.labels) {
      for (float channel : label_color(label)) colors.push_back(channel / 255);
    }
  } else if (options_.style == "displacement") {
    const std::optional<Pose> pose = captured_pose(clip_.capture, frame.row, captured_joints(clip_.capture, frame.row));
    if (!pose)
      throw IoError((clip_.capture.path / "angles.csv").string() +
                    format(": row %lld has no pose", static_cast<long long>(frame.row)));
    const std::vector<float> skinned =
        posed_vertices(actor, bone_dual_quats(forward_kinematics(actor.skeleton, *pose)));
    std::vector<double> distances;
    for (size_t i = 0; i < skinned.size(); i += 3)
      distances.push_back((Eigen::Vector3f::Map(&skinned[i]) - Eigen::Vector3f::Map(&frame.vertices[i])).norm());
    colors = heat_colors(distances, options_.scale_mm.value_or(kScaleMm));
  }
  return colors;
}

}  // namespace livecap::render
