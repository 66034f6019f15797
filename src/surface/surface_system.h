// The Gauss-Newton system of stage II on the device (paper, "Non-rigid Surface Registration" and "Data Parallel GPU
// Optimization"): linearise E_non-rigid at the current vertices, solve (J^T J + damping) step = -J^T F by
// preconditioned conjugate gradients, move. SurfaceSolver runs the three; tests look at each.
#pragma once

#include <array>
#include <vector>

#include "ocl/groups_together.h"
#include "ocl/kernel.h"
#include "surface/surface_domain.h"
#include "surface/surface_input.h"

namespace livecap {

// sigma of a Gaussian kernel of this odd size, px (OpenCV's rule).
double gaussian_sigma(int kernel_size);

class SurfaceSystem {
 public:
  // camera: undistorted. Keeps no reference to the actor. Throws ConfigError for inconsistent inputs.
  SurfaceSystem(ocl::DeviceContext& device, const Actor& actor, const Camera& camera, const SurfaceOptions& options);

  // Takes the start vertices and the terms' constants of this frame. Throws LogicError for buffers of a wrong size.
  void begin(const SurfaceInput& input);
  // Builds the system at the current vertices, photometric term at this Gaussian kernel size. Clears the failure of the
  // solve when it is the first of a frame.
  void linearize(const SurfaceInput& input, int gaussian_kernel);
  void iterate_pcg(int iterations);
  // vertices += step, each by at most max_step_mm.
  void move();
  // out [3n]: the vertices, or input.start when anything was not finite since begin().
  void finish(const SurfaceInput& input, ocl::Buffer<float>& out);

  // Blocking reads.
  SurfaceStatus status();
  SurfaceEnergies energies();  // at the vertices of the last linearize()
  // The same in two halves: enqueues; after status().
  void sum_energies();
  SurfaceEnergies summed_energies() const;

  // Blocking, for tests; all in mesh order.
  std::vector<float> right_hand_side() const;                       // [3n] -J^T F, valid before iterate_pcg
  std::vector<float> step() const;                                  // [3n] mm
  std::vector<float> product(const std::vector<float>& direction);  // (J^T J + damping) direction; breaks a running PCG

  const SellGraph& graph() const { return domain_->graph; }
  // True once when the device did not do all of a solve, after status(): it is to be solved again.
  bool gave_up() { return groups_.gave_up("surface"); }
  // For a Snapper of the same template and camera.
  std::shared_ptr<const SurfaceDomain> domain() const { return domain_; }

 private:
  void apply();
  void turn_direction();
  void launch_phases(int first, int end);
  std::vector<float> from_planes(const ocl::Buffer<float>& planes, int width) const;

  ocl::DeviceContext* device_;
  SurfaceOptions options_;
  std::shared_ptr<const SurfaceDomain> domain_;
  bool first_ = true;  // the next linearize() is the first of its frame
  bool has_previous_ = false, has_before_previous_ = false;
  size_t row_local_, sum_items_;

  // Constants.
  ocl::Buffer<float> edge_weights_, rest_lengths_, rest_shares_;  // [n_entries]
  ocl::Buffer<float> depth_weights_, velocity_weights_;           // 1 plane
  ocl::Buffer<float> colors_;                                     // 3 planes
  ocl::Buffer<uint8_t> no_parts_;
  // State, planes of graph_.stride floats.
  ocl::Buffer<float> v_, skinned_, previous_, before_;                        // 3 planes, mm
  ocl::Buffer<float> blocks_, inverse_;                                       // 6 planes
  ocl::Buffer<float> residual_, preconditioned_, image_of_direction_, step_;  // 3 planes
  ocl::Buffer<float> direction_;                                // likewise; surface/direction.h, on GPUs twice
  ocl::Buffer<float> edges_;                                    // [3*n_entries]
  ocl::Buffer<float> products_;                                 // 1 plane
  ocl::Buffer<float> data_energies_[3], regularizer_energies_;  // 1, 1, 1, 5 planes
  ocl::Buffer<float> scalars_;                                  // [4]
  std::array<float, 8> totals_read_{};
  ocl::Buffer<float> totals_;  // [8]

  ocl::Kernel pack_, unpack_, photo_, silhouette_, match_, regularizer_;
  ocl::Kernel sum_energies_, move_;
  ocl::Kernel start_scalars_, alpha_, beta_, apply_, advance_, turn_;  // CPUs
  bool alone_ = false;  // a CPU with one compute unit: all iterations in one launch
  ocl::Kernel all_iterations_;
  // GPUs
  ocl::Kernel phases_;
  ocl::GroupsTogether groups_;
  ocl::Buffer<float> parts_;  // of the sums over rows
};

}  // namespace livecap
