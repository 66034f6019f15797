#include "synth/rehearsal.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/imgproc.hpp>

#include "base/text.h"
#include "image/image_io.h"
#include "livecap/error.h"
#include "meshing/surface_parts.h"
#include "synth/numbered_files.h"
#include "synth/random.h"
#include "synth/renderer.h"

namespace livecap::synth {

namespace {

using Eigen::Vector3d;

constexpr char kPictureName[] = "%03d.png";

ActorModel subject_of(const Actor& actor) {
  ActorModel subject;
  subject.name = actor.name;
  subject.surface = meshing::surface_of(actor.mesh);
  const auto& r = actor.render;
  for (size_t i = 0; i < r.template_vertex.size(); ++i) {
    subject.atlas.vertex.push_back(r.template_vertex[i]);
    subject.atlas.uvs.emplace_back(r.uvs[2 * i], r.uvs[2 * i + 1]);
  }
  for (size_t i = 0; i < r.triangles.size(); i += 3)
    subject.atlas.triangles.emplace_back(r.triangles[i], r.triangles[i + 1], r.triangles[i + 2]);
  subject.texture = actor.texture;
  subject.labels = actor.labels;
  return subject;
}

// Three walks around the person: chest high, from above, and from below the knees.
View place_camera(const RehearsalOptions& options, int index, double middle_mm) {
  constexpr double kHeights[3] = {0.1, 0.9, -0.45};  // of the distance's half, above the middle
  const int ring = index % 3;
  const double turn = 2 * M_PI * (index + 0.31 * ring) / options.n_views;
  const Vector3d target(0, middle_mm, 0);
  Vector3d offset(std::sin(turn), 0.5 * kHeights[ring], std::cos(turn));
  offset *= options.distance_mm / offset.norm();
  Vector3d from = target + offset;
  from.y() = std::max(from.y(), 250.0);
  const Vector3d forward = (target - from).normalized();
  const double roll = 0.03 * std::sin(2.4 * index);
  const Vector3d right = Eigen::AngleAxisd(roll, forward) * forward.cross(Vector3d::UnitY()).normalized();
  View view;
  view.camera = camera_from_fov(options.width, options.height, options.fov_deg);
  view.camera_from_room_rotation << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  view.camera_from_room_translation = -view.camera_from_room_rotation * from;
  return view;
}

// A plain studio: a floor and a wall that get darker with distance, and a little grain.
Color backdrop(const View& view, int x, int y, uint64_t seed) {
  const Vector3d ray = view.camera_from_room_rotation.transpose() *
                       Vector3d((x - view.camera.cx) / view.camera.fx, (y - view.camera.cy) / view.camera.fy, 1);
  const Vector3d from = -view.camera_from_room_rotation.transpose() * view.camera_from_room_translation;
  const double down = ray.y() < -1e-3 ? -from.y() / ray.y() : 1e9;
  const Vector3d hit = from + down * ray;
  if (down > 0 && std::hypot(hit.x(), hit.z()) < 4500) {
    const double weave = cloud_noise(hit.x() / 60, hit.z() / 60, seed);
    return Color(0.28f, 0.25f, 0.22f) * static_cast<float>(0.8 + 0.4 * weave);
  }
  const double angle = std::atan2(ray.x(), ray.z()), rise = ray.y() / std::hypot(ray.x(), ray.z());
  const double cloud = cloud_noise(6 * angle, 5 * rise, seed + 1);
  return Color(0.42f, 0.46f, 0.50f) * static_cast<float>(0.75 + 0.4 * cloud);
}

// Label ids by painting triangles from far to near.
ImageGray label_image(const View& view, const ActorModel& subject) {
  const auto& surface = subject.surface;
  std::vector<Vector3d> camera_points;
  for (const Vector3d& p : surface.vertices) camera_points.push_back(view.to_camera(p));
  std::vector<double> depth(surface.triangles.size());
  for (size_t t = 0; t < depth.size(); ++t)
    for (int k = 0; k < 3; ++k) depth[t] += camera_points[surface.triangles[t][k]].z() / 3;
  std::vector<int> order(depth.size());
  std::iota(order.begin(), order.end(), 0);
  std::sort(order.begin(), order.end(), [&](int a, int b) { return depth[a] > depth[b]; });
  ImageGray image{view.camera.width, view.camera.height,
                  std::vector<uint8_t>(size_t(view.camera.width) * view.camera.height, 0)};
  cv::Mat canvas(image.height, image.width, CV_8UC1, image.pixels.data());
  constexpr int kShift = 4;
  for (int t : order) {
    const auto& tri = surface.triangles[t];
    cv::Point corners[3];
    for (int k = 0; k < 3; ++k) {
      const Vector3d& p = camera_points[tri[k]];
      corners[k] = {static_cast<int>(std::lround((view.camera.fx * p.x() / p.z() + view.camera.cx) * (1 << kShift))),
                    static_cast<int>(std::lround((view.camera.fy * p.y() / p.z() + view.camera.cy) * (1 << kShift)))};
    }
    const int a = subject.labels[tri[0]], b = subject.labels[tri[1]], c = subject.labels[tri[2]];
    cv::fillConvexPoly(canvas, corners, 3, cv::Scalar(b == c ? b : a), cv::LINE_8, kShift);
  }
  return image;
}

std::string colmap_pose(const View& view, int index, double unit_mm) {
  const Eigen::Quaterniond q(view.camera_from_room_rotation);
  const Vector3d t = view.camera_from_room_translation / unit_mm;
  return format("%d %.12f %.12f %.12f %.12f %.9f %.9f %.9f 1 %03d.png\n\n", index + 1, q.w(), q.x(), q.y(), q.z(),
                t.x(), t.y(), t.z(), index);
}

}  // namespace

void RehearsalOptions::validate() const {
  const auto require = [](bool ok, const std::string& what) {
    if (!ok) throw ConfigError("actor views: " + what);
  };
  require_within("--views", n_views, kViews);
  require_within("--width", width, kSide, "px");
  require_within("--picture-height", height, kSide, "px");
  require(fov_deg > 5 && fov_deg < 120, format("field of view of %g degrees; must be within 5..120", fov_deg));
  require(distance_mm >= 800 && distance_mm <= 20000, format("distance %g mm; must be within 800..20000", distance_mm));
  require(noise >= 0 && blur_px >= 0 && unit_mm > 0, "noise and blur must not be negative, the unit must be positive");
}

void write_rehearsal(const Actor& actor, const RehearsalOptions& options, const std::filesystem::path& folder,
                     const std::function<bool(int, int)>& progress) {
  options.validate();
  if (actor.texture.empty()) throw ConfigError("actor views: the actor has no texture to look at");
  const ActorModel subject = subject_of(actor);
  for (const char* name : {"images", "masks", "labels"}) {
    std::error_code error;
    std::filesystem::create_directories(folder / name, error);
    if (error) throw IoError((folder / name).string() + ": cannot be created: " + error.message());
  }
  double top = 0;
  for (const Vector3d& p : subject.surface.vertices) top = std::max(top, p.y());
  const Lighting lighting;
  std::string poses = "# IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME\n";
  for (int i = 0; i < options.n_views; ++i) {
    if (progress && !progress(i, options.n_views)) return;
    const View view = place_camera(options, i, 0.52 * top);
    const auto layer = render_person(view, lighting, subject, subject.surface.vertices);
    std::vector<Color> linear(layer.covered.size());
    ImageGray mask{options.width, options.height, std::vector<uint8_t>(layer.covered.size(), 0)};
    for (size_t p = 0; p < linear.size(); ++p) {
      const float share = static_cast<float>(layer.covered[p]) / kSamples;
      linear[p] = layer.color[p] / kSamples;
      if (share < 1)
        linear[p] += (1 - share) * backdrop(view, static_cast<int>(p % options.width),
                                            static_cast<int>(p / options.width), options.seed);
      mask.pixels[p] = 2 * layer.covered[p] >= kSamples ? 255 : 0;
    }
    const std::string name = format(kPictureName, i);
    write_png(expose(linear, options.width, options.height, {options.blur_px, options.noise, 1, options.seed + i}),
              folder / "images" / name);
    write_png(mask, folder / "masks" / name);
    write_png(label_image(view, subject), folder / "labels" / name);
    poses += colmap_pose(view, i, options.unit_mm);
  }
  for (const char* name : {"images", "masks", "labels"})
    remove_numbered_from(options.n_views, folder / name, kPictureName);
  const Camera camera = camera_from_fov(options.width, options.height, options.fov_deg);
  write_file_atomically(folder / "cameras.txt",
                        format("# CAMERA_ID MODEL WIDTH HEIGHT PARAMS[]\n1 PINHOLE %d %d %.9f %.9f %.9f %.9f\n",
                               camera.width, camera.height, camera.fx, camera.fy, camera.cx + 0.5, camera.cy + 0.5));
  write_file_atomically(folder / "images.txt", poses);
  if (progress) progress(options.n_views, options.n_views);
}

}  // namespace livecap::synth
