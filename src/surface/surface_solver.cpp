#include "surface/surface_solver.h"

namespace livecap {

SurfaceSolver::SurfaceSolver(ocl::DeviceContext& device, const Actor& actor, const Camera& camera,
                             const SurfaceOptions& options)
    : options_(options), system_(device, actor, camera, options), vertices_(device, 3 * size_t(actor.n_vertices())) {}

void SurfaceSolver::launch(const SurfaceInput& input, std::span<const int> gaussian_kernels) {
  system_.begin(input);
  for (const int kernel : gaussian_kernels) {
    system_.linearize(input, kernel);
    system_.iterate_pcg(options_.pcg_iterations);
    system_.move();
  }
  system_.finish(input, vertices_);
}

void SurfaceSolver::measure(const SurfaceInput& input) {
  system_.linearize(input, options_.gaussian_kernels.back());
  system_.sum_energies();
}

std::optional<SurfaceResult> SurfaceSolver::result() {
  SurfaceResult result;
  result.vertices = &vertices_;
  result.status = system_.status();
  if (system_.gave_up()) return std::nullopt;
  if (result.status == SurfaceStatus::kOk) result.energies = system_.summed_energies();
  return result;
}

SurfaceResult SurfaceSolver::solve(const SurfaceInput& input) {
  std::optional<SurfaceResult> solved;
  while (!solved) {
    launch(input, options_.gaussian_kernels);
    measure(input);
    solved = result();
  }
  return *solved;
}

}  // namespace livecap
