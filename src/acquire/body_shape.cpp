#include "acquire/body_shape.h"

#include <algorithm>
#include <utility>

#include "acquire/facet_offsets.h"
#include "acquire/hull.h"
#include "acquire/open_skirt.h"
#include "actor/height_range.h"
#include "base/text.h"
#include "livecap/error.h"
#include "meshing/remesh.h"
#include "scan/mesh_volume.h"
#include "scan/scan.h"

namespace livecap::acquire {

namespace {

using Eigen::Vector3d;

constexpr double kSearchGridMm = 30;
constexpr double kAboveAnklesMm = 25;  // a shoe reaches
constexpr double kScanGridMm = 7;
constexpr size_t kMostTriangles = 500000;  // thinned one edge at a time, which takes 8 s

}  // namespace

BodyShape carve_body(ocl::DeviceContext& device, const std::vector<View>& views, const SpaceKeypoints& keypoints,
                     double grid_mm, int n_ignored, int n_ignored_feet, std::vector<std::string>& notes) {
  Vector3d low = Vector3d::Constant(1e9), high = -low;
  for (const SpacePoint& point : keypoints) {
    if (!point.found) continue;
    low = low.cwiseMin(point.position);
    high = high.cwiseMax(point.position);
  }
  low -= Vector3d(250, 200, 420);
  high += Vector3d(250, 400, 420);
  HullOptions hull;
  hull.n_ignored = n_ignored;
  hull.n_ignored_low = n_ignored_feet;
  hull.low_mm = (keypoints[kLeftAnkle].position.y() + keypoints[kRightAnkle].position.y()) / 2 + kAboveAnklesMm;
  // Coarsely first: where the body is. A node farther than half a cell's diagonal from the hull has none of it in its
  // cell.
  BodyShape shape;
  shape.volume = make_volume(low, high, kSearchGridMm);
  carve_hull(device, views, hull, shape.volume);
  if (const auto [near_low, near_high] = bounds_within(shape.volume, kSearchGridMm);
      (near_low.array() < near_high.array()).all()) {
    low = near_low;
    high = near_high;
  }
  shape.volume = make_volume(low, high, grid_mm);
  carve_hull(device, views, hull, shape.volume);
  Volume open = shape.volume;
  const bool skirt = open_skirt(keypoints, open);
  blur(shape.volume, 0.8 * grid_mm, 0.35 * grid_mm);
  if (const int dropped = keep_largest_solid(shape.volume); dropped > 0)
    notes.push_back(format("%d other solids in the pictures' common view were dropped", dropped));
  if (!skirt) return shape;
  blur(open, 0.8 * grid_mm, 0.35 * grid_mm);
  keep_largest_solid(open);
  shape.open = std::move(open);
  return shape;
}

BodyShape shape_of_scan(const meshing::Surface& scan, std::vector<std::string>& notes) {
  BodyShape shape;
  shape.fine = scan;
  const bool clean = is_closed_manifold(shape.fine);
  const size_t n = shape.fine.triangles.size();
  shape.volume = volume_of(shape.fine, kScanGridMm);
  shape.as_is = clean && n <= kMostTriangles;
  if (shape.as_is) return shape;
  notes.push_back(
      clean ? format("the scan has %zu triangles: resampled on a grid of %g mm", n, kScanGridMm)
            : format("the scan is not closed or not manifold: rebuilt as a solid on a grid of %g mm", kScanGridMm));
  if (!clean) blur(shape.volume, 0.5 * kScanGridMm);
  keep_largest_solid(shape.volume);
  return shape;
}

meshing::Surface thin_shape(BodyShape& shape, int target_vertices, std::vector<double>& facet_offsets_mm,
                            std::vector<std::string>& notes) {
  const Volume& solid = shape.solid();
  if (!shape.as_is) shape.fine = surface_of(solid);
  const meshing::Surface surface = meshing::remesh(shape.fine, target_vertices);
  shape.fine = {};
  if (const size_t n = surface.vertices.size(); n < static_cast<size_t>(target_vertices))
    notes.push_back(format("the shape has %zu vertices, fewer than --vertices %d: none are added", n, target_vertices));
  // Refining looks for the surface at the vertices: they move only then.
  if (!shape.as_is) facet_offsets_mm = facet_offsets(surface, solid);
  if (surface.vertices.size() < 200 || !is_closed_manifold(surface))
    throw ConfigError(
        format("the shape has no closed surface of a person (%zu vertices left)", surface.vertices.size()));
  return surface;
}

PersonFrame stand_on_floor(const meshing::Surface& surface, double given_height_mm, double& height_mm) {
  double bottom = 1e9, top = -1e9;
  for (const Vector3d& p : surface.vertices) bottom = std::min(bottom, p.y()), top = std::max(top, p.y());
  PersonFrame down;
  if (given_height_mm > 0) down.scale_mm = given_height_mm / (top - bottom);
  height_mm = down.scale_mm * (top - bottom);
  if (!kPersonHeightMm.contains(height_mm))
    throw ConfigError(format("the body is %.0f mm tall; --unit or --height", height_mm));
  down.translation_mm = Vector3d(0, -down.scale_mm * bottom, 0);
  return down;
}

}  // namespace livecap::acquire
