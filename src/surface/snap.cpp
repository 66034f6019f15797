#include "surface/snap.h"

#include <cmath>
#include <string>
#include <utility>

#include "livecap/error.h"

namespace livecap {
namespace {

template <typename T>
void require_size(const ocl::Buffer<T>& buffer, size_t expected, const char* name) {
  if (buffer.size() != expected) {
    throw LogicError(std::string("snap: ") + name + " has " + std::to_string(buffer.size()) + " elements, expected " +
                     std::to_string(expected));
  }
}

}  // namespace

void SnapOptions::validate() const {
  if (!(max_rigidity >= 0.0f)) throw ConfigError("snap option max_rigidity must not be negative");
  if (!(max_move_px > 0.0f)) throw ConfigError("snap option max_move_px must be positive");
  if (n_rings < 0 || n_rings > 100) throw ConfigError("snap option n_rings must be from 0 to 100");
  if (relaxations < 0) throw ConfigError("snap option relaxations must not be negative");
}

Snapper::Snapper(ocl::DeviceContext& device, const Actor& actor, const Camera& camera, const SnapOptions& options)
    : options_(options),
      graph_(make_sell_graph(actor.mesh)),
      camera_(pinhole_arg(camera)),
      width_(camera.width),
      height_(camera.height) {
  options.validate();
  camera.validate();
  if (camera.has_distortion()) throw ConfigError("snap: the camera must be undistorted");
  if (width_ < 2 || height_ < 2) throw ConfigError("snap: the image must be at least 2x2 px");
  if (graph_.n == 0) throw ConfigError("snap: the template mesh is empty");
  if (actor.rigidity.size() != size_t(graph_.n)) throw ConfigError("snap: the actor needs one rigidity per vertex");
  order_ = {device, graph_.order};
  slice_offsets_ = {device, graph_.slice_offsets};
  neighbors_ = {device, graph_.neighbors};
  rigidity_ = {device, graph_.planes(actor.rigidity, 1)};
  rings_ = ocl::Buffer<float>(device, graph_.stride);
  moves_ = ocl::Buffer<float>(device, 2 * size_t(graph_.stride));
  rings_after_ = ocl::Buffer<float>(device, graph_.stride);
  moves_after_ = ocl::Buffer<float>(device, 2 * size_t(graph_.stride));
  no_parts_ = ocl::Buffer<uint8_t>(device, 1);
  rings_.fill(0.0f);
  moves_.fill(0.0f);
  rings_after_.fill(0.0f);
  moves_after_.fill(0.0f);
  lane_items_ = device.is_cpu() ? graph_.n_rows / kSlice : graph_.n_rows;
  lane_local_ = device.is_cpu() ? 1 : 64;
  targets_ = {device, "surface/snap_targets.cl", "snap_targets"};
  apply_ = {device, "surface/snap_targets.cl", "snap_apply"};
  spread_ = {device, "surface/snap_warp.cl", "snap_spread"};
  relax_ = {device, "surface/snap_warp.cl", "snap_relax"};
}

void Snapper::snap(const SnapInput& input, ocl::Buffer<float>& vertices) {
  const size_t n = graph_.n;
  const size_t pixels = size_t(width_) * height_;
  require_size(vertices, 3 * n, "vertices");
  require_size(input.contour_flag, n, "contour_flag");
  require_size(input.normals, 3 * n, "normals");
  require_size(input.frame.signed_distance, pixels, "frame.signed_distance");
  if ((input.part_image == nullptr) != (input.vertex_part == nullptr)) {
    throw LogicError("snap: part_image and vertex_part go together");
  }
  if (input.part_image) {
    require_size(*input.part_image, pixels, "part_image");
    require_size(*input.vertex_part, n, "vertex_part");
  }

  const int n_rows = graph_.n_rows, stride = graph_.stride;
  const int has_parts = input.part_image ? 1 : 0;
  targets_.launch(n_rows, 64, graph_.n, n_rows, stride, width_, height_, options_.max_rigidity, options_.max_move_px,
                  has_parts, camera_, order_, rigidity_, input.contour_flag, input.normals, input.frame.signed_distance,
                  has_parts ? *input.part_image : no_parts_, has_parts ? *input.vertex_part : input.contour_flag,
                  vertices, moves_, rings_);
  for (int ring = 1; ring <= options_.n_rings; ++ring) {
    // Linear fall-off to zero at n_rings + 1.
    const float fall = float(options_.n_rings + 1 - ring) / float(options_.n_rings + 2 - ring);
    spread_.launch(lane_items_, lane_local_, n_rows, stride, float(ring), fall, slice_offsets_, neighbors_, rings_,
                   moves_, rings_after_, moves_after_);
    std::swap(rings_, rings_after_);
    std::swap(moves_, moves_after_);
  }
  // The two sets of moves now differ in the last ring only, which every sweep writes.
  for (int k = 0; options_.n_rings > 0 && k < options_.relaxations; ++k) {
    relax_.launch(lane_items_, lane_local_, n_rows, stride, float(options_.n_rings), slice_offsets_, neighbors_, rings_,
                  moves_, moves_after_);
    std::swap(moves_, moves_after_);
  }
  apply_.launch(n, 64, graph_.n, stride, float(options_.n_rings), order_, rings_, moves_, vertices);
}

std::vector<float> Snapper::rings() const {
  const std::vector<float> rows = rings_.read_all();
  std::vector<float> out(graph_.n);
  for (int r = 0; r < graph_.n; ++r) out[graph_.order[r]] = rows[r];
  return out;
}

}  // namespace livecap
