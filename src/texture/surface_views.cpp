#include "texture/surface_views.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>

#include "base/text.h"
#include "image/image_io.h"
#include "image/silhouette.h"
#include "livecap/error.h"
#include "raster/depth.h"
#include "views/camera_files.h"

namespace livecap {

Mesh mesh_of(const meshing::Surface& surface) {
  Mesh mesh;
  for (const auto& p : surface.vertices)
    for (int k = 0; k < 3; ++k) mesh.positions.push_back(static_cast<float>(p[k]));
  for (const auto& t : surface.triangles) mesh.triangles.insert(mesh.triangles.end(), {t[0], t[1], t[2]});
  return mesh;
}

ViewCoverage coverage_of(const Camera& camera, const std::vector<int32_t>& visible, const std::vector<float>& positions,
                         const std::vector<float>& normals) {
  const size_t n = visible.size();
  ViewCoverage seen{std::vector<float>(n, 0), std::vector<Eigen::Vector2f>(n, Eigen::Vector2f::Zero())};
  for (size_t i = 0; i < n; ++i) {
    if (!visible[i]) continue;
    const Eigen::Map<const Eigen::Vector3f> p(&positions[3 * i]), normal(&normals[3 * i]);
    seen.facing[i] = std::max(0.f, -p.normalized().dot(normal));
    seen.pixels[i] = {static_cast<float>(camera.fx) * p.x() / p.z() + static_cast<float>(camera.cx),
                      static_cast<float>(camera.fy) * p.y() / p.z() + static_cast<float>(camera.cy)};
  }
  return seen;
}

namespace {

using Rasters = std::map<std::pair<int, int>, std::unique_ptr<DepthRasterizer>>;  // by picture size

DepthRasterizer& raster_of(ocl::DeviceContext& device, const Mesh& mesh, const Camera& camera, Rasters& rasters) {
  auto& raster = rasters[{camera.width, camera.height}];
  if (!raster) raster = std::make_unique<DepthRasterizer>(device, mesh, camera.width, camera.height);
  return *raster;
}

constexpr float kOccluderMm = 10;  // nearer to the camera than the vertex and the slope of its own surface
constexpr float kSlopePx = 2;      // how far from the vertex the corners of the 3x3 pixels are
constexpr float kFlattest = 0.1f;  // cosine that the slope is taken for at most

// 1 where the vertex projects into the picture, its normal faces the camera and none of the 3x3 pixels around it shows
// something in front of it. SurfaceVisibility asks for one pixel that does not: behind a hem or an arm it calls a
// vertex visible whose pixel has the colour and the label of something else.
std::vector<int32_t> wholly_visible(const Camera& camera, const std::vector<float>& depth,
                                    const std::vector<float>& positions, const std::vector<float>& normals) {
  std::vector<int32_t> visible(positions.size() / 3, 0);
  for (size_t i = 0; i < visible.size(); ++i) {
    const Eigen::Map<const Eigen::Vector3f> p(&positions[3 * i]), normal(&normals[3 * i]);
    const float facing = -p.normalized().dot(normal);
    if (!(p.z() > 0) || !(facing > 0)) continue;
    const double u = camera.fx * p.x() / p.z() + camera.cx, v = camera.fy * p.y() / p.z() + camera.cy;
    if (!(u > -0.5 && v > -0.5 && u < camera.width - 0.5 && v < camera.height - 0.5)) continue;
    const int x = static_cast<int>(std::lround(u)), y = static_cast<int>(std::lround(v));
    float nearest = std::numeric_limits<float>::infinity();
    for (int row = std::max(0, y - 1); row <= std::min(camera.height - 1, y + 1); ++row)
      for (int column = std::max(0, x - 1); column <= std::min(camera.width - 1, x + 1); ++column)
        nearest = std::min(nearest, depth[static_cast<size_t>(row) * camera.width + column]);
    const float cosine = std::clamp(facing, kFlattest, 1.0f);
    const float slope = std::sqrt(1 - cosine * cosine) / cosine, mm_per_px = p.z() / static_cast<float>(camera.fx);
    visible[i] = nearest > p.z() - kOccluderMm - kSlopePx * mm_per_px * slope;
  }
  return visible;
}

// [3*n] as the camera has them.
std::vector<float> positions_in(const View& view, const Mesh& mesh) {
  const Eigen::Isometry3f camera_from_rest = view.camera_from_world.cast<float>();
  std::vector<float> positions(mesh.positions.size());
  for (int i = 0; i < mesh.n_vertices(); ++i)
    Eigen::Map<Eigen::Vector3f>(positions.data() + 3 * i) =
        camera_from_rest * Eigen::Map<const Eigen::Vector3f>(&mesh.positions[3 * i]);
  return positions;
}

}  // namespace

std::vector<ImageGray> draw_masks(ocl::DeviceContext& device, const Mesh& mesh, const std::vector<View>& views) {
  Rasters rasters;
  ocl::Buffer<float> positions(device, mesh.positions.size());
  std::vector<ImageGray> masks;
  for (const View& view : views) {
    DepthRasterizer& raster = raster_of(device, mesh, view.camera, rasters);
    positions.write(positions_in(view, mesh));
    raster.render_depth(positions, view.camera);
    masks.push_back(raster.read_mask());
  }
  return masks;
}

std::vector<ViewCoverage> cover_surface(ocl::DeviceContext& device, const Mesh& mesh, const std::vector<View>& views) {
  const int n = mesh.n_vertices();
  const std::vector<float> normals = vertex_normals(mesh.positions, mesh.triangles);
  Rasters rasters;
  ocl::Buffer<float> positions_buffer(device, mesh.positions.size());
  std::vector<float> turned(mesh.positions.size());
  std::vector<ViewCoverage> coverage;
  for (const View& view : views) {
    DepthRasterizer& raster = raster_of(device, mesh, view.camera, rasters);
    const std::vector<float> positions = positions_in(view, mesh);
    const Eigen::Matrix3f turn = view.camera_from_world.cast<float>().linear();
    for (int i = 0; i < n; ++i)
      Eigen::Map<Eigen::Vector3f>(turned.data() + 3 * i) = turn * Eigen::Map<const Eigen::Vector3f>(&normals[3 * i]);
    positions_buffer.write(positions);
    raster.render_depth(positions_buffer, view.camera);
    const std::vector<int32_t> visible = wholly_visible(view.camera, raster.depth().read_all(), positions, turned);
    coverage.push_back(coverage_of(view.camera, visible, positions, turned));
    const ImageGray& mask = view.mask;
    if (mask.width == view.camera.width && mask.height == view.camera.height)
      coverage.back().overlap = raster.intersection_over_union(ocl::Buffer<uint8_t>(device, mask.pixels));
  }
  return coverage;
}

double mean_overlap(const std::vector<ViewCoverage>& coverage) {
  double sum = 0;
  int n = 0;
  for (const ViewCoverage& view : coverage)
    if (std::isfinite(view.overlap)) sum += view.overlap, ++n;
  return n > 0 ? sum / n : std::numeric_limits<double>::quiet_NaN();
}

std::vector<char> visible_hull_vertices(ocl::DeviceContext& device, const Mesh& mesh,
                                        const std::filesystem::path& cameras, const std::filesystem::path& masks,
                                        double unit_mm) {
  const int n = mesh.n_vertices();
  std::vector<View> views;
  std::vector<double> depth(n, 1e9);  // mm inside of the nearest silhouette's outline
  for (const ViewPose& pose : read_view_poses(cameras)) {
    if (pose.camera.has_distortion())
      throw ConfigError(cameras.string() + ": " + pose.picture + " has lens distortion; its mask must be undistorted");
    View view;
    view.camera = pose.camera;
    view.camera_from_world = pose.camera_from_world;
    view.camera_from_world.translation() *= unit_mm;
    const std::filesystem::path file = masks / std::filesystem::path(pose.picture).replace_extension(".png");
    const Silhouette silhouette = make_silhouette(read_image_mask(file));
    if (silhouette.width != view.camera.width || silhouette.height != view.camera.height)
      throw IoError(file.string() + format(": is %dx%d, its camera %dx%d", silhouette.width, silhouette.height,
                                           view.camera.width, view.camera.height));
    if (silhouette.empty()) throw IoError(file.string() + ": shows nobody; a mask with the person white is needed");
    for (int i = 0; i < n; ++i) {
      const Eigen::Vector3d p = Eigen::Map<const Eigen::Vector3f>(&mesh.positions[3 * i]).cast<double>();
      Eigen::Vector2d pixel;
      if (!view.project(p, pixel)) continue;
      const int x = static_cast<int>(std::lround(pixel.x())), y = static_cast<int>(std::lround(pixel.y()));
      if (x < 0 || y < 0 || x >= silhouette.width || y >= silhouette.height) continue;
      const double px = -silhouette.signed_distance[static_cast<size_t>(y) * silhouette.width + x];
      depth[i] = std::min(depth[i], px * (view.camera_from_world * p).z() / view.camera.fx);
    }
    views.push_back(view);
  }
  std::vector<char> seen(n, 0);
  for (const ViewCoverage& view : cover_surface(device, mesh, views))
    for (int i = 0; i < n; ++i) seen[i] |= view.facing[i] > kEdgeOn && depth[i] <= kConcavityMm;
  return seen;
}

}  // namespace livecap
