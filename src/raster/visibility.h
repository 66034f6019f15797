// Visible vertices (the set V of the photometric term) and contour vertices (the set B of the silhouette term); paper,
// "Dense Photometric Alignment" and "Dense Silhouette Alignment".
#pragma once

#include <span>
#include <vector>

#include "geometry/mesh.h"
#include "ocl/buffer.h"
#include "ocl/kernel.h"
#include "raster/depth.h"

namespace livecap {

struct VisibilityOptions {
  float depth_tolerance_mm = 10;    // a vertex this far behind the depth buffer is still visible
  float contour_tolerance_mm = 40;  // the same at the outline, where the surface turns away and depth changes fast
  int contour_radius_px = 2;        // a contour vertex has background within this distance

  void validate() const;  // throws ConfigError
};

class SurfaceVisibility {
 public:
  // Keeps no reference to the mesh; device outlives this.
  SurfaceVisibility(ocl::DeviceContext& device, const Mesh& mesh, const VisibilityOptions& options = {});

  // These read what `raster` rendered last, which must be the same positions. Enqueued in order, nothing blocks.
  // positions_camera, normals: [3*n_vertices] mm and unit, camera frame.
  void find_visible(const ocl::Buffer<float>& positions_camera, const ocl::Buffer<float>& normals,
                    const DepthRasterizer& raster);
  void find_contour(const DepthRasterizer& raster) { find_contour(raster, all_candidates_); }
  void find_contour(const DepthRasterizer& raster, const ocl::Buffer<int32_t>& candidates);
  // One after the other, on GPUs in one launch.
  void find_visible_and_contour(const ocl::Buffer<float>& positions_camera, const ocl::Buffer<float>& normals,
                                const DepthRasterizer& raster) {
    find_visible_and_contour(positions_camera, normals, raster, all_candidates_);
  }
  void find_visible_and_contour(const ocl::Buffer<float>& positions_camera, const ocl::Buffer<float>& normals,
                                const DepthRasterizer& raster, const ocl::Buffer<int32_t>& candidates);
  // Candidates for find_contour: where `among` [n_vertices] is not 0. Throws LogicError.
  ocl::Buffer<int32_t> contour_candidates(std::span<const uint8_t> among) const;

  const ocl::Buffer<int32_t>& visible() const { return visible_; }  // [n_vertices] 0 or 1
  const ocl::Buffer<int32_t>& contour() const { return contour_; }  // [n_vertices] 0 or 1
  // Indices of the contour vertices, ascending. Blocking.
  std::vector<int32_t> read_contour();
  // The same in two halves: enqueues; when the queue was waited for.
  void read_contour_later();
  std::vector<int32_t> contour_found() const;

 private:
  friend class ActorSight;  // does the same in one launch with more
  void require(const DepthRasterizer& raster) const;
  void require(const ocl::Buffer<float>& positions_camera, const ocl::Buffer<float>& normals) const;
  ocl::Range over_vertices() const;

  ocl::DeviceContext& device_;
  VisibilityOptions options_;
  int n_vertices_;
  int n_triangles_;
  bool is_cpu_;
  int lanes_;
  ocl::Buffer<int32_t> fan_offsets_;     // [n+1] triangles around each vertex, compressed rows
  ocl::Buffer<int32_t> fan_triangles_;   // [3*n_triangles]
  std::vector<int32_t> on_open_edge_;    // [n]
  ocl::Buffer<int32_t> all_candidates_;  // the same, see kernels/raster/visibility.cl
  ocl::Buffer<int32_t> visible_;
  std::vector<int32_t> contour_read_;  // [n] what was read of contour_
  ocl::Buffer<int32_t> contour_;
  ocl::Kernel visible_kernel_;
  ocl::Kernel contour_kernel_;
  ocl::Kernel both_kernel_;  // GPUs
};

}  // namespace livecap
