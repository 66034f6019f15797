// What stage I draws.
#include "capture/pose_stage.h"

#include <gtest/gtest.h>

#include "support/builtin_actor.h"
#include "support/pose_scene.h"
#include "support/test_device.h"

namespace livecap {
namespace {

// A skirt over a raised thigh hangs from the pelvis in stage I as in stage II.
TEST(PoseStage, HangingClothIsNotFastenedToTheLegs) {
  const Actor& actor = test::builtin_actor("skirt");
  const Camera camera = test::portrait_camera();
  Pose pose = test::standing_pose(actor, 0.5);
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k)
    if (actor.skeleton.dofs[k].name == "left_hip_x") pose.angles_rad[k] = -0.8;
  test::on_every_device([&](ocl::DeviceContext& device) {
    DepthRasterizer rasterizer(device, actor.mesh, camera.width, camera.height);
    SurfaceVisibility visibility(device, actor.mesh, {});
    const TrackerOptions options;
    PoseStage stage(device, actor, camera, options, rasterizer, visibility);
    stage.render(pose);
    const std::vector<float> drawn = rasterizer.depth().read_all();

    const auto drawn_with = [&](const SkinWeights& skin) {
      Skinner skinner(device, actor, skin, actor.skeleton.n_bones());
      ocl::Buffer<float> zero(device, size_t(3) * actor.n_vertices()), skinned(device, size_t(3) * actor.n_vertices());
      zero.fill(0);
      skinner.set_pose(bone_dual_quats(forward_kinematics(actor.skeleton, pose)));
      skinner.skin(zero, skinned);
      rasterizer.render(skinned, camera);
      return rasterizer.depth().read_all();
    };
    EXPECT_EQ(drawn, drawn_with(hanging_weights(actor, options.hanging)));
    EXPECT_NE(drawn, drawn_with(actor.skin));
  });
}

}  // namespace
}  // namespace livecap
