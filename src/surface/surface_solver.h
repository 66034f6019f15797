// Stage II: the non-rigid surface of one frame (paper, "Non-rigid Surface Registration"). Three Gauss-Newton steps, one
// per Gaussian level, twelve preconditioned conjugate gradient iterations each, all on the device.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "surface/surface_system.h"

namespace livecap {

struct SurfaceResult {
  const ocl::Buffer<float>* vertices = nullptr;  // [3n] mm, camera frame; the solver's own, valid until its next solve
  SurfaceEnergies energies;                      // of the vertices, photometric at the last Gaussian level; zero if
                                                 // the status is not kOk
  SurfaceStatus status = SurfaceStatus::kOk;
};

class SurfaceSolver {
 public:
  // camera: undistorted. Keeps a reference to the device only. Throws ConfigError for options, actor or camera that do
  // not fit each other, OclError when the kernels do not build.
  SurfaceSolver(ocl::DeviceContext& device, const Actor& actor, const Camera& camera,
                const SurfaceOptions& options = {});

  // A step at each of these Gaussian levels, enqueued. Throws LogicError for buffers of a wrong size.
  void launch(const SurfaceInput& input, std::span<const int> gaussian_kernels);
  // The energies of the vertices of the last launch, enqueued. input: of that launch.
  void measure(const SurfaceInput& input);
  // What was launched and measured last; blocks once. Nothing where the device did not do all of it: launch again.
  std::optional<SurfaceResult> result();
  // All three, at the levels of the options.
  SurfaceResult solve(const SurfaceInput& input);
  // Of the last launch, for what is enqueued behind it.
  const ocl::Buffer<float>& vertices() const { return vertices_; }

  // For a Snapper of the same template and camera.
  std::shared_ptr<const SurfaceDomain> domain() const { return system_.domain(); }

 private:
  SurfaceOptions options_;
  SurfaceSystem system_;
  ocl::Buffer<float> vertices_;  // [3n]
};

// Known-answer tests of every kernel of this room.
std::vector<ocl::SelfTestResult> surface_self_test(ocl::DeviceContext& device);

}  // namespace livecap
