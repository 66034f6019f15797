// Depth and triangle ids of a mesh as the camera sees it, on the solver's device. Everything else of this room (visible
// vertices, contour, part mask) is read off these buffers.
#pragma once

#include <vector>

#include "base/image_rgb.h"
#include "geometry/mesh.h"
#include "livecap/camera.h"
#include "ocl/buffer.h"
#include "ocl/kernel.h"

namespace livecap {

// Both faces of a triangle count; on a closed mesh the far ones are left out, which covers the same pixels. Pixel
// centres are at integers, a pixel is covered when its centre lies in the triangle or on its edge. A triangle with a
// corner nearer than 100 mm, behind the camera, not finite or more than 1e6 px away is left out. Results repeat bit for
// bit.
class DepthRasterizer {
 public:
  // Keeps no reference to the mesh. width, height: of every picture rendered, positive (ConfigError).
  DepthRasterizer(ocl::DeviceContext& device, const Mesh& mesh, int width, int height);

  // positions_camera: [3*n_vertices] mm, camera frame. Enqueued in order, nothing blocks. Throws LogicError for a
  // buffer of another size; the camera's own size is not looked at.
  void render(const ocl::Buffer<float>& positions_camera, const Camera& camera);
  // The same for whoever does not look at the triangles: depth and facing; triangle_ids() and drawn() are as before, or
  // anything on GPUs.
  void render_depth(const ocl::Buffer<float>& positions_camera, const Camera& camera);

  int width() const { return width_; }
  int height() const { return height_; }
  int n_vertices() const { return n_vertices_; }
  int n_triangles() const { return n_triangles_; }
  const ocl::Buffer<float>& depth() const { return depth_; }         // [w*h] mm, INFINITY = empty
  const ocl::Buffer<int32_t>& triangle_ids() const { return ids_; }  // [w*h], -1 = empty
  const ocl::Buffer<float>& projected() const {
    return projected_;
  }  // [4*n_vertices] u, v (px), 1/z (0 = not projected), z (mm)
  const ocl::Buffer<int32_t>& triangles() const { return triangles_; }  // [3*n_triangles]
  // [at least n_triangles] 1 towards the camera, -1 away, 0 edge-on or not projected; null on GPUs.
  const ocl::Buffer<int32_t>* facing() const { return is_cpu_ ? &facing_ : nullptr; }
  // First and last column of triangle_ids() that is covered of each strip of LC_STRIP_ROWS rows; null on GPUs.
  const ocl::Buffer<int32_t>* drawn() const { return is_cpu_ ? &drawn_ : nullptr; }

  // Pixels that the mesh and `mask` ([w*h], more than 127 = set; LogicError for another size) share, as a part of those
  // that either covers; 0 when none is. Blocking.
  double intersection_over_union(const ocl::Buffer<uint8_t>& mask);

  // 255 where the mesh covers the pixel. Blocking.
  ImageGray read_mask() const;

 private:
  friend class ActorSight;  // does the same in one launch with more
  void draw(bool with_ids, const ocl::Buffer<float>& positions_camera, const Camera& camera);

  int width_;
  int height_;
  int n_vertices_;
  int n_triangles_;
  int n_bands_;
  int cull_;  // 1 when the mesh is closed
  bool is_cpu_;
  int lanes_;
  ocl::Buffer<int32_t> triangles_;
  ocl::Buffer<float> projected_;
  ocl::Buffer<float> depth_;
  ocl::Buffer<int32_t> ids_;
  // CPU: columns that are covered of each strip of rows, of ids_ and of depth_.
  ocl::Buffer<int32_t> drawn_, depth_drawn_;
  ocl::Buffer<int32_t> facing_;   // CPU: [n_triangles, rounded up] see depth.cl
  ocl::Buffer<int32_t> overlap_;  // [2*h] per row: pixels in both, in either
  ocl::Kernel project_;           // CPU
  ocl::Kernel overlap_kernel_;
  ocl::Kernel bands_;    // CPU
  ocl::Kernel depths_;   // CPU
  ocl::Kernel begin_;    // GPU
  ocl::Kernel nearest_;  // GPU
  ocl::Kernel id_;       // GPU
};

}  // namespace livecap
