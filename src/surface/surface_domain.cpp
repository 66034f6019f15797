#include "surface/surface_domain.h"

#include "ocl/lanes.h"

namespace livecap {

SurfaceDomain::SurfaceDomain(ocl::DeviceContext& device, const Actor& actor, const Camera& undistorted)
    : graph(make_sell_graph(actor.mesh)),
      lane_items(ocl::lane_items(graph.n_rows, device.lanes())),
      lane_local(device.is_cpu() ? 1 : 64),
      camera(pinhole_arg(undistorted)),
      width(undistorted.width),
      height(undistorted.height) {
  undistorted.validate();
  if (undistorted.has_distortion()) throw ConfigError("surface: the camera must be undistorted");
  if (width < 2 || height < 2) throw ConfigError("surface: the image must be at least 2x2 px");
  const size_t n = graph.n;
  if (n == 0) throw ConfigError("surface: the template mesh is empty");
  if (actor.rigidity.size() != n || actor.colors.size() != 3 * n) {
    throw ConfigError("surface: the actor needs one rigidity and one colour per vertex (" + std::to_string(n) +
                      "), it has " + std::to_string(actor.rigidity.size()) + " and " +
                      std::to_string(actor.colors.size() / 3));
  }
  order = {device, graph.order};
  slice_offsets = {device, graph.slice_offsets};
  neighbors = {device, graph.neighbors};
}

}  // namespace livecap
