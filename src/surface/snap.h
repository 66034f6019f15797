// Vertex snapping after the non-rigid stage (paper, "Vertex Snapping"): contour vertices of soft material walk to the
// zero of the distance image, at constant depth; neighbours within a band of edge rings follow by a Laplacian warp.
#pragma once

#include "ocl/groups_together.h"
#include "ocl/kernel.h"
#include "surface/surface_domain.h"
#include "surface/surface_input.h"

namespace livecap {

struct SnapOptions {
  float max_rigidity = 3.0f;  // only vertices of at most this rigidity move (paper, Table 1: clothes and scarfs)
  float max_move_px = 15.0f;  // a contour vertex farther from the silhouette stays
  int n_rings = 5;            // width of the warped band in edges, 0: contour vertices only
  int relaxations = 8;        // Jacobi sweeps of the warp

  // Throws ConfigError naming the field.
  void validate() const;
};

// Camera frame, mesh vertex order; buffers of the snapper's DeviceContext.
struct SnapInput {
  const DeviceFrame& frame;
  const ocl::Buffer<int>& contour_flag;              // [n] the contour after the solve
  const ocl::Buffer<float>& normals;                 // [3n] outward
  const ocl::Buffer<uint8_t>* part_image = nullptr;  // as in SurfaceInput
  const ocl::Buffer<int>* vertex_part = nullptr;
};

class Snapper {
 public:
  // domain: of this actor, on this device. Keeps a reference to neither actor nor device. Throws ConfigError for
  // options.
  Snapper(ocl::DeviceContext& device, const Actor& actor, std::shared_ptr<const SurfaceDomain> domain,
          const SnapOptions& options = {});

  // Moves vertices [3n] in place; only x and y, only in the band. Enqueues, does not block. Throws LogicError for
  // buffers of a wrong size.
  void snap(const SnapInput& input, ocl::Buffer<float>& vertices);
  // True once when the device did not do all of it, after the next blocking read: it is to be done again.
  bool gave_up() { return groups_.gave_up("snap"); }

  // Blocking, for tests: 0 = snapped, k = k edges away and in the band, more than n_rings = not moved. [n] mesh order.
  std::vector<float> rings() const;

 private:
  void warp_by_launches();  // CPUs
  void warp_in_rounds();    // GPUs

  SnapOptions options_;
  std::shared_ptr<const SurfaceDomain> domain_;
  bool is_cpu_;
  ocl::Buffer<float> rigidity_;             // [stride] rows
  ocl::Buffer<float> rings_, rings_after_;  // [stride]
  ocl::Buffer<float> moves_, moves_after_;  // 2 planes, mm
  ocl::Buffer<uint8_t> no_parts_;
  ocl::Kernel targets_, spread_, relax_, rounds_, apply_;
  ocl::GroupsTogether groups_;  // on GPUs, for rounds_
};

}  // namespace livecap
