#include "capture/tracker.h"

#include <algorithm>
#include <cmath>

#include "base/log.h"
#include "base/timer.h"
#include "capture/expected_detections.h"
#include "livecap/error.h"
#include "pose/person_height.h"

namespace livecap {
namespace {

// Of keypoints that nobody saw: they only lead where the silhouette says nothing.
constexpr float kExpectedConfidence = 0.3f;

}  // namespace

Tracker::Tracker(ocl::DeviceContext& device, const Actor& actor, const Camera& camera, const TrackerOptions& options)
    : actor_(actor),
      camera_(camera),
      options_(options),
      n_vertices_(actor.n_vertices()),
      skinner_(device, actor),
      hanging_(actor, options.hanging),
      surface_skinner_(device, actor, hanging_.weights(), actor.skeleton.n_bones() + 1),
      rasterizer_(device, actor.mesh, camera.width, camera.height),
      visibility_(device, actor.mesh, options.visibility),
      part_mask_(device, actor.mesh, body_parts_of_vertices(actor.skeleton, actor.skin), camera.width, camera.height),
      pose_stage_(device, actor, camera, options, rasterizer_, visibility_),
      surface_solver_(device, actor, camera, options.surface),
      snapper_(device, actor, surface_solver_.domain(), options.snap),
      frame_(device, camera.width, camera.height) {
  const size_t size = size_t(3) * n_vertices_;
  for (ocl::Buffer<float>* buffer :
       {&displacement_rest_, &before_displacement_rest_, &zero_, &start_, &skinned_, &normals_, &vertices_, &before_}) {
    *buffer = ocl::Buffer<float>(device, size);
    buffer->fill(0);
  }
  std::vector<float> share(n_vertices_);
  for (int i = 0; i < n_vertices_; ++i)
    share[i] = actor.rigidity[i] <= options.max_carried_rigidity ? options.carried_share : 0.0f;
  carried_share_ = ocl::Buffer<float>(device, share);
}

void Tracker::reset() {
  last_pose_.reset();
  pose_before_last_.reset();
  n_history_ = 0;
  pose_stage_.reset();
  doubtful_frames_ = 0;
  missed_frames_ = 0;
  displacement_rest_.fill(0);
  before_displacement_rest_.fill(0);
}

bool Tracker::believable(const PoseResult& result, const Detections& detections) const {
  if (result.status != SolveStatus::kOk) return false;
  const double height = keypoints_height_px(detections);
  return height > 0 && result.keypoint_error_px < options_.lost_error_fraction * height;
}

// The last pose moved on as it moved before. After a gap not further than that: a speed that is multiplied leads away
// more often than near.
Pose Tracker::predict() const {
  return predict_pose(actor_.skeleton, pose_before_last_ ? &*pose_before_last_ : nullptr, *last_pose_, options_.pose);
}

Tracker::Solved Tracker::solve_pose(const PoseStageInput& input) {
  Solved solved;
  if (!options_.solve_pose) {
    const std::optional<Pose> found = initialize_pose(actor_, camera_, input.detections, options_.pose);
    solved.accepted = found.has_value();
    if (found) solved.pose.pose = *found;
    return solved;
  }
  if (last_pose_) {
    solved.pose = pose_stage_.solve_tracked(input, predict(), *last_pose_);
    const bool believed = believable(solved.pose, input.detections);
    if (missed_frames_ > 0) {
      solved.accepted = believed;
      return solved;
    }
    doubtful_frames_ = believed ? 0 : doubtful_frames_ + 1;
    solved.accepted = solved.pose.status == SolveStatus::kOk && doubtful_frames_ <= options_.max_doubtful_frames;
    if (solved.accepted) return solved;
    reset();
  }
  solved.initialized = true;
  solved.pose = pose_stage_.find(input);
  solved.accepted = believable(solved.pose, input.detections);
  return solved;
}

// A frame in which the network sees nobody: the silhouette, near where the motion would have led.
Tracker::Solved Tracker::solve_missed(const PoseStageInput& input) {
  Solved solved;
  if (!last_pose_ || input.silhouette.empty()) return solved;
  const Pose predicted = predict();
  const Detections expected = expected_detections(actor_, camera_, predicted, kExpectedConfidence);
  solved.pose = pose_stage_.solve_tracked({expected, input.silhouette, input.frame}, predicted, *last_pose_);
  if (solved.pose.status != SolveStatus::kOk) return solved;
  pose_stage_.render(solved.pose.pose);
  solved.accepted = rasterizer_.intersection_over_union(picture_->mask) >= options_.least_missed_iou;
  return solved;
}

void Tracker::solve_surface(const Pose& pose, bool has_picture, TrackResult& result) {
  Skinner& skinner = options_.enable_surface ? surface_skinner_ : skinner_;
  const PosedSkeleton posed = forward_kinematics(actor_.skeleton, pose);
  skinner.set_pose(options_.enable_surface ? hanging_.dual_quats(posed) : bone_dual_quats(posed));
  skinner.skin(zero_, skinned_);
  if (!options_.enable_surface || !has_picture) {
    vertices_.copy_from(skinned_);
    return;
  }
  skinner.skin(displacement_rest_, start_);
  if (n_history_ >= 2) skinner.skin(before_displacement_rest_, before_);
  skinner.normals(start_, normals_);
  rasterizer_.render(start_, camera_);
  visibility_.find_visible(start_, normals_, rasterizer_);
  visibility_.find_contour(rasterizer_);
  if (options_.part_mask) part_mask_.update(rasterizer_);
  const ocl::Buffer<uint8_t>* part_image = options_.part_mask ? &part_mask_.part_image() : nullptr;
  const ocl::Buffer<int32_t>* vertex_part = options_.part_mask ? &part_mask_.vertex_part() : nullptr;

  const SurfaceResult surface =
      surface_solver_.solve(SurfaceInput{.frame = *picture_,
                                         .skinned = skinned_,
                                         .start = start_,
                                         .previous = n_history_ >= 1 ? &start_ : nullptr,
                                         .before_previous = n_history_ >= 2 ? &before_ : nullptr,
                                         .visible = visibility_.visible(),
                                         .contour_flag = visibility_.contour(),
                                         .normals = normals_,
                                         .part_image = part_image,
                                         .vertex_part = vertex_part});
  result.surface_energy = surface.energies.total();
  vertices_.copy_from(*surface.vertices);
  if (options_.snapping) {
    skinner.normals(vertices_, normals_);
    rasterizer_.render(vertices_, camera_);
    visibility_.find_contour(rasterizer_);
    snapper_.snap(SnapInput{.frame = *picture_,
                            .contour_flag = visibility_.contour(),
                            .normals = normals_,
                            .part_image = part_image,
                            .vertex_part = vertex_part},
                  vertices_);
  }
  // The temporal terms compare displacements, not positions (docs/paper_map.md): `previous` is the warped start itself.
  if (options_.warp_displacements) {
    std::swap(before_displacement_rest_, displacement_rest_);
    skinner.unskin_displacement(vertices_, skinned_, carried_share_, displacement_rest_);
  }
  n_history_ = std::min(n_history_ + 1, 2);
}

TrackResult Tracker::track(const TrackInput& given) {
  Detections certain;
  if (options_.ignore_confidence) {
    certain = given.detections;
    for (KeypointDetection& keypoint : certain.keypoints) keypoint.confidence = keypoint.confidence > 0 ? 1 : 0;
  }
  const Silhouette& silhouette = given.silhouette;
  picture_ = given.frame ? given.frame : &frame_;
  const PoseStageInput input{options_.ignore_confidence ? certain : given.detections, silhouette, *picture_};
  TrackResult result;
  const bool person = input.detections.person;
  if (!given.frame && (person || !silhouette.empty()) &&
      given.mask.pixels.size() != size_t(camera_.width) * camera_.height)
    throw LogicError("capture: the mask is not of the camera's size");
  if (!person && last_pose_ && ++missed_frames_ > options_.max_missed_frames) reset();
  Timer timer;
  if (!given.frame && !silhouette.empty()) {
    frame_.upload(silhouette, given.image);
    frame_.mask.write(given.mask.pixels);
  }
  pose_stage_.set_picture(input);
  const Solved solved = person ? solve_pose(input) : solve_missed(input);
  result.pose_ms = timer.elapsed_ms();
  result.pose_energy = solved.pose.energy.total();
  if (person) result.keypoint_error_px = solved.pose.keypoint_error_px;
  if (!solved.accepted) {
    const bool missed = !person || missed_frames_ > 0;
    if (!missed) result.status = TrackStatus::kLost;
    if (!missed || (person && ++missed_frames_ > options_.max_missed_frames)) reset();
    return result;
  }
  result.status = solved.initialized ? TrackStatus::kInitialized : TrackStatus::kOk;
  result.pose = solved.pose.pose;

  timer.restart();
  solve_surface(result.pose, !silhouette.empty(), result);
  result.vertices_mm.resize(size_t(3) * n_vertices_);
  vertices_.read(result.vertices_mm);
  result.surface_ms = timer.elapsed_ms();

  rasterizer_.render(vertices_, camera_);
  if (!silhouette.empty()) result.iou = rasterizer_.intersection_over_union(picture_->mask);

  pose_before_last_ = last_pose_;
  last_pose_ = result.pose;
  if (person) missed_frames_ = 0;
  return result;
}

}  // namespace livecap
