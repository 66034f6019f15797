#include "pose/pose_system.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/round_up.h"
#include "base/text.h"
#include "geometry/mesh.h"
#include "livecap/error.h"
#include "ocl/lanes.h"
#include "shared/exact_sum.h"

namespace livecap {
namespace {

constexpr const char* kProgram = "pose/pose.cl";
constexpr const char* kSkinnedProgram = "pose/slices.cl";
constexpr const char* kGpuProgram = "pose/gauss_newton.cl";
constexpr const char* kChoiceProgram = "pose/choose.cl";
constexpr int kTile = 8;
// The bones of a contour row are packed into bytes.
constexpr int kMaxBones = LC_POSE_NO_BONE;

static_assert(LC_POSE_KEYPOINTS == kKeypointCount);
static_assert(sizeof(PoseLayout) == 20 && sizeof(PoseContour) == 20 && sizeof(PoseInputs) == 48 &&
              sizeof(PoseChoice) == 28 && sizeof(PoseStepsArg) == 60);

void require(bool ok, const std::string& message) {
  if (!ok) throw LogicError("pose: " + message);
}

// Of a work-group on a GPU, and a few integers.
size_t local_bytes(const PoseLayout& layout, bool takes_steps) {
  return sizeof(float) * (LC_POSE_ROWS_SIZE(layout) + LC_POSE_NEAR_SIZE(layout)) +
         sizeof(double) * (takes_steps ? LC_POSE_LOCAL(layout) : 1) + 64;
}

void check_actor(const Actor& actor, const SkinWeights& skin) {
  actor.skeleton.validate();
  const size_t n = actor.n_vertices();
  require(actor.skeleton.n_bones() <= kMaxBones,
          format("actor has %d bones, at most %d", actor.skeleton.n_bones(), kMaxBones));
  require(skin.bones.size() == 4 * n && skin.weights.size() == 4 * n,
          format("skin has %zu bones and %zu weights for %zu vertices, 4 each needed", skin.bones.size(),
                 skin.weights.size(), n));
  for (int32_t bone : skin.bones)
    require(bone >= 0 && bone < actor.skeleton.n_bones(), format("skin refers to bone %d", bone));
  for (const KeypointAnchor& anchor : actor.keypoints)
    require(anchor.bone < actor.skeleton.n_bones(), format("keypoint anchor refers to bone %d", anchor.bone));
}

}  // namespace

PoseSystem::PoseSystem(ocl::DeviceContext& device, const Actor& actor, const SkinWeights& skin, const Camera& camera,
                       const PoseOptions& options)
    : points_{actor.skeleton, actor.keypoints, sole_points(actor)},
      options_(options),
      width_(camera.width),
      height_(camera.height),
      pinhole_(pinhole_arg(camera)),
      n_vertices_(actor.n_vertices()) {
  check_actor(actor, skin);
  camera.validate();
  options.validate();
  require(width_ >= 2 && height_ >= 2, format("camera picture is %d x %d", width_, height_));
  const Skeleton& skeleton = actor.skeleton;
  layout_.n_dofs = skeleton.n_dofs();
  layout_.n_unknowns = layout_.n_dofs + 9;
  is_cpu_ = device.is_cpu();
  layout_.n_columns = int(round_up(layout_.n_unknowns + 1, LC_POSE_FILL_COLUMNS(is_cpu_)));
  layout_.n_bones = skeleton.n_bones();
  layout_.n_soles = int(points_.soles.size());
  n_point_rows_ = LC_POSE_POINT_ROWS + 2 * layout_.n_dofs + layout_.n_soles;
  const int side = layout_.n_columns / kTile;
  n_tiles_ = side * (side + 1) / 2;
  lanes_ = device.lanes();

  // Every column but t' and the residual's moves bones: the root's six all of them, a joint those below it.
  std::vector<float> moves(size_t(layout_.n_bones) * layout_.n_columns, 0.0f);
  const std::vector<uint64_t> masks = dofs_moving_bones(skeleton);
  for (int b = 0; b < layout_.n_bones; ++b) {
    float* row = &moves[size_t(b) * layout_.n_columns];
    std::fill(row, row + 6, 1.0f);
    for (int k = 0; k < layout_.n_dofs; ++k) row[6 + k] = masks[b] >> k & 1 ? 1.0f : 0.0f;
  }
  for (const Dof& dof : skeleton.dofs)
    limits_host_.insert(limits_host_.end(), {float(dof.min_rad), float(dof.max_rad), 0.0f, 0.0f});
  const size_t n_contour = round_up(options.max_contour_vertices, LC_POSE_SLICE);
  step_host_.resize(LC_POSE_STEP_SIZE(layout_));
  gram_host_.resize(LC_POSE_GRAM_SIZE(layout_));
  inputs_ = PoseRowInputs(layout_, options, n_vertices_, is_cpu_ ? 1 : LC_POSE_MOST_ROUNDS);
  inputs_on_device_ = ocl::Buffer<float>(device, inputs_.words().size());
  links_ = ocl::Buffer<int32_t>(device, chain_links(points_));
  limits_ = ocl::Buffer<float>(device, limits_host_);
  set_rest(rest_angles(actor, {}, nullptr, options));
  moves_ = ocl::Buffer<float>(device, moves);
  rest_ = ocl::Buffer<float>(device, actor.mesh.positions);
  rest_normals_ = ocl::Buffer<float>(device, vertex_normals(actor.mesh.positions, actor.mesh.triangles));
  bones_ = ocl::Buffer<int32_t>(device, skin.bones);
  weights_ = ocl::Buffer<float>(device, skin.weights);
  const size_t n_matches = round_up(options.max_matches, LC_POSE_SLICE);
  const size_t n_shaded = round_up(options.max_shaded, LC_POSE_SLICE);
  J_ = ocl::Buffer<float>(device, (n_point_rows_ + n_contour + 2 * n_matches + n_shaded) * layout_.n_columns + kTile);
  gram_ = ocl::Buffer<float>(device, gram_host_);  // zeros
  step_ = ocl::Buffer<float>(device, step_host_.size());
  if (!is_cpu_) {
    const auto parts = [](size_t n_rows) { return round_up(n_rows, LC_POSE_GROUP_ROWS) / LC_POSE_GROUP_ROWS; };
    const size_t most_parts = parts(n_point_rows_) + parts(n_contour) + parts(2 * n_matches) + parts(n_shaded);
    groups_ = ocl::GroupsTogether(device, most_parts);
    const uint64_t local = device.info().local_memory_bytes;
    if (local_bytes(layout_, false) > local)
      throw OclError(
          format("%d bones with %d degrees of freedom need %zu bytes of local memory in the pose stage; %s has "
                 "%llu",
                 layout_.n_bones, layout_.n_unknowns, local_bytes(layout_, false), device.info().label().c_str(),
                 static_cast<unsigned long long>(local)));
    takes_steps_ = device.info().has_double && local_bytes(layout_, true) <= local;
    chain_ = ocl::Buffer<double>(device, chain_constants(layout_, points_));
    parts_ = ocl::Buffer<uint64_t>(device, most_parts * gram_.size());
    sums_ = ocl::Buffer<uint64_t>(device, 2 * gram_.size());
    for (ocl::Buffer<uint64_t>* words : {&parts_, &sums_}) words->fill(0);
    most_rows_ = n_point_rows_ + n_contour + 2 * n_matches + n_shaded;
    results_ = ocl::Buffer<float>(device, LC_POSE_RESULT_RESIDUALS(layout_) + most_rows_);
    results_.fill(0);
    moved_ = ocl::Buffer<float>(device, 1);
    motions_ = ocl::Buffer<float>(device, size_t(8) * layout_.n_bones);
    kept_ = ocl::Buffer<double>(device, LC_POSE_KEPT(layout_));
    look_state_ = ocl::Buffer<int32_t>(device, 2);
    choice_state_ = ocl::Buffer<int32_t>(device, 6);
    moved_.fill(0);
    for (ocl::Buffer<int32_t>* state : {&look_state_, &choice_state_}) state->fill(0);
    const std::string option =
        format("-D LC_POSE_TAKES_STEPS=%d -D LC_POSE_SYSTEM_SIDE=%d", takes_steps_ ? 1 : 0, LC_POSE_SIDE(layout_));
    gauss_newton_kernel_ = ocl::Kernel(device, kGpuProgram, "pose_gauss_newton", option);
    sum_parts_kernel_ = ocl::Kernel(device, kGpuProgram, "pose_sum_parts", option);
    chooses_ = takes_steps_ && size_t(width_) * height_ < LC_EXACT_MOST_PX &&
               device.info().max_work_group_size >= LC_POSE_CHOICE_GROUP &&
               device.info().local_memory_bytes >= LC_POSE_CHOICE_LOCAL;
    if (!chooses_) return;
    n_slices_ = std::clamp<size_t>(device.info().compute_units / 3, 1, LC_POSE_CHOICE_MOST_SLICES);
    choice_told_ = ocl::Buffer<int64_t>(device, LC_POSE_CHOICE_TOLD * n_slices_);
    inputs_on_device_.fill(0);  // so that no vertex is out of range where a wait is given up
    choose_kernel_ = ocl::Kernel(device, kChoiceProgram, "pose_choose");
    return;
  }
  point_records_ = ocl::Buffer<float>(device, size_t(LC_POSE_RECORD) * n_point_rows_);
  contour_records_ = ocl::Buffer<float>(device, size_t(LC_POSE_RECORD) * n_contour);
  match_records_ = ocl::Buffer<float>(device, 2 * LC_POSE_RECORD * n_matches);
  shading_records_ = ocl::Buffer<float>(device, LC_POSE_RECORD * n_shaded);
  point_residuals_ = ocl::Buffer<float>(device, n_point_rows_);
  contour_residuals_ = ocl::Buffer<float>(device, n_contour);
  match_residuals_ = ocl::Buffer<float>(device, 2 * n_matches);
  shading_residuals_ = ocl::Buffer<float>(device, n_shaded);
  point_records_kernel_ = ocl::Kernel(device, kProgram, "pose_point_records");
  contour_records_kernel_ = ocl::Kernel(device, kSkinnedProgram, "pose_contour_records");
  match_records_kernel_ = ocl::Kernel(device, kSkinnedProgram, "pose_match_records");
  shading_records_kernel_ = ocl::Kernel(device, kSkinnedProgram, "pose_shading_records");
  fill_points_kernel_ = ocl::Kernel(device, kProgram, "pose_fill_point_rows");
  fill_skinned_kernel_ = ocl::Kernel(device, kProgram, "pose_fill_skinned_rows");
  gram_kernel_ = ocl::Kernel(device, kProgram, "pose_gram");
}

void PoseSystem::set_frame(const KeypointTargets& targets, const DeviceFrame* frame,
                           std::span<const int32_t> contour_vertices, std::span<const VertexMatch> matches,
                           std::span<const ShadedVertex> shaded) {
  seen_.reset();
  inputs_.set_targets(targets);
  inputs_.set_vertices(frame ? contour_vertices : std::span<const int32_t>{}, matches, shaded);
  set_picture(n_contour() > 0 ? frame : nullptr);
}

void PoseSystem::set_seen_frame(const KeypointTargets& targets, const DeviceFrame* frame, const SeenVertices& seen) {
  require(chooses(), "the device does not choose vertices");
  seen_ = seen;
  inputs_.set_targets(targets);
  inputs_.set_choice(seen);
  set_picture(frame);
}

// frame: nullptr where no contour vertex is looked at in it.
void PoseSystem::set_picture(const DeviceFrame* frame) {
  inputs_changed_ = true;
  frame_ = frame;
  if (!frame) return;
  if (frame->width != width_ || frame->height != height_)
    throw LogicError(
        format("pose: frame is %d x %d, the camera %d x %d", frame->width, frame->height, width_, height_));
}

void PoseSystem::set_floor(const Floor* floor, std::span<const double> stands) {
  inputs_.set_floor(floor, stands);
  inputs_changed_ = true;
}

void PoseSystem::set_rest(std::span<const RestAngle> rest) {
  require(rest.size() == size_t(layout_.n_dofs), format("%zu angles have a rest, not %d", rest.size(), layout_.n_dofs));
  const std::vector<float> before = limits_host_;
  for (size_t k = 0; k < rest.size(); ++k) {
    limits_host_[4 * k + 2] = float(rest[k].rad);
    limits_host_[4 * k + 3] = float(std::sqrt(rest[k].weight));
  }
  if (limits_host_ != before) limits_.write_later(limits_host_);
}

void PoseSystem::upload(const PoseState& state) {
  size_t n_start = 0;
  if (takes_steps_) {
    inputs_.set_start(state_values(state));
    n_start = 2 * LC_POSE_STATE_SIZE(layout_);
  } else {
    write_step(layout_, points_, state, step_host_);
    step_.write_later(step_host_);
  }
  inputs_on_device_.write_later(!inputs_changed_ ? inputs_.words().first(n_start)
                                : seen_          ? inputs_.words_given()
                                                 : inputs_.words());
  inputs_changed_ = false;
}

// On CPUs.
void PoseSystem::launch_records() {
  const auto lane_items = [this](int n) { return ocl::lane_items(n, lanes_); };
  point_records_kernel_.launch(kKeypointCount + 2 * layout_.n_dofs + layout_.n_soles, 0, layout_, pinhole_,
                               float(options_.keypoint_2d_huber_px), float(std::sqrt(options_.weights.anatomic)),
                               inputs_.places(), step_, inputs_on_device_, links_, limits_, point_records_,
                               point_residuals_);
  if (n_matches() > 0)
    match_records_kernel_.launch(lane_items(n_matches()), 1, layout_, pinhole_, n_matches(),
                                 float(match_px_ * options_.match_huber_px), inputs_.places(), step_, inputs_on_device_,
                                 rest_, bones_, weights_, match_records_, match_residuals_);
  if (n_shaded() > 0)
    shading_records_kernel_.launch(lane_items(n_shaded()), 1, layout_, n_shaded(), float(options_.shading_huber),
                                   inputs_.places(), step_, inputs_on_device_, rest_normals_, bones_, weights_,
                                   shading_records_, shading_residuals_);
  if (n_contour() == 0) return;
  contour_records_kernel_.launch(lane_items(n_contour()), 1, layout_, pinhole_, contour_arg(), inputs_.places(), step_,
                                 inputs_on_device_, rest_, rest_normals_, bones_, weights_, frame_->signed_distance,
                                 contour_records_, contour_residuals_);
}

PoseContour PoseSystem::contour_arg() const {
  return {n_contour(), width_, height_, contour_root(), float(options_.silhouette_huber_px)};
}

// On CPUs.
void PoseSystem::launch_rows() {
  const size_t blocks = layout_.n_columns / LC_POSE_FILL_COLUMNS(true), step = LC_POSE_FILL_ROWS;
  const auto over = [&](int n_rows) { return ocl::Range{blocks, round_up(n_rows, step) / step, 1, 1}; };
  fill_points_kernel_.launch(over(n_point_rows_), layout_, n_point_rows_, step_, moves_, point_records_,
                             point_residuals_, J_);
  fill_skinned_kernel_.launch(over(n_contour()), layout_, n_contour(), 1, n_point_rows_, step_, moves_,
                              contour_records_, contour_residuals_, J_);
  fill_skinned_kernel_.launch(over(2 * n_matches()), layout_, 2 * n_matches(), 2, n_point_rows_ + n_contour(), step_,
                              moves_, match_records_, match_residuals_, J_);
  fill_skinned_kernel_.launch(over(n_shaded()), layout_, n_shaded(), 1, n_point_rows_ + n_contour() + 2 * n_matches(),
                              step_, moves_, shading_records_, shading_residuals_, J_);
}

// From the inputs uploaded. n_slices: work-groups of each kind, which wait for each other where there are several.
void PoseSystem::launch_choice(size_t n_slices, float least_moved_px) {
  const PoseWeights& weights = options_.weights;
  const SeenSkin& skin = seen_->skin;
  const bool has_contour = seen_->contour && frame_ && weights.silhouette > 0;
  const bool has_matches = seen_->matches && weights.match > 0, has_skin = skin.samples && weights.shading > 0;
  const PoseChoice choice{
      {has_contour ? n_vertices_ : 0, has_matches ? n_vertices_ : 0, has_skin ? int(skin.vertices->size()) : 0},
      {options_.max_contour_vertices, options_.max_matches, options_.max_shaded},
      skin.limb_area_px};
  choose_kernel_.launch(3 * n_slices * LC_POSE_CHOICE_GROUP, LC_POSE_CHOICE_GROUP, inputs_.places(), choice,
                        least_moved_px, moved_, has_contour ? *seen_->contour : links_,
                        has_matches ? *seen_->matches : rest_, has_skin ? *skin.samples : rest_,
                        has_skin ? *skin.vertices : links_, has_skin ? *skin.limbs : links_, inputs_on_device_,
                        choice_told_, choice_state_, ocl::LocalMemory{2 * sizeof(int64_t) * LC_POSE_CHOICE_GROUP},
                        ocl::LocalMemory{sizeof(double) * LC_SKIN_LIMBS});
}

void PoseSystem::read_choice() {
  if (!seen_) return;
  inputs_on_device_.write_later(inputs_.words_given());
  launch_choice(1);
  inputs_on_device_.read(inputs_.words_read());
  seen_.reset();
  inputs_changed_ = true;
}

// On GPUs.
void PoseSystem::launch_gauss_newton(size_t n_groups, const PoseStepsArg& steps) {
  gauss_newton_kernel_.launch(
      n_groups * LC_POSE_GROUP, LC_POSE_GROUP, layout_, pinhole_, contour_arg(), float(options_.keypoint_2d_huber_px),
      float(match_px_ * options_.match_huber_px), float(options_.shading_huber),
      float(std::sqrt(options_.weights.anatomic)), inputs_.places(), steps, inputs_on_device_, chain_, links_, moves_,
      limits_, rest_, rest_normals_, bones_, weights_, frame_ ? frame_->signed_distance : rest_, step_, kept_, J_,
      parts_, sums_, results_, groups_.state(), moved_, motions_, look_state_, choice_state_,
      ocl::LocalMemory{sizeof(float) * LC_POSE_ROWS_SIZE(layout_)},
      ocl::LocalMemory{sizeof(float) * LC_POSE_NEAR_SIZE(layout_)},
      ocl::LocalMemory{takes_steps_ ? sizeof(double) * LC_POSE_LOCAL(layout_) : sizeof(double)});
}

// Of the normal equations, on GPUs.
size_t PoseSystem::n_parts() const {
  const auto parts = [](int n_rows) { return round_up(n_rows, LC_POSE_GROUP_ROWS) / LC_POSE_GROUP_ROWS; };
  return parts(n_point_rows_) + parts(n_contour()) + parts(2 * n_matches()) + parts(n_shaded());
}

// On GPUs: rows, residuals and parts at the state that was uploaded.
void PoseSystem::launch_normal_equations(bool write_rows) {
  PoseStepsArg none{};
  none.most = -1;
  none.write_rows = write_rows;
  none.tells = true;
  none.least_moved_px = -INFINITY;
  launch_gauss_newton(n_parts(), none);
}

std::optional<PoseSteps> PoseSystem::take_steps(const PoseState& start, int n_steps, double settled_px) {
  if (!takes_steps_ || !groups_.work() || n_steps > LC_POSE_MOST_STEPS) return std::nullopt;
  upload(start);
  if (seen_) launch_choice(n_slices_);
  PoseStepsArg steps = steps_arg(n_steps, settled_px);
  launch_gauss_newton(groups_.n(), steps);
  read_results(seen_ ? most_rows_ : n_rows());
  if (groups_.gave_up("pose", told(LC_POSE_RESULT_GAVE_UP(layout_)) != 0)) return std::nullopt;
  return steps_read();
}

PoseStepsArg PoseSystem::steps_arg(int n_steps, double settled_px) {
  const uint32_t first_tag = std::exchange(tag_, tag_ + std::max(n_steps, 0));
  return {.most = n_steps,
          .tag = std::bit_cast<int32_t>(first_tag),
          .write_rows = 0,
          .settled_px = float(settled_px),
          .damping_own = float(options_.damping_own),
          .damping_largest = float(options_.damping_largest),
          .max_step_rad = float(options_.max_step_rad),
          .rank_threshold = float(kRankThreshold),
          .round = 0,
          .continues = 0,
          .least_moved_px = -INFINITY,
          .doubt_mm = 0,
          .rests = 0,
          .least_stands = float(options_.least_stands),
          .tells = 1};
}

void PoseSystem::set_round(int round, const KeypointTargets& targets, const SeenVertices& seen, const Floor* floor,
                           std::span<const double> stands, std::span<const float> soles_before) {
  require(chooses() && round < LC_POSE_MOST_ROUNDS, format("there is no round %d", round));
  inputs_.select_round(round);
  inputs_.set_targets(targets);
  inputs_.set_choice(seen);
  inputs_.set_floor(floor, stands);
  inputs_.set_soles_before(soles_before);
  rests_ = !soles_before.empty();
  inputs_.select_round(0);
}

void PoseSystem::begin_rounds(int n_rounds, const PoseState& start, const DeviceFrame* frame) {
  set_picture(frame);
  inputs_.set_start(state_values(start));
  inputs_on_device_.write_later(inputs_.words_given(n_rounds));
}

void PoseSystem::launch_round(const Round& round, const SeenVertices& seen) {
  seen_ = seen;
  inputs_.select_round(round.round);
  launch_choice(n_slices_, round.least_moved_px);
  PoseStepsArg steps = steps_arg(round.n_steps, round.settled_px);
  steps.round = round.round;
  steps.continues = round.round > 0;
  steps.least_moved_px = round.least_moved_px;
  steps.doubt_mm = float(round.doubt_3d_mm);
  steps.rests = rests_;
  steps.tells = round.tells;
  launch_gauss_newton(groups_.n(), steps);
  inputs_.select_round(0);
}

std::optional<PoseSystem::Rounds> PoseSystem::read_rounds() {
  read_results(most_rows_);
  if (groups_.gave_up("pose", told(LC_POSE_RESULT_GAVE_UP(layout_)) != 0)) return std::nullopt;
  Rounds rounds{told(LC_POSE_RESULT_ROUND(layout_)), steps_read(), results_host_[LC_POSE_RESULT_MOVED(layout_)], {}};
  for (int k = 0; k < kKeypointCount; ++k) {
    const double root = results_host_[LC_POSE_RESULT_ROOTS_3D(layout_) + k];
    rounds.weights_3d[k] = root * root;
  }
  return rounds;
}

int PoseSystem::told(int place) const {
  return std::bit_cast<int32_t>(results_host_[place]);
}

// Of the results read.
PoseSteps PoseSystem::steps_read() {
  if (seen_)
    std::copy_n(results_host_.begin() + LC_POSE_RESULT_COUNTS(layout_), LC_POSE_COUNTS, inputs_.counts_read().begin());
  PoseSteps taken;
  std::vector<double> state(LC_POSE_STATE_SIZE(layout_));
  std::memcpy(state.data(), results_host_.data(), state.size() * sizeof(double));
  taken.state = state_of(state);
  const auto energy = results_host_.begin() + LC_POSE_RESULT_ENERGY(layout_);
  taken.step_energy.assign(energy, energy + told(LC_POSE_RESULT_TAKEN(layout_)));
  switch (told(LC_POSE_RESULT_STATUS(layout_))) {
    case LC_POSE_SOLVED:
      taken.residuals = residuals_read();
      break;
    case LC_POSE_RANK_DEFICIENT:
      taken.status = SolveStatus::kRankDeficient;
      break;
    default:
      taken.status = SolveStatus::kNotFinite;
  }
  return taken;
}

// Blocking.
void PoseSystem::read_results(size_t n_rows) {
  results_host_.resize(LC_POSE_RESULT_RESIDUALS(layout_) + n_rows);
  results_.read(results_host_);
}

std::vector<float> PoseSystem::residuals_read() const {
  const auto rows = results_host_.begin() + LC_POSE_RESULT_RESIDUALS(layout_);
  return {rows, rows + n_rows()};
}

PoseNormalEquations PoseSystem::assemble(const PoseState& state) {
  upload(state);
  if (is_cpu_) {
    launch_records();
    launch_rows();
    gram_kernel_.launch(n_tiles_, 1, n_tiles_, n_rows(), layout_.n_columns, layout_.n_unknowns + 1, J_, gram_);
  } else {
    launch_normal_equations(false);
    const int n_entries = static_cast<int>(gram_.size());
    sum_parts_kernel_.launch(gram_.size(), 64, n_entries, static_cast<int>(n_parts()), parts_, gram_);
  }
  gram_.read(gram_host_);

  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(layout_.n_columns, layout_.n_columns);
  const float* tile = gram_host_.data();
  for (int a = 0; a < layout_.n_columns; a += kTile) {
    for (int b = a; b < layout_.n_columns; b += kTile, tile += kTile * kTile) {
      for (int i = 0; i < kTile; ++i)
        for (int j = 0; j < kTile; ++j) gram(a + i, b + j) = tile[i * kTile + j];
    }
  }
  const int n = layout_.n_unknowns;
  PoseNormalEquations equations;
  equations.JtJ = gram.topLeftCorner(n, n).selfadjointView<Eigen::Upper>();
  equations.JtF = gram.col(n).head(n);
  equations.energy = gram(n, n);
  return equations;
}

std::vector<float> PoseSystem::residuals(const PoseState& state) {
  upload(state);
  if (!is_cpu_) {
    launch_normal_equations(false);
    read_results(n_rows());
    return residuals_read();
  }
  std::vector<float> result(n_rows());
  launch_records();
  contour_residuals_.read_later(std::span(result).subspan(n_point_rows_, n_contour()));
  match_residuals_.read_later(std::span(result).subspan(n_point_rows_ + n_contour(), 2 * n_matches()));
  shading_residuals_.read_later(std::span(result).last(n_shaded()));
  point_residuals_.read(std::span(result).first(n_point_rows_));
  return result;
}

Eigen::MatrixXf PoseSystem::jacobian(const PoseState& state) {
  upload(state);
  if (is_cpu_) {
    launch_records();
    launch_rows();
  } else {
    launch_normal_equations(true);
  }
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> J(n_rows(), layout_.n_columns);
  J_.read(std::span(J.data(), J.size()));
  return J.leftCols(layout_.n_unknowns);
}

}  // namespace livecap
