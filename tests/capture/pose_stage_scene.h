// A person before stage I as a camera and a perfect network see them.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/luminance.h"
#include "capture/pose_stage.h"
#include "support/builtin_actor.h"
#include "support/pose_scene.h"

namespace livecap::test {

// The built-in skirt in front of grey, in the colours of its vertices: what the camera and a perfect network see.
struct Seen {
  const Actor& actor = builtin_actor("skirt");
  Camera camera = portrait_camera();
  DepthRasterizer rasterizer;
  SurfaceVisibility visibility;
  DeviceFrame frame;
  float brightness = 1;  // of the light, in which colours at 1 look as they are

  explicit Seen(ocl::DeviceContext& device)
      : rasterizer(device, actor.mesh, camera.width, camera.height),
        visibility(device, actor.mesh, {}),
        frame(device, camera.width, camera.height) {}

  // Through a stage whose picture it becomes.
  Silhouette take_picture(PoseStage& stage, const Pose& pose) {
    stage.render(pose);
    const std::vector<int32_t> ids = rasterizer.triangle_ids().read_all();
    ImageRgb picture{camera.width, camera.height, std::vector<uint8_t>(3 * ids.size(), 128)};
    for (size_t at = 0; at < ids.size(); ++at) {
      if (ids[at] < 0) continue;
      float color[3] = {0, 0, 0};
      for (int corner = 0; corner < 3; ++corner)
        for (int k = 0; k < 3; ++k) color[k] += actor.colors[3 * actor.mesh.triangles[3 * ids[at] + corner] + k];
      // 0.04 of linear light is mirrored, whatever the colour.
      const double coded = (kRedLuminance * color[0] + kGreenLuminance * color[1] + kBlueLuminance * color[2]) / 3;
      const auto lit = float(1 + coded * coded / (coded * coded + 0.04) * (brightness - 1));
      for (int k = 0; k < 3; ++k) picture.pixels[3 * at + k] = uint8_t(255 * lit * color[k] / 3);
    }
    const ImageGray mask = rasterizer.read_mask();
    Silhouette silhouette = make_silhouette(mask);
    frame.upload(silhouette, picture);
    frame.mask.write(mask.pixels);
    return silhouette;
  }

  // A frame in which the person stands as in `truth`, seen for the first time.
  PoseResult find(PoseStage& stage, const Detections& detections, const Pose& truth) {
    const Silhouette silhouette = take_picture(stage, truth);
    const PoseStageInput input{detections, silhouette, frame};
    stage.set_picture(input);
    const PoseResult result = stage.find(input);
    EXPECT_EQ(result.status, SolveStatus::kOk);
    return result;
  }

  // The same, tracked from `before`.
  PoseResult track(PoseStage& stage, const Pose& before, const Pose& truth) {
    const Silhouette silhouette = take_picture(stage, truth);
    const Detections detections = exact_detections(actor, camera, truth);
    const PoseStageInput input{detections, silhouette, frame};
    stage.set_picture(input);
    const PoseResult result = stage.solve_tracked(input, before, before);
    EXPECT_EQ(result.status, SolveStatus::kOk);
    return result;
  }
};

inline Pose turned(const Actor& actor, int frame) {
  Pose pose = standing_pose(actor, 0.3 + 0.03 * frame);
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k)
    if (actor.skeleton.dofs[k].name == "left_hip_x") pose.angles_rad[k] = -0.1 * frame;
  return pose;
}

// The floor that somebody stands on, a little below the soles. (At some heights the last bits of a pose decide what
// a match is.)
inline FloorPlane under(const Actor& actor, const Pose& pose) {
  const PosedSkeleton posed = forward_kinematics(actor.skeleton, pose);
  double lowest = -INFINITY;
  for (const SolePoint& sole : sole_points(actor))
    lowest = std::max(lowest, (posed.camera_from_rest[sole.bone] * sole.rest_mm).y());
  return {{0, -1, 0}, lowest + 5};
}

}  // namespace livecap::test
