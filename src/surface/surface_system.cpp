#include "surface/surface_system.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/round_up.h"
#include "livecap/error.h"
#include "match/layout.h"
#include "surface/layout.h"
#include "surface/programs.h"

namespace livecap {
namespace {

constexpr size_t kPhasesLocal = LC_PCG_GROUP;
constexpr int kMaxGaussian = LC_PHOTO_TAPS - 1;

void require_weight(float value, const char* name) {
  if (!(value >= 0.0f) || !std::isfinite(value)) {
    throw ConfigError(std::string("surface option ") + name + " is " + std::to_string(value) +
                      ": it must be finite and not negative");
  }
}

void require_share(float value, const char* name) {
  if (!(value >= 0.0f && value <= 1.0f))
    throw ConfigError(std::string("surface option ") + name + " is " + std::to_string(value) +
                      ": it must be from 0 to 1");
}

double rest_length(const Mesh& mesh, int i, int j) {
  double sum = 0;
  for (int a = 0; a < 3; ++a) {
    const double d = double(mesh.positions[3 * i + a]) - mesh.positions[3 * j + a];
    sum += d * d;
  }
  return std::sqrt(sum);
}

}  // namespace

double gaussian_sigma(int kernel_size) {
  return 0.3 * ((kernel_size - 1) * 0.5 - 1.0) + 0.8;
}

void SurfaceOptions::validate() const {
  require_weight(w_photo, "w_photo");
  require_weight(w_silhouette, "w_silhouette");
  require_weight(w_match, "w_match");
  require_weight(w_smooth, "w_smooth");
  require_weight(w_edge, "w_edge");
  require_weight(w_depth, "w_depth");
  require_weight(w_velocity, "w_velocity");
  require_weight(w_worn_velocity, "w_worn_velocity");
  require_weight(w_acceleration, "w_acceleration");
  require_weight(constant_rigidity, "constant_rigidity");
  require_weight(color_threshold, "color_threshold");
  if (!(damping > 0.0f) || !std::isfinite(damping)) throw ConfigError("surface option damping must be positive");
  if (!(max_step_mm > 0.0f)) throw ConfigError("surface option max_step_mm must be positive");
  require_share(edge_rest_share, "edge_rest_share");
  require_share(hanging_rest_share, "hanging_rest_share");
  if (pcg_iterations < 1) throw ConfigError("surface option pcg_iterations must be at least 1");
  if (gaussian_kernels.empty()) throw ConfigError("surface option gaussian_kernels is empty: give one size per step");
  for (const int size : gaussian_kernels) {
    if (size < 1 || size > kMaxGaussian || size % 2 == 0) {
      throw ConfigError("surface option gaussian_kernels holds " + std::to_string(size) +
                        ": sizes are odd, from 1 to 15");
    }
  }
}

SurfaceSystem::SurfaceSystem(ocl::DeviceContext& device, const Actor& actor, const Camera& camera,
                             const SurfaceOptions& options)
    : device_(&device), options_(options), domain_(std::make_shared<SurfaceDomain>(device, actor, camera)) {
  options.validate();
  const size_t plane = domain_->graph.stride;
  const auto planes = [&](int count) {
    ocl::Buffer<float> buffer(device, count * plane);
    buffer.fill(0.0f);
    return buffer;
  };
  edge_weights_ = {device, domain_->graph.per_entry([&](int i, int j) {
                     const double s = options.constant_rigidity > 0
                                          ? double(options.constant_rigidity)
                                          : 0.5 * (double(actor.rigidity[i]) + actor.rigidity[j]);
                     return s * (1.0 / domain_->graph.degree[i] + 1.0 / domain_->graph.degree[j]);
                   })};
  rest_lengths_ = {device, domain_->graph.per_entry([&](int i, int j) { return rest_length(actor.mesh, i, j); })};
  rest_shares_ = {device, domain_->graph.per_entry([&](int i, int j) {
                    return hangs(actor, i) && hangs(actor, j) ? options.hanging_rest_share : options.edge_rest_share;
                  })};
  const auto per_vertex = [&](float hanging, float other) {
    std::vector<float> weights(actor.n_vertices());
    for (int i = 0; i < actor.n_vertices(); ++i) weights[i] = hangs(actor, i) ? hanging : other;
    return ocl::Buffer<float>(device, domain_->graph.planes(weights, 1));
  };
  depth_weights_ = per_vertex(0, options.w_depth);
  velocity_weights_ = per_vertex(options.w_velocity, options.w_worn_velocity);
  colors_ = {device, domain_->graph.planes(actor.colors, 3)};
  no_parts_ = ocl::Buffer<uint8_t>(device, 1);
  v_ = planes(3);
  skinned_ = planes(3);
  previous_ = planes(3);
  before_ = planes(3);
  blocks_ = planes(6);
  inverse_ = planes(6);
  residual_ = planes(3);
  preconditioned_ = planes(3);
  direction_ = planes(device.is_cpu() ? 7 : 6);
  image_of_direction_ = planes(3);
  step_ = planes(3);
  edges_ = ocl::Buffer<float>(device, 3 * size_t(domain_->graph.n_entries));
  edges_.fill(0.0f);
  products_ = planes(1);
  for (auto& energy : data_energies_) energy = planes(1);
  regularizer_energies_ = planes(5);
  scalars_ = {device, std::vector<float>(4, 0.0f)};
  totals_ = {device, std::vector<float>(totals_read_.size(), 0.0f)};

  const bool cpu = device.is_cpu();
  row_local_ = 64;
  sum_items_ = cpu ? 1 : std::min<size_t>(256, device.info().max_work_group_size);

  pack_ = {device, kSurfaceProgram, "pack_planes"};
  unpack_ = {device, kSurfaceProgram, "unpack_planes"};
  photo_ = {device, kSurfaceProgram, "photo_system"};
  silhouette_ = {device, kSurfaceProgram, "silhouette_system"};
  match_ = {device, kSurfaceProgram, "match_system"};
  regularizer_ = {device, kSurfaceSlicesProgram, "regularizer_system"};
  sum_energies_ = {device, kSurfaceSlicesProgram, "sum_energies"};
  move_ = {device, kSurfaceSlicesProgram, "move_vertices"};
  if (cpu) {
    start_scalars_ = {device, kSurfaceSlicesProgram, "start_scalars"};
    alpha_ = {device, kSurfaceSlicesProgram, "alpha_scalar"};
    beta_ = {device, kSurfaceSlicesProgram, "beta_scalar"};
    apply_ = {device, kSurfaceSlicesProgram, "apply_system"};
    advance_ = {device, kSurfaceSlicesProgram, "advance"};
    turn_ = {device, kSurfaceSlicesProgram, "turn_direction"};
    alone_ = device.info().compute_units == 1;
    if (alone_) all_iterations_ = {device, kSurfaceSlicesProgram, "all_iterations"};
    return;
  }
  phases_ = {device, kSurfaceSlicesProgram, "pcg_phases"};
  const size_t most = round_up(domain_->graph.n_rows, kPhasesLocal) / kPhasesLocal;
  groups_ = ocl::GroupsTogether(device, std::min(most, kPhasesLocal));  // a work-item loads each group's part
  // Over zeros: shows whether it works, and compiles it.
  iterate_pcg(options.pcg_iterations);
  status();
  gave_up();
}

void SurfaceSystem::begin(const SurfaceInput& input) {
  const size_t n = domain_->graph.n;
  require_size(input.skinned, 3 * n, "surface: skinned");
  require_size(input.start, 3 * n, "surface: start");
  if (input.previous) require_size(*input.previous, 3 * n, "surface: previous");
  if (input.before_previous) require_size(*input.before_previous, 3 * n, "surface: before_previous");
  if (input.matches) require_size(*input.matches, LC_MATCH * n, "surface: matches");
  require_size(input.visible, n, "surface: visible");
  require_size(input.contour_flag, n, "surface: contour_flag");
  require_size(input.normals, 3 * n, "surface: normals");
  const size_t pixels = size_t(domain_->width) * domain_->height;
  require_size(input.frame.rgb, 3 * pixels, "surface: frame.rgb");
  require_size(input.frame.signed_distance, pixels, "surface: frame.signed_distance");
  if ((input.part_image == nullptr) != (input.vertex_part == nullptr)) {
    throw LogicError("surface: part_image and vertex_part go together");
  }
  if (input.part_image) {
    require_size(*input.part_image, pixels, "surface: part_image");
    require_size(*input.vertex_part, n, "surface: vertex_part");
  }

  const size_t n_arrays = input.previous && input.before_previous ? 4 : input.previous ? 3 : 2;
  pack_.launch(ocl::Range{round_up(domain_->graph.n_rows, row_local_), n_arrays, row_local_, 1}, domain_->graph.n,
               domain_->graph.n_rows, domain_->graph.stride, domain_->order, input.start, input.skinned,
               input.previous ? *input.previous : input.start, n_arrays == 4 ? *input.before_previous : input.start, v_,
               skinned_, previous_, before_);
  has_previous_ = input.previous != nullptr;
  has_before_previous_ = has_previous_ && input.before_previous;
  if (!input.matches) data_energies_[2].fill(0.0f);
  if (!input.continues) first_ = true;
}

void SurfaceSystem::linearize(const SurfaceInput& input, int gaussian_kernel) {
  const int n = domain_->graph.n, n_rows = domain_->graph.n_rows, stride = domain_->graph.stride;
  const double sigma = gaussian_sigma(gaussian_kernel);
  const size_t data_local = device_->is_cpu() ? 1 : 64;  // a CPU work-item fills its vector registers with taps
  photo_.launch(n_rows, data_local, n, n_rows, stride, domain_->width, domain_->height, gaussian_kernel / 2,
                float(1.0 / (sigma * sigma)), options_.w_photo, options_.color_threshold, domain_->camera,
                domain_->order, input.visible, input.frame.rgb, colors_, v_, blocks_, residual_, data_energies_[0]);
  const int has_parts = input.part_image ? 1 : 0;
  silhouette_.launch(n_rows, row_local_, n, n_rows, stride, domain_->width, domain_->height, options_.w_silhouette,
                     has_parts, domain_->camera, domain_->order, input.contour_flag, input.normals,
                     input.frame.signed_distance, has_parts ? *input.part_image : no_parts_,
                     has_parts ? *input.vertex_part : input.contour_flag, v_, blocks_, residual_, data_energies_[1]);
  if (input.matches) {
    match_.launch(n_rows, row_local_, n, n_rows, stride, options_.w_match, domain_->camera, domain_->order,
                  *input.matches, v_, blocks_, residual_, data_energies_[2]);
  }
  // Without an earlier frame the term is off; its positions must still be finite.
  const ocl::Buffer<float>& previous = has_previous_ ? previous_ : v_;
  const ocl::Buffer<float>& before = has_before_previous_ ? before_ : v_;
  regularizer_.launch(domain_->lane_items, domain_->lane_local, n_rows, stride, options_.w_smooth, options_.w_edge,
                      has_previous_ ? 1.0f : 0.0f, has_before_previous_ ? options_.w_acceleration : 0.0f,
                      options_.damping, domain_->slice_offsets, domain_->neighbors, edge_weights_, rest_lengths_,
                      rest_shares_, depth_weights_, velocity_weights_, v_, skinned_, previous, before, blocks_,
                      residual_, edges_, inverse_, preconditioned_, direction_, step_, products_,
                      regularizer_energies_);
  if (!device_->is_cpu()) return;
  start_scalars_.launch(sum_items_, sum_items_, n_rows, first_ ? 1 : 0, products_, scalars_);
  first_ = false;
}

// On GPUs, see pcg_phases.cl.
void SurfaceSystem::launch_phases(int first, int end) {
  const size_t n_parts = (size_t(end) + 2) * groups_.n();
  if (parts_.size() < n_parts) parts_ = ocl::Buffer<float>(*device_, n_parts);
  const int at_once = groups_.work() ? end - first : 1;
  for (int phase = first; phase < end; phase += at_once) {
    phases_.launch(groups_.n() * kPhasesLocal, kPhasesLocal, phase, phase + at_once, groups_.arrived(), first_ ? 1 : 0,
                   domain_->graph.n_rows, domain_->graph.stride, options_.w_smooth, domain_->slice_offsets,
                   domain_->neighbors, edge_weights_, edges_, blocks_, inverse_, products_, direction_,
                   image_of_direction_, step_, residual_, preconditioned_, parts_, scalars_, groups_.state());
    groups_.launched(at_once - 1);
  }
}

void SurfaceSystem::apply() {
  if (!device_->is_cpu()) {
    launch_phases(0, 1);
    return;
  }
  apply_.launch(domain_->lane_items, domain_->lane_local, domain_->graph.n_rows, domain_->graph.stride,
                options_.w_smooth, domain_->slice_offsets, domain_->neighbors, edge_weights_, edges_, blocks_,
                direction_, image_of_direction_, products_);
}

void SurfaceSystem::turn_direction() {
  turn_.launch(domain_->lane_items, domain_->lane_local, domain_->graph.n_rows, domain_->graph.stride, scalars_,
               preconditioned_, direction_);
}

void SurfaceSystem::iterate_pcg(int iterations) {
  if (!device_->is_cpu()) {
    launch_phases(0, 2 * iterations);
    first_ = false;
    return;
  }
  if (alone_) {
    all_iterations_.launch(1, 1, iterations, domain_->graph.n_rows, domain_->graph.stride, options_.w_smooth,
                           domain_->slice_offsets, domain_->neighbors, edge_weights_, edges_, blocks_, inverse_,
                           direction_, image_of_direction_, step_, residual_, preconditioned_, products_, scalars_);
    return;
  }
  for (int k = 0; k < iterations; ++k) {
    if (k > 0) {
      beta_.launch(sum_items_, sum_items_, domain_->graph.n_rows, products_, scalars_);
      turn_direction();
    }
    apply();
    alpha_.launch(sum_items_, sum_items_, domain_->graph.n_rows, products_, scalars_);
    advance_.launch(domain_->lane_items, domain_->lane_local, domain_->graph.n_rows, domain_->graph.stride, scalars_,
                    inverse_, direction_, image_of_direction_, step_, residual_, preconditioned_, products_);
  }
}

void SurfaceSystem::move() {
  move_.launch(domain_->lane_items, domain_->lane_local, domain_->graph.n_rows, domain_->graph.stride,
               options_.max_step_mm, step_, v_);
}

void SurfaceSystem::finish(const SurfaceInput& input, ocl::Buffer<float>& out) {
  require_size(out, 3 * size_t(domain_->graph.n), "surface: out");
  unpack_.launch(domain_->graph.n, row_local_, domain_->graph.n, domain_->graph.stride, domain_->order, scalars_, v_,
                 input.start, out);
}

SurfaceStatus SurfaceSystem::status() {
  groups_.read_later();
  totals_.read_later(totals_read_);
  return scalars_.read_all()[3] == 0.0f ? SurfaceStatus::kOk : SurfaceStatus::kNonFinite;
}

SurfaceEnergies SurfaceSystem::energies() {
  sum_energies();
  totals_.read(totals_read_);
  return summed_energies();
}

void SurfaceSystem::sum_energies() {
  sum_energies_.launch(totals_.size() * sum_items_, sum_items_, domain_->graph.n_rows, domain_->graph.stride,
                       data_energies_[0], data_energies_[1], data_energies_[2], regularizer_energies_, totals_);
}

SurfaceEnergies SurfaceSystem::summed_energies() const {
  const auto& totals = totals_read_;
  return {.photo = totals[0],
          .silhouette = totals[1],
          .match = totals[2],
          .smooth = totals[3],
          .edge = totals[4],
          .depth = totals[7],
          .velocity = totals[5],
          .acceleration = totals[6]};
}

std::vector<float> SurfaceSystem::from_planes(const ocl::Buffer<float>& planes, int width) const {
  const std::vector<float> values = planes.read_all();
  std::vector<float> out(size_t(width) * domain_->graph.n);
  for (int r = 0; r < domain_->graph.n; ++r)
    for (int a = 0; a < width; ++a)
      out[size_t(width) * domain_->graph.order[r] + a] = values[size_t(a) * domain_->graph.stride + r];
  return out;
}

std::vector<float> SurfaceSystem::right_hand_side() const {
  return from_planes(residual_, 3);
}
std::vector<float> SurfaceSystem::step() const {
  return from_planes(step_, 3);
}

std::vector<float> SurfaceSystem::product(const std::vector<float>& direction) {
  preconditioned_.write(domain_->graph.planes(direction, 3));
  if (device_->is_cpu()) {
    direction_.fill(0.0f);
    turn_direction();
  }
  apply();
  return from_planes(image_of_direction_, 3);
}

}  // namespace livecap
