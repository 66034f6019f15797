#include "raster/visibility.h"

#include <algorithm>
#include <map>
#include <utility>

#include "base/round_up.h"
#include "base/text.h"
#include "livecap/error.h"
#include "ocl/lanes.h"

namespace livecap {
namespace {

constexpr char kVisibilityFile[] = "raster/raster.cl";
constexpr size_t kVisibilityGroup = 64;  // on a GPU

// Vertices of edges that belong to one triangle only.
std::vector<int32_t> open_edge_vertices(const Mesh& mesh) {
  std::map<std::pair<int32_t, int32_t>, int> uses;
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int32_t a = mesh.triangles[3 * t + k];
      const int32_t b = mesh.triangles[3 * t + (k + 1) % 3];
      ++uses[std::minmax(a, b)];
    }
  }
  std::vector<int32_t> open(mesh.n_vertices(), 0);
  for (const auto& [edge, count] : uses) {
    if (count == 1) open[edge.first] = open[edge.second] = 1;
  }
  return open;
}

}  // namespace

void VisibilityOptions::validate() const {
  if (!(depth_tolerance_mm >= 0) || !(contour_tolerance_mm >= 0))
    throw ConfigError("visibility: depth tolerances must not be negative");
  if (contour_radius_px < 1 || contour_radius_px > 16)
    throw ConfigError(format("visibility: contour radius of %d px, must be 1..16", contour_radius_px));
}

SurfaceVisibility::SurfaceVisibility(ocl::DeviceContext& device, const Mesh& mesh, const VisibilityOptions& options)
    : device_(device),
      options_(options),
      n_vertices_(mesh.n_vertices()),
      n_triangles_(mesh.n_triangles()),
      is_cpu_(device.is_cpu()),
      lanes_(device.lanes()) {
  options_.validate();
  const TriangleFans fans = triangle_fans(n_vertices_, mesh.triangles);
  fan_offsets_ = ocl::Buffer<int32_t>(device, fans.offsets);
  fan_triangles_ = ocl::Buffer<int32_t>(device, fans.triangles);
  on_open_edge_ = open_edge_vertices(mesh);
  all_candidates_ = ocl::Buffer<int32_t>(device, on_open_edge_);
  visible_ = ocl::Buffer<int32_t>(device, n_vertices_);
  contour_ = ocl::Buffer<int32_t>(device, n_vertices_);
  contour_read_.assign(n_vertices_, 0);
  visible_kernel_ = ocl::Kernel(device, kVisibilityFile, "visible_vertices");
  contour_kernel_ = ocl::Kernel(device, kVisibilityFile, "contour_vertices");
  if (!is_cpu_) both_kernel_ = ocl::Kernel(device, kVisibilityFile, "visible_and_contour");
}

void SurfaceVisibility::require(const DepthRasterizer& raster) const {
  if (raster.n_vertices() != n_vertices_ || raster.n_triangles() != n_triangles_)
    throw LogicError("visibility: the rasteriser draws another mesh");
}

void SurfaceVisibility::require(const ocl::Buffer<float>& positions_camera, const ocl::Buffer<float>& normals) const {
  if (positions_camera.size() != size_t(3) * n_vertices_ || normals.size() != positions_camera.size())
    throw LogicError(format("visibility: %zu coordinates and %zu normals for %d vertices", positions_camera.size(),
                            normals.size(), n_vertices_));
}

void SurfaceVisibility::find_visible(const ocl::Buffer<float>& positions_camera, const ocl::Buffer<float>& normals,
                                     const DepthRasterizer& raster) {
  require(raster);
  require(positions_camera, normals);
  visible_kernel_.launch(over_vertices(), n_vertices_, raster.width(), raster.height(), options_.depth_tolerance_mm,
                         positions_camera, normals, raster.projected(), raster.depth(), visible_);
}

ocl::Buffer<int32_t> SurfaceVisibility::contour_candidates(std::span<const uint8_t> among) const {
  if (among.size() != size_t(n_vertices_))
    throw LogicError(format("visibility: %zu marks for %d vertices", among.size(), n_vertices_));
  std::vector<int32_t> candidates = on_open_edge_;
  for (int i = 0; i < n_vertices_; ++i) {
    if (!among[i]) candidates[i] = -1;
  }
  return {device_, candidates};
}

void SurfaceVisibility::find_contour(const DepthRasterizer& raster, const ocl::Buffer<int32_t>& candidates) {
  require(raster);
  if (candidates.size() != size_t(n_vertices_)) throw LogicError("visibility: contour candidates of another mesh");
  contour_kernel_.launch(over_vertices(), n_vertices_, raster.width(), raster.height(), options_.contour_radius_px,
                         options_.contour_tolerance_mm, raster.projected(), fan_offsets_, fan_triangles_, candidates,
                         raster.facing() ? *raster.facing() : raster.triangles(), raster.depth(), contour_);
}

void SurfaceVisibility::find_visible_and_contour(const ocl::Buffer<float>& positions_camera,
                                                 const ocl::Buffer<float>& normals, const DepthRasterizer& raster,
                                                 const ocl::Buffer<int32_t>& candidates) {
  if (is_cpu_) {
    find_visible(positions_camera, normals, raster);
    find_contour(raster, candidates);
    return;
  }
  require(raster);
  require(positions_camera, normals);
  struct Tolerances {
    float visible, contour;
  };
  both_kernel_.launch(over_vertices(), n_vertices_, raster.width(), raster.height(), options_.contour_radius_px,
                      Tolerances{options_.depth_tolerance_mm, options_.contour_tolerance_mm}, positions_camera, normals,
                      raster.projected(), fan_offsets_, fan_triangles_, candidates, raster.triangles(), raster.depth(),
                      visible_, contour_);
}

ocl::Range SurfaceVisibility::over_vertices() const {
  const size_t items = ocl::lane_items(n_vertices_, lanes_);
  const size_t local = is_cpu_ ? 1 : kVisibilityGroup;
  return {round_up(items, local), 1, local, 1};
}

std::vector<int32_t> SurfaceVisibility::read_contour() {
  contour_.read(contour_read_);
  return contour_found();
}

void SurfaceVisibility::read_contour_later() {
  contour_.read_later(contour_read_);
}

std::vector<int32_t> SurfaceVisibility::contour_found() const {
  std::vector<int32_t> indices;
  for (int i = 0; i < n_vertices_; ++i) {
    if (contour_read_[i]) indices.push_back(i);
  }
  return indices;
}

}  // namespace livecap
