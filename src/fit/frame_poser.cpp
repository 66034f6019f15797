#include "fit/frame_poser.h"

#include "pose/initialize.h"
#include "pose/person_height.h"

namespace livecap {

namespace {

constexpr double kBelievedShare = 0.06;  // mean keypoint error of a pose that is believed, of the person's height

}  // namespace

FramePoser::FramePoser(ocl::DeviceContext& device, const Actor& actor, const Camera& camera)
    : actor_(actor),
      camera_(camera),
      solver_(device, actor, camera, options_),
      skinner_(device, actor),
      rasterizer_(device, actor.mesh, camera.width, camera.height),
      visibility_(device, actor.mesh),
      frame_(device, camera.width, camera.height),
      mask_(device, static_cast<size_t>(camera.width) * camera.height),
      displacement_(device, actor.mesh.positions.size()),
      posed_(device, actor.mesh.positions.size()),
      normals_(device, actor.mesh.positions.size()) {
  displacement_.fill(0);
}

void FramePoser::render(const Skeleton& skeleton, const Pose& pose) {
  skinner_.set_pose(bone_dual_quats(forward_kinematics(skeleton, pose)));
  skinner_.skin(displacement_, posed_);
  rasterizer_.render(posed_, camera_);
}

void FramePoser::solve(FitFrame& frame) {
  frame.posed = false;
  const std::optional<Pose> initial = initialize_pose(actor_, camera_, frame.detections, options_);
  if (!initial) return;
  frame_.upload(frame.silhouette, frame.image);
  displacement_.fill(0);
  Pose pose = *initial;
  PoseResult result;
  for (int round = 0; round < 2; ++round) {  // the first outline is that of a rough pose
    render(actor_.skeleton, pose);
    visibility_.find_contour(rasterizer_);
    const std::vector<int32_t> contour = visibility_.read_contour();
    result = solver_.solve(PoseInput{.detections = frame.detections,
                                     .initial = pose,
                                     .frame = &frame_,
                                     .contour_vertices = contour,
                                     .n_steps = options_.first_steps});
    if (result.status != SolveStatus::kOk) return;
    pose = result.pose;
  }
  frame.pose = pose;
  frame.posed = result.keypoint_error_px < kBelievedShare * keypoints_height_px(frame.detections);
}

double FramePoser::overlap(const FitFrame& frame) {
  displacement_.fill(0);
  render(actor_.skeleton, frame.pose);
  mask_.write(frame.mask.pixels);
  return rasterizer_.intersection_over_union(mask_);
}

std::vector<int32_t> FramePoser::outline(const Skeleton& skeleton, const Pose& pose,
                                         const std::vector<float>& displacement_mm) {
  displacement_.write(displacement_mm);
  render(skeleton, pose);
  visibility_.find_contour(rasterizer_);
  return visibility_.read_contour();
}

ViewCoverage FramePoser::cover(const FitFrame& frame) {
  displacement_.fill(0);
  render(actor_.skeleton, frame.pose);
  skinner_.normals(posed_, normals_);
  visibility_.find_visible(posed_, normals_, rasterizer_);
  return coverage_of(camera_, visibility_.visible().read_all(), posed_.read_all(), normals_.read_all());
}

}  // namespace livecap
