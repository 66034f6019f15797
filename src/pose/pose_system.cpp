#include "pose/pose_system.h"

#include <algorithm>
#include <cmath>

#include "base/round_up.h"
#include "base/text.h"
#include "geometry/mesh.h"
#include "livecap/error.h"
#include "ocl/lanes.h"

namespace livecap {
namespace {

constexpr const char* kProgram = "pose/pose.cl";
constexpr const char* kSkinnedProgram = "pose/skinned_records.cl";
constexpr const char* kGpuProgram = "pose/normal_equations.cl";
constexpr int kTile = 8;
// The bones of a contour row are packed into bytes.
constexpr int kMaxBones = LC_POSE_NO_BONE;

static_assert(LC_POSE_KEYPOINTS == kKeypointCount);
static_assert(sizeof(PoseLayout) == 20 && sizeof(PoseContour) == 24 && sizeof(PoseInputs) == 28);

void require(bool ok, const std::string& message) {
  if (!ok) throw LogicError("pose: " + message);
}

void check_actor(const Actor& actor) {
  actor.skeleton.validate();
  const size_t n = actor.n_vertices();
  require(actor.skeleton.n_bones() <= kMaxBones,
          format("actor has %d bones, at most %d", actor.skeleton.n_bones(), kMaxBones));
  require(actor.skin.bones.size() == 4 * n && actor.skin.weights.size() == 4 * n,
          format("skin has %zu bones and %zu weights for %zu vertices, 4 each needed", actor.skin.bones.size(),
                 actor.skin.weights.size(), n));
  for (int32_t bone : actor.skin.bones)
    require(bone >= 0 && bone < actor.skeleton.n_bones(), format("skin refers to bone %d", bone));
  for (const KeypointAnchor& anchor : actor.keypoints)
    require(anchor.bone < actor.skeleton.n_bones(), format("keypoint anchor refers to bone %d", anchor.bone));
}

}  // namespace

PoseSystem::PoseSystem(ocl::DeviceContext& device, const Actor& actor, const Camera& camera, const PoseOptions& options)
    : skeleton_(actor.skeleton),
      keypoints_(actor.keypoints),
      soles_(sole_points(actor)),
      options_(options),
      width_(camera.width),
      height_(camera.height),
      pinhole_(pinhole_arg(camera)),
      n_vertices_(actor.n_vertices()) {
  check_actor(actor);
  camera.validate();
  options.validate();
  require(width_ >= 2 && height_ >= 2, format("camera picture is %d x %d", width_, height_));
  layout_.n_dofs = skeleton_.n_dofs();
  layout_.n_unknowns = layout_.n_dofs + 9;
  layout_.n_columns = int(round_up(layout_.n_unknowns + 1, LC_POSE_SLICE));
  layout_.n_bones = skeleton_.n_bones();
  layout_.n_soles = int(soles_.size());
  n_point_rows_ = LC_POSE_POINT_ROWS + layout_.n_dofs + layout_.n_soles;
  const int side = layout_.n_columns / kTile;
  n_tiles_ = side * (side + 1) / 2;
  is_cpu_ = device.is_cpu();
  lanes_ = device.lanes();

  // Every column but t' and the residual's moves bones: the root's six all of them, a joint those below it.
  std::vector<float> moves(size_t(layout_.n_bones) * layout_.n_columns, 0.0f);
  const std::vector<uint64_t> masks = dofs_moving_bones(skeleton_);
  for (int b = 0; b < layout_.n_bones; ++b) {
    float* row = &moves[size_t(b) * layout_.n_columns];
    std::fill(row, row + 6, 1.0f);
    for (int k = 0; k < layout_.n_dofs; ++k) row[6 + k] = masks[b] >> k & 1 ? 1.0f : 0.0f;
  }
  std::vector<float> limits;
  for (const Dof& dof : skeleton_.dofs) {
    limits.push_back(float(dof.min_rad));
    limits.push_back(float(dof.max_rad));
  }
  std::vector<int32_t> point_bones;
  for (const KeypointAnchor& anchor : keypoints_) point_bones.push_back(std::max(anchor.bone, 0));
  for (const SolePoint& sole : soles_) point_bones.push_back(sole.bone);

  const size_t n_contour = round_up(options.max_contour_vertices, LC_POSE_SLICE);
  step_host_.resize(LC_POSE_STEP_SIZE(layout_));
  gram_host_.resize(size_t(n_tiles_) * kTile * kTile);
  step_ = ocl::Buffer<float>(device, step_host_.size());
  inputs_ = PoseRowInputs(layout_, options, n_vertices_);
  inputs_on_device_ = ocl::Buffer<float>(device, inputs_.most_words());
  point_bones_ = ocl::Buffer<int32_t>(device, point_bones);
  limits_ = ocl::Buffer<float>(device, limits);
  moves_ = ocl::Buffer<float>(device, moves);
  rest_ = ocl::Buffer<float>(device, actor.mesh.positions);
  rest_normals_ = ocl::Buffer<float>(device, vertex_normals(actor.mesh.positions, actor.mesh.triangles));
  bones_ = ocl::Buffer<int32_t>(device, actor.skin.bones);
  weights_ = ocl::Buffer<float>(device, actor.skin.weights);
  point_records_ = ocl::Buffer<float>(device, size_t(LC_POSE_RECORD) * n_point_rows_);
  contour_records_ = ocl::Buffer<float>(device, size_t(LC_POSE_RECORD) * n_contour);
  const size_t n_matches = round_up(options.max_matches, LC_POSE_SLICE);
  match_records_ = ocl::Buffer<float>(device, 2 * LC_POSE_RECORD * n_matches);
  const size_t n_shaded = round_up(options.max_shaded, LC_POSE_SLICE);
  shading_records_ = ocl::Buffer<float>(device, LC_POSE_RECORD * n_shaded);
  J_ = ocl::Buffer<float>(device, (n_point_rows_ + n_contour + 2 * n_matches + n_shaded) * layout_.n_columns);
  gram_ = ocl::Buffer<float>(device, gram_host_.size());
  if (!is_cpu_) {
    const auto groups = [](size_t n_rows) { return round_up(n_rows, LC_POSE_GROUP_ROWS) / LC_POSE_GROUP_ROWS; };
    parts_ = ocl::Buffer<float>(
        device, (groups(n_point_rows_) + groups(n_contour) + groups(2 * n_matches) + groups(n_shaded)) * gram_.size());
    residuals_ = ocl::Buffer<float>(device, n_point_rows_ + 2 * n_contour + 2 * n_matches + n_shaded);
    normal_equations_kernel_ = ocl::Kernel(device, kGpuProgram, "pose_normal_equations");
    sum_parts_kernel_ = ocl::Kernel(device, kGpuProgram, "pose_sum_parts");
    return;
  }
  point_residuals_ = ocl::Buffer<float>(device, n_point_rows_);
  contour_residuals_ = ocl::Buffer<float>(device, n_contour);
  distances_px_ = ocl::Buffer<float>(device, n_contour);
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
                           std::span<const int32_t> contour_vertices, const ocl::Buffer<float>* displacement_rest,
                           std::span<const VertexMatch> matches, std::span<const ShadedVertex> shaded) {
  inputs_.set_frame(targets, frame ? contour_vertices : std::span<const int32_t>{}, matches, shaded);
  inputs_changed_ = true;
  frame_ = frame;
  displacement_ = displacement_rest;
  if (n_contour() == 0) return;
  if (frame->width != width_ || frame->height != height_)
    throw LogicError(
        format("pose: frame is %d x %d, the camera %d x %d", frame->width, frame->height, width_, height_));
  if (displacement_rest && displacement_rest->size() != size_t(3) * n_vertices_)
    throw LogicError(
        format("pose: displacement has %zu values for %d vertices", displacement_rest->size(), n_vertices_));
}

void PoseSystem::set_floor(const Floor* floor, std::span<const double> stands) {
  inputs_.set_floor(floor, stands);
  inputs_changed_ = true;
}

void PoseSystem::upload(const PoseState& state) {
  // Everything relative to the root's origin; see kernels/pose/layout.h.
  Pose at_root = state.pose;
  at_root.root_translation_mm.setZero();
  const PosedSkeleton posed = forward_kinematics(skeleton_, at_root);
  const int columns = layout_.n_columns;
  float* out = step_host_.data();
  std::fill(out, out + 6 * columns, 0.0f);
  for (int i = 0; i < 3; ++i) {
    out[i * columns + i] = 1.0f;            // root rotation: axis e_i through the root's origin
    out[(3 + i) * columns + 3 + i] = 1.0f;  // root translation: a pure moment
  }
  for (int k = 0; k < layout_.n_dofs; ++k) {
    const Eigen::Vector3d moment = posed.dof_origin_mm[k].cross(posed.dof_axis[k]);
    for (int i = 0; i < 3; ++i) {
      out[i * columns + 6 + k] = float(posed.dof_axis[k][i]);
      out[(3 + i) * columns + 6 + k] = float(moment[i]);
    }
  }
  for (int k = 0; k < kKeypointCount; ++k) {
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    if (keypoints_[k].bone >= 0) p = posed.camera_from_rest[keypoints_[k].bone] * keypoints_[k].rest_position_mm;
    for (int i = 0; i < 3; ++i) out[LC_POSE_STEP_KEYPOINTS(layout_) + 3 * k + i] = float(p[i]);
  }
  for (int i = 0; i < 3; ++i) {
    out[LC_POSE_STEP_T_PRIME(layout_) + i] = float(state.t_prime_mm[i]);
    out[LC_POSE_STEP_ROOT(layout_) + i] = float(state.pose.root_translation_mm[i]);
  }
  for (int k = 0; k < layout_.n_dofs; ++k) out[LC_POSE_STEP_ANGLES(layout_) + k] = float(state.pose.angles_rad[k]);
  const std::vector<float> dual_quats = bone_dual_quats(posed);
  std::copy(dual_quats.begin(), dual_quats.end(), out + LC_POSE_STEP_DUAL_QUATS(layout_));
  for (size_t k = 0; k < soles_.size(); ++k) {
    const Eigen::Vector3d p = posed.camera_from_rest[soles_[k].bone] * soles_[k].rest_mm;
    for (int i = 0; i < 3; ++i) out[LC_POSE_STEP_SOLES(layout_) + 3 * k + i] = float(p[i]);
  }
  step_.write_later(step_host_);
  if (inputs_changed_) inputs_on_device_.write_later(inputs_.words());
  inputs_changed_ = false;
}

// On CPUs.
void PoseSystem::launch_records() {
  const auto lane_items = [this](int n) { return ocl::lane_items(n, lanes_); };
  point_records_kernel_.launch(kKeypointCount + layout_.n_dofs + layout_.n_soles, 0, layout_, pinhole_,
                               float(options_.keypoint_2d_huber_px), float(std::sqrt(options_.weights.anatomic)),
                               inputs_.places(), step_, inputs_on_device_, point_bones_, limits_, point_records_,
                               point_residuals_);
  if (n_matches() > 0)
    match_records_kernel_.launch(lane_items(n_matches()), 1, layout_, pinhole_, n_matches(),
                                 float(options_.match_huber_px), inputs_.places(), step_, inputs_on_device_, rest_,
                                 bones_, weights_, match_records_, match_residuals_);
  if (n_shaded() > 0)
    shading_records_kernel_.launch(lane_items(n_shaded()), 1, layout_, n_shaded(), float(options_.shading_huber),
                                   inputs_.places(), step_, inputs_on_device_, rest_normals_, bones_, weights_,
                                   shading_records_, shading_residuals_);
  if (n_contour() == 0) return;
  contour_records_kernel_.launch(lane_items(n_contour()), 1, layout_, pinhole_, contour_arg(), inputs_.places(), step_,
                                 inputs_on_device_, rest_, rest_normals_, displacement_ ? *displacement_ : rest_,
                                 bones_, weights_, frame_->signed_distance, contour_records_, contour_residuals_,
                                 distances_px_);
}

PoseContour PoseSystem::contour_arg() const {
  return {n_contour(),
          width_,
          height_,
          displacement_ ? 1 : 0,
          float(std::sqrt(contour_weight())),
          float(options_.silhouette_huber_px)};
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

// On GPUs: rows, residuals and the parts of the normal equations, whose number is returned.
size_t PoseSystem::launch_normal_equations(bool write_rows) {
  struct Counts {
    int32_t point_rows, matches, shaded, write_rows;
  };
  const auto groups = [](int n_rows) { return round_up(n_rows, LC_POSE_GROUP_ROWS) / LC_POSE_GROUP_ROWS; };
  const size_t n_groups = groups(n_point_rows_) + groups(n_contour()) + groups(2 * n_matches()) + groups(n_shaded());
  normal_equations_kernel_.launch(
      n_groups * LC_POSE_GROUP, LC_POSE_GROUP, layout_, pinhole_,
      Counts{n_point_rows_, n_matches(), n_shaded(), write_rows}, contour_arg(), float(options_.keypoint_2d_huber_px),
      float(options_.match_huber_px), float(options_.shading_huber), float(std::sqrt(options_.weights.anatomic)),
      inputs_.places(), step_, moves_, inputs_on_device_, point_bones_, limits_, rest_, rest_normals_,
      displacement_ ? *displacement_ : rest_, bones_, weights_, n_contour() > 0 ? frame_->signed_distance : rest_,
      point_records_, contour_records_, match_records_, shading_records_, residuals_, J_, parts_,
      ocl::LocalMemory{sizeof(float) * LC_POSE_GROUP_ROWS * layout_.n_columns});
  return n_groups;
}

PoseNormalEquations PoseSystem::assemble(const PoseState& state) {
  upload(state);
  if (is_cpu_) {
    launch_records();
    launch_rows();
    gram_kernel_.launch(n_tiles_, 1, n_tiles_, n_rows(), layout_.n_columns, J_, gram_);
  } else {
    const int n_parts = static_cast<int>(launch_normal_equations(false));
    const int n_entries = static_cast<int>(gram_.size());
    sum_parts_kernel_.launch(gram_.size(), 64, n_entries, n_parts, parts_, gram_);
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

PoseResiduals PoseSystem::residuals(const PoseState& state) {
  upload(state);
  PoseResiduals result;
  result.rows.resize(n_rows());
  result.distances_px.resize(n_contour());
  if (!is_cpu_) {
    launch_normal_equations(false);
    result.rows.resize(n_rows() + n_contour());
    residuals_.read(result.rows);
    std::copy(result.rows.begin() + n_rows(), result.rows.end(), result.distances_px.begin());
    result.rows.resize(n_rows());
    return result;
  }
  launch_records();
  contour_residuals_.read_later(std::span(result.rows).subspan(n_point_rows_, n_contour()));
  match_residuals_.read_later(std::span(result.rows).subspan(n_point_rows_ + n_contour(), 2 * n_matches()));
  shading_residuals_.read_later(std::span(result.rows).last(n_shaded()));
  distances_px_.read_later(result.distances_px);
  point_residuals_.read(std::span(result.rows).first(n_point_rows_));
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
