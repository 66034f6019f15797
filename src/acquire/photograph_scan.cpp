#include "acquire/photograph_scan.h"

#include <Eigen/Geometry>
#include <cmath>

#include "base/text.h"
#include "picture/overlay.h"

namespace livecap::acquire {

using Eigen::Vector3d;

std::vector<View> photograph_scan(const Scan& scan, int n_views) {
  Vector3d low = Vector3d::Constant(1e300), high = -low;
  for (const Vector3d& p : scan.surface.vertices) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const Vector3d size = high - low;
  // Scans stand along Y or, from some tools, along Z.
  const bool z_up = size.z() > 1.3 * size.y();
  const double scale = 1700 / (z_up ? size.z() : size.y());
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (z_up) turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  Actor actor;
  for (const Vector3d& p : scan.surface.vertices) {
    const Vector3d q = scale * (turn * (p - (low + high) / 2));
    for (int k = 0; k < 3; ++k) actor.mesh.positions.push_back(static_cast<float>(q[k]));
  }
  for (size_t t = 0; t < scan.surface.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      actor.mesh.triangles.push_back(scan.surface.triangles[t][k]);
      actor.render.triangles.push_back(static_cast<int32_t>(actor.render.template_vertex.size()));
      actor.render.template_vertex.push_back(scan.surface.triangles[t][k]);
      const Eigen::Vector2d uv = scan.uvs.empty() ? Eigen::Vector2d(0, 0) : scan.uvs[3 * t + k];
      actor.render.uvs.insert(actor.render.uvs.end(), {static_cast<float>(uv.x()), static_cast<float>(uv.y())});
    }
  actor.texture = scan.texture;
  for (const Vector3d& c : scan.colors)
    for (int k = 0; k < 3; ++k) actor.colors.push_back(static_cast<float>(c[k]));
  if (scan.colors.empty()) actor.colors.assign(actor.mesh.positions.size(), 0.6f);

  std::vector<View> views;
  constexpr int kWidth = 480, kHeight = 640;
  for (int i = 0; i < n_views; ++i) {
    const double angle = 2 * M_PI * i / n_views, rise = i % 2 ? 0.25 : -0.05;
    View view;
    view.name = format("scan from %.0f degrees", angle * 180 / M_PI);
    view.camera = camera_from_fov(kWidth, kHeight, 42);
    const Vector3d from =
        2700 * Vector3d(std::sin(angle) * std::cos(rise), std::sin(rise), std::cos(angle) * std::cos(rise));
    const Vector3d forward = -from.normalized(), right = forward.cross(Vector3d::UnitY()).normalized();
    Eigen::Matrix3d rotation;
    rotation << right.transpose(), forward.cross(right).transpose(), forward.transpose();
    std::vector<float> positions(actor.mesh.positions.size());
    for (size_t k = 0; k < positions.size(); k += 3) {
      const Vector3d p = rotation * (Eigen::Map<const Eigen::Vector3f>(&actor.mesh.positions[k]).cast<double>() - from);
      for (int j = 0; j < 3; ++j) positions[k + j] = static_cast<float>(p[j]);
    }
    ImageRgb wall{kWidth, kHeight, std::vector<uint8_t>(size_t(3) * kWidth * kHeight, 200)};
    OverlayOptions options;
    options.alpha = 1;
    options.texture = scan.has_color();
    view.image = render_overlay(actor, positions, view.camera, wall, options);
    view.camera_from_world.linear() = rotation * turn;
    view.camera_from_world.translation() = -rotation * (turn * (low + high) / 2) - rotation * from / scale;
    views.push_back(std::move(view));
  }
  return views;
}

}  // namespace livecap::acquire
