#include "surface/snap.h"

#include <cmath>
#include <string>
#include <utility>

#include "base/round_up.h"
#include "livecap/error.h"
#include "surface/programs.h"

namespace livecap {
namespace {

constexpr size_t kLocal = 64;

}  // namespace

void SnapOptions::validate() const {
  if (!(max_rigidity >= 0.0f)) throw ConfigError("snap option max_rigidity must not be negative");
  if (!(max_move_px > 0.0f)) throw ConfigError("snap option max_move_px must be positive");
  if (n_rings < 0 || n_rings > 100) throw ConfigError("snap option n_rings must be from 0 to 100");
  if (relaxations < 0) throw ConfigError("snap option relaxations must not be negative");
}

Snapper::Snapper(ocl::DeviceContext& device, const Actor& actor, std::shared_ptr<const SurfaceDomain> domain,
                 const SnapOptions& options)
    : options_(options), domain_(std::move(domain)), is_cpu_(device.is_cpu()) {
  options.validate();
  if (actor.rigidity.size() != size_t(domain_->graph.n)) throw LogicError("snap: the domain is of another actor");
  rigidity_ = {device, domain_->graph.planes(actor.rigidity, 1)};
  rings_ = ocl::Buffer<float>(device, domain_->graph.stride);
  moves_ = ocl::Buffer<float>(device, 2 * size_t(domain_->graph.stride));
  rings_after_ = ocl::Buffer<float>(device, domain_->graph.stride);
  moves_after_ = ocl::Buffer<float>(device, 2 * size_t(domain_->graph.stride));
  no_parts_ = ocl::Buffer<uint8_t>(device, 1);
  rings_.fill(0.0f);
  moves_.fill(0.0f);
  rings_after_.fill(0.0f);
  moves_after_.fill(0.0f);
  targets_ = {device, kSurfaceProgram, "snap_targets"};
  apply_ = {device, kSurfaceProgram, "snap_apply"};
  if (is_cpu_) {
    spread_ = {device, kSurfaceSlicesProgram, "snap_spread"};
    relax_ = {device, kSurfaceSlicesProgram, "snap_relax"};
    return;
  }
  rounds_ = {device, kSurfaceSlicesProgram, "snap_rounds"};
  groups_ = ocl::GroupsTogether(device, round_up(domain_->graph.n_rows, kLocal) / kLocal);
  // Over zeros: shows whether it works, and compiles it.
  warp_in_rounds();
  rings_.read_all();
  gave_up();
}

// On GPUs.
void Snapper::warp_in_rounds() {
  const int n = options_.n_rings > 0 ? options_.n_rings + options_.relaxations : 0;
  const int at_once = groups_.work() ? n : 1;
  for (int round = 0; round < n; round += at_once) {
    rounds_.launch(groups_.n() * kLocal, kLocal, round, round + at_once, groups_.arrived(), domain_->graph.n_rows,
                   domain_->graph.stride, options_.n_rings, domain_->slice_offsets, domain_->neighbors, rings_,
                   rings_after_, moves_, moves_after_, groups_.state());
    groups_.launched(at_once - 1);
  }
  if (options_.n_rings % 2 == 1) std::swap(rings_, rings_after_);
  if (n % 2 == 1) std::swap(moves_, moves_after_);
  groups_.read_later();
}

void Snapper::snap(const SnapInput& input, ocl::Buffer<float>& vertices) {
  const size_t n = domain_->graph.n;
  const size_t pixels = size_t(domain_->width) * domain_->height;
  require_size(vertices, 3 * n, "snap: vertices");
  require_size(input.contour_flag, n, "snap: contour_flag");
  require_size(input.normals, 3 * n, "snap: normals");
  require_size(input.frame.signed_distance, pixels, "snap: frame.signed_distance");
  if ((input.part_image == nullptr) != (input.vertex_part == nullptr)) {
    throw LogicError("snap: part_image and vertex_part go together");
  }
  if (input.part_image) {
    require_size(*input.part_image, pixels, "snap: part_image");
    require_size(*input.vertex_part, n, "snap: vertex_part");
  }

  const int n_rows = domain_->graph.n_rows, stride = domain_->graph.stride;
  const int has_parts = input.part_image ? 1 : 0;
  targets_.launch(n_rows, 64, domain_->graph.n, n_rows, stride, domain_->width, domain_->height, options_.max_rigidity,
                  options_.max_move_px, has_parts, domain_->camera, domain_->order, rigidity_, input.contour_flag,
                  input.normals, input.frame.signed_distance, has_parts ? *input.part_image : no_parts_,
                  has_parts ? *input.vertex_part : input.contour_flag, vertices, moves_, rings_);
  if (is_cpu_)
    warp_by_launches();
  else
    warp_in_rounds();
  apply_.launch(n, 64, domain_->graph.n, stride, float(options_.n_rings), domain_->order, rings_, moves_, vertices);
}

void Snapper::warp_by_launches() {
  const int n_rows = domain_->graph.n_rows, stride = domain_->graph.stride;
  for (int ring = 1; ring <= options_.n_rings; ++ring) {
    // Linear fall-off to zero at n_rings + 1.
    const float fall = float(options_.n_rings + 1 - ring) / float(options_.n_rings + 2 - ring);
    spread_.launch(domain_->lane_items, domain_->lane_local, n_rows, stride, float(ring), fall, domain_->slice_offsets,
                   domain_->neighbors, rings_, moves_, rings_after_, moves_after_);
    std::swap(rings_, rings_after_);
    std::swap(moves_, moves_after_);
  }
  // The two sets of moves now differ in the last ring only, which every sweep writes.
  for (int k = 0; options_.n_rings > 0 && k < options_.relaxations; ++k) {
    relax_.launch(domain_->lane_items, domain_->lane_local, n_rows, stride, float(options_.n_rings),
                  domain_->slice_offsets, domain_->neighbors, rings_, moves_, moves_after_);
    std::swap(moves_, moves_after_);
  }
}

std::vector<float> Snapper::rings() const {
  const std::vector<float> rows = rings_.read_all();
  std::vector<float> out(domain_->graph.n);
  for (int r = 0; r < domain_->graph.n; ++r) out[domain_->graph.order[r]] = rows[r];
  return out;
}

}  // namespace livecap
