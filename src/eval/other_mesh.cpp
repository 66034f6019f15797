#include "eval/other_mesh.h"

#include <Eigen/Geometry>
#include <algorithm>

#include "eval/packed_points.h"
#include "meshing/surface_parts.h"

namespace livecap {

namespace {

using Eigen::Vector3d;

constexpr double kTrueCellMm = 40;

// The rigid motion that lays `points` onto the surface: nearest points and least squares, in turns.
Eigen::Isometry3d align(const std::vector<Vector3d>& points, const meshing::NearestSurface& surface) {
  Eigen::Isometry3d motion = Eigen::Isometry3d::Identity();
  const int stride = std::max<int>(1, static_cast<int>(points.size() / 2000));
  for (int round = 0; round < 15; ++round) {
    std::vector<std::pair<double, std::pair<Vector3d, Vector3d>>> pairs;
    for (size_t i = 0; i < points.size(); i += stride) {
      const Vector3d p = motion * points[i];
      const auto on = surface.find(p);
      pairs.push_back({on.distance, {p, on.position}});
    }
    // The worst tenth does not count: parts that one of the two does not have.
    std::sort(pairs.begin(), pairs.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    pairs.resize(pairs.size() * 9 / 10);
    Eigen::Matrix3Xd from(3, pairs.size()), to(3, pairs.size());
    for (size_t i = 0; i < pairs.size(); ++i) {
      from.col(i) = pairs[i].second.first;
      to.col(i) = pairs[i].second.second;
    }
    const Eigen::Matrix4d step = Eigen::umeyama(from, to, false);
    motion = Eigen::Isometry3d(step) * motion;
  }
  return motion;
}

}  // namespace

bool same_mesh(const Actor& a, const Actor& b) {
  return a.n_vertices() == b.n_vertices() && a.mesh.triangles == b.mesh.triangles;
}

RestOverlay overlay_rest(const Actor& actor, const Actor& truth) {
  const meshing::Surface surface = meshing::surface_of(actor.mesh), true_surface = meshing::surface_of(truth.mesh);
  const meshing::NearestSurface near_truth(true_surface, kTrueCellMm);
  RestOverlay overlay{align(surface.vertices, near_truth), {}};
  for (const Vector3d& p : surface.vertices) overlay.nearest.push_back(near_truth.find(overlay.truth_from_actor * p));
  return overlay;
}

std::vector<meshing::SurfacePoint> true_vertices_on(const Actor& actor, const Actor& truth,
                                                    const RestOverlay& overlay) {
  const meshing::Surface surface = meshing::surface_of(actor.mesh);
  const meshing::NearestSurface near(surface, kTrueCellMm);
  const Eigen::Isometry3d actor_from_truth = overlay.truth_from_actor.inverse();
  std::vector<meshing::SurfacePoint> points;
  for (int i = 0; i < truth.n_vertices(); ++i)
    points.push_back(near.find(actor_from_truth * point(truth.mesh.positions, i)));
  return points;
}

std::vector<float> resample(const std::vector<meshing::SurfacePoint>& nearest, std::span<const int32_t> triangles,
                            std::span<const float> truth) {
  std::vector<float> positions;
  positions.reserve(3 * nearest.size());
  for (const meshing::SurfacePoint& on : nearest) {
    Vector3d p = Vector3d::Zero();
    for (int k = 0; k < 3; ++k) p += on.weights[k] * point(truth, triangles[3 * static_cast<size_t>(on.triangle) + k]);
    for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(p[k]));
  }
  return positions;
}

std::vector<double> surface_distances(std::span<const float> vertices, std::span<const float> paired,
                                      std::span<const float> truth, std::span<const int32_t> truth_triangles) {
  meshing::Surface surface;
  for (size_t i = 0; i < truth.size() / 3; ++i) surface.vertices.push_back(point(truth, i));
  for (size_t t = 0; t + 2 < truth_triangles.size(); t += 3)
    surface.triangles.emplace_back(truth_triangles[t], truth_triangles[t + 1], truth_triangles[t + 2]);
  const meshing::NearestSurface near(surface, kTrueCellMm);
  std::vector<Vector3d> points;
  Vector3d shift = Vector3d::Zero();
  for (size_t i = 0; i < vertices.size() / 3; ++i)
    shift += (point(paired, i) - point(vertices, i)) / (static_cast<double>(vertices.size()) / 3);
  for (size_t i = 0; i < vertices.size() / 3; i += 5) points.push_back(point(vertices, i));
  constexpr int kRounds = 5, kStride = 5;
  for (int round = 0; round < kRounds; ++round) {
    Vector3d step = Vector3d::Zero();
    double n = 0;
    for (size_t i = round % kStride; i < points.size(); i += kStride, ++n)
      step += near.find(points[i] + shift).position - points[i] - shift;
    shift += step / std::max(n, 1.0);
  }
  std::vector<double> distances;
  for (const Vector3d& p : points) distances.push_back(near.find(p + shift).distance);
  return distances;
}

}  // namespace livecap
