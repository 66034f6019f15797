#include "raster/depth.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/round_up.h"
#include "base/text.h"
#include "geometry/pinhole_arg.h"
#include "livecap/error.h"
#include "ocl/lanes.h"
#include "raster/layout.h"

namespace livecap {
namespace {

constexpr char kFile[] = "raster/raster.cl";
constexpr int kMaxBands = 32;
constexpr size_t kLocal = 64;  // on a GPU

// Every edge is run through once in each direction: a ray then meets as many front as back faces.
bool is_closed(const Mesh& mesh) {
  std::vector<std::pair<int32_t, int32_t>> edges, reversed;
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int32_t a = mesh.triangles[3 * t + k];
      const int32_t b = mesh.triangles[3 * t + (k + 1) % 3];
      edges.emplace_back(a, b);
      reversed.emplace_back(b, a);
    }
  }
  std::sort(edges.begin(), edges.end());
  std::sort(reversed.begin(), reversed.end());
  return edges == reversed;
}

}  // namespace

DepthRasterizer::DepthRasterizer(ocl::DeviceContext& device, const Mesh& mesh, int width, int height)
    : width_(width),
      height_(height),
      n_vertices_(mesh.n_vertices()),
      n_triangles_(mesh.n_triangles()),
      is_cpu_(device.is_cpu()),
      lanes_(device.lanes()) {
  if (width <= 0 || height <= 0)
    throw ConfigError(format("rasteriser: image size %dx%d is not positive", width, height));
  for (int32_t index : mesh.triangles) {
    if (index < 0 || index >= n_vertices_)
      throw LogicError(format("rasteriser: triangle corner %d outside 0..%d", index, n_vertices_ - 1));
  }
  cull_ = is_closed(mesh);
  const int n_strips = (height + LC_STRIP_ROWS - 1) / LC_STRIP_ROWS;
  n_bands_ = std::clamp(static_cast<int>(device.info().compute_units), 1, std::min(kMaxBands, n_strips));
  triangles_ = ocl::Buffer<int32_t>(device, mesh.triangles);
  projected_ = ocl::Buffer<float>(device, size_t(4) * n_vertices_);
  depth_ = ocl::Buffer<float>(device, size_t(width) * height);
  ids_ = ocl::Buffer<int32_t>(device, size_t(width) * height);
  overlap_ = ocl::Buffer<int32_t>(device, size_t(2) * height);
  overlap_kernel_ = ocl::Kernel(device, kFile, "row_overlaps");
  if (is_cpu_) {
    project_ = ocl::Kernel(device, kFile, "project_vertices");
    bands_ = ocl::Kernel(device, kFile, "raster_bands");
    std::vector<int32_t> everything;
    for (int strip = 0; strip < n_strips; ++strip) everything.insert(everything.end(), {0, width - 1});
    depths_ = ocl::Kernel(device, kFile, "raster_depths");
    drawn_ = ocl::Buffer<int32_t>(device, everything);
    depth_drawn_ = ocl::Buffer<int32_t>(device, everything);
    facing_ = ocl::Buffer<int32_t>(device, round_up(n_triangles_, LC_RASTER_TRIANGLES));
  } else {
    begin_ = ocl::Kernel(device, kFile, "raster_begin");
    nearest_ = ocl::Kernel(device, kFile, "raster_nearest");
    id_ = ocl::Kernel(device, kFile, "raster_ids");
  }
}

void DepthRasterizer::render(const ocl::Buffer<float>& positions_camera, const Camera& camera) {
  draw(true, positions_camera, camera);
}

void DepthRasterizer::render_depth(const ocl::Buffer<float>& positions_camera, const Camera& camera) {
  draw(false, positions_camera, camera);
}

void DepthRasterizer::draw(bool with_ids, const ocl::Buffer<float>& positions_camera, const Camera& camera) {
  if (positions_camera.size() != size_t(3) * n_vertices_)
    throw LogicError(format("rasteriser: %zu coordinates for %d vertices", positions_camera.size(), n_vertices_));
  if (is_cpu_) {
    project_.launch(ocl::lane_items(n_vertices_, lanes_), 1, n_vertices_, pinhole_arg(camera), positions_camera,
                    projected_);
    if (with_ids) {
      bands_.launch(n_bands_, 1, n_triangles_, width_, height_, n_bands_, cull_, projected_, triangles_, depth_,
                    depth_drawn_, facing_, ids_, drawn_);
    } else {
      depths_.launch(n_bands_, 1, n_triangles_, width_, height_, n_bands_, cull_, projected_, triangles_, depth_,
                     depth_drawn_, facing_);
    }
    return;
  }
  const size_t n_clears = round_up(depth_.size(), LC_RASTER_CLEAR) / LC_RASTER_CLEAR;
  begin_.launch(std::max(n_clears, size_t(n_vertices_)), kLocal, n_vertices_, static_cast<int>(depth_.size()),
                pinhole_arg(camera), positions_camera, projected_, depth_, ids_);
  const size_t items = size_t(n_triangles_) * LC_RASTER_SHARE;
  nearest_.launch(items, kLocal, n_triangles_, width_, height_, cull_, projected_, triangles_, depth_);
  if (!with_ids) return;
  id_.launch(items, kLocal, n_triangles_, width_, height_, cull_, projected_, triangles_, depth_, ids_);
}

double DepthRasterizer::intersection_over_union(const ocl::Buffer<uint8_t>& mask) {
  if (mask.size() != ids_.size())
    throw LogicError(format("rasteriser: mask of %zu pixels for %dx%d", mask.size(), width_, height_));
  const size_t local = is_cpu_ ? 1 : kLocal;
  overlap_kernel_.launch(height_ * local, local, width_, height_, depth_, mask, overlap_);
  int64_t both = 0, either = 0;
  const std::vector<int32_t> rows = overlap_.read_all();
  for (size_t i = 0; i < rows.size(); i += 2) {
    both += rows[i];
    either += rows[i + 1];
  }
  return either > 0 ? static_cast<double>(both) / static_cast<double>(either) : 0;
}

ImageGray DepthRasterizer::read_mask() const {
  const std::vector<float> depth = depth_.read_all();
  ImageGray mask{width_, height_, std::vector<uint8_t>(depth.size())};
  std::transform(depth.begin(), depth.end(), mask.pixels.begin(), [](float z) { return std::isinf(z) ? 0 : 255; });
  return mask;
}

}  // namespace livecap
