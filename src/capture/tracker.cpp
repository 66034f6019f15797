#include "capture/tracker.h"

#include <algorithm>
#include <cmath>

#include "base/log.h"
#include "base/timer.h"
#include "capture/expected_detections.h"
#include "livecap/error.h"

namespace livecap {
namespace {

// Of keypoints that nobody saw: they only lead where the silhouette says nothing.
constexpr float kExpectedConfidence = 0.3f;

}  // namespace

Tracker::Tracker(ocl::DeviceContext& device, ocl::DeviceContext& surface_device, const Actor& actor,
                 const Camera& camera, const TrackerOptions& options)
    : actor_(actor),
      camera_(camera),
      options_((options.validate(), options)),
      rasterizer_(device, actor.mesh, camera.width, camera.height),
      visibility_(device, actor.mesh, options.visibility),
      pose_stage_(device, actor, camera, options, rasterizer_, visibility_),
      frame_(device, camera.width, camera.height),
      surface_rasterizer_(surface_device, actor.mesh, camera.width, camera.height),
      surface_visibility_(surface_device, actor.mesh, options.visibility),
      surface_stage_(surface_device, actor, camera, options, surface_rasterizer_, surface_visibility_) {}

void Tracker::reset() {
  lose_person();
  pose_stage_.reset();
}

void Tracker::lose_person() {
  last_pose_.reset();
  pose_before_last_.reset();
  pose_stage_.lose_person();
  doubtful_frames_ = 0;
  missed_frames_ = 0;
}

// The last pose moved on as it moved before. After a gap not further than that: a speed that is multiplied leads away
// more often than near.
Pose Tracker::predict() const {
  return predict_pose(actor_.skeleton, pose_before_last_ ? &*pose_before_last_ : nullptr, *last_pose_, options_.pose);
}

Tracker::Solved Tracker::solve_seen(const PoseStageInput& input) {
  Solved solved;
  if (!options_.solve_pose) {
    const std::optional<Pose> found = initialize_pose(actor_, camera_, input.detections, options_.pose);
    solved.accepted = found.has_value();
    solved.initialized = !last_pose_;
    if (found) solved.pose.pose = *found;
    return solved;
  }
  if (last_pose_) {
    solved.pose = pose_stage_.solve_tracked(input, predict(), *last_pose_);
    const bool believed = pose_stage_.believable(solved.pose, input.detections);
    if (missed_frames_ > 0) {
      solved.accepted = believed;
      return solved;
    }
    doubtful_frames_ = believed ? 0 : doubtful_frames_ + 1;
    solved.accepted = solved.pose.status == SolveStatus::kOk && doubtful_frames_ <= options_.max_doubtful_frames;
    if (solved.accepted) return solved;
    lose_person();
  }
  solved.initialized = true;
  solved.pose = pose_stage_.find(input);
  solved.accepted = pose_stage_.believable(solved.pose, input.detections) &&
                    (input.silhouette.empty() || covers(input, solved.pose.pose, options_.least_found_iou));
  return solved;
}

bool Tracker::covers(const PoseStageInput& input, const Pose& pose, double least_iou) {
  pose_stage_.render(pose);
  return rasterizer_.intersection_over_union(input.frame.mask) >= least_iou;
}

// A frame in which the network sees nobody: the silhouette, near where the motion would have led.
Tracker::Solved Tracker::solve_missed(const PoseStageInput& input) {
  Solved solved;
  if (!last_pose_ || input.silhouette.empty()) {
    pose_stage_.miss_frame();
    return solved;
  }
  const Pose predicted = predict();
  const Detections expected = expected_detections(actor_, camera_, predicted, kExpectedConfidence);
  solved.pose = pose_stage_.solve_tracked({expected, input.silhouette, input.frame, false}, predicted, *last_pose_);
  if (solved.pose.status != SolveStatus::kOk) return solved;
  solved.accepted = covers(input, solved.pose.pose, options_.least_missed_iou);
  return solved;
}

const DeviceFrame& Tracker::frame_of(const TrackInput& given) const {
  return given.frame ? *given.frame : frame_;
}

TrackResult Tracker::solve_pose(const TrackInput& given) {
  Detections certain;
  if (options_.ignore_confidence) {
    certain = given.detections;
    for (KeypointDetection& keypoint : certain.keypoints) keypoint.confidence = keypoint.confidence > 0 ? 1 : 0;
  }
  const Silhouette& silhouette = given.silhouette;
  const PoseStageInput input{options_.ignore_confidence ? certain : given.detections, silhouette, frame_of(given)};
  TrackResult result;
  const bool person = input.detections.person && !given.nobody;
  if (!given.frame && (person || !silhouette.empty()) &&
      given.mask.pixels.size() != size_t(camera_.width) * camera_.height)
    throw LogicError("capture: the mask is not of the camera's size");
  if (!person && last_pose_ && ++missed_frames_ > options_.max_missed_frames) lose_person();
  Timer timer;
  if (!given.frame && !silhouette.empty()) {
    frame_.upload(silhouette, given.image);
    frame_.mask.write(given.mask.pixels);
  }
  pose_stage_.set_picture(input);
  const Solved solved = person ? solve_seen(input) : solve_missed(input);
  result.pose_ms = timer.elapsed_ms();
  result.pose_energy = solved.pose.energy.total();
  if (person) result.keypoint_error_px = solved.pose.keypoint_error_px;
  if (!solved.accepted) {
    const bool missed = !person || missed_frames_ > 0;
    if (!missed) result.status = TrackStatus::kLost;
    if (!missed || (person && ++missed_frames_ > options_.max_missed_frames)) lose_person();
    return result;
  }
  result.status = solved.initialized ? TrackStatus::kInitialized : TrackStatus::kOk;
  result.pose = solved.pose.pose;
  result.light = pose_stage_.light();
  result.up = pose_stage_.up();
  const bool follows = last_pose_ && missed_frames_ == 0;
  pose_before_last_ = last_pose_;
  last_pose_ = result.pose;
  if (person) missed_frames_ = 0;
  if (person && doubtful_frames_ == 0) pose_stage_.learn(input, follows ? &*pose_before_last_ : nullptr, *last_pose_);
  result.pose_ms = timer.elapsed_ms();
  return result;
}

void Tracker::solve_surface(const TrackInput& given, TrackResult& result) {
  if (!is_tracked(result.status)) return;
  Timer timer;
  const DeviceFrame* picture = given.silhouette.empty() ? nullptr : &frame_of(given);
  if (options_.enable_surface) {
    if (result.status == TrackStatus::kInitialized) surface_stage_.reset();
    result.surface_energy =
        surface_stage_.solve(result.pose, given.time_s, picture, given.silhouette.box, result.light, result.up);
  } else {
    surface_stage_.skin_template(result.pose);
  }
  const ocl::Buffer<float>& vertices = surface_stage_.vertices();
  result.vertices_mm.resize(vertices.size());
  vertices.read(result.vertices_mm);
  result.surface_ms = timer.elapsed_ms();
  if (!picture) return;
  surface_rasterizer_.render_depth(vertices, camera_);
  result.iou = surface_rasterizer_.intersection_over_union(picture->mask);
}

TrackResult Tracker::track(const TrackInput& given) {
  TrackResult result = solve_pose(given);
  solve_surface(given, result);
  return result;
}

}  // namespace livecap
