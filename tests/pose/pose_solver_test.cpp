#include "pose/pose_solver.h"

#include <gtest/gtest.h>

#include <random>

#include "base/timer.h"
#include "support/pose_scene.h"
#include "support/test_device.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using test::exact_detections;

TEST(PoseSolver, RecoversRandomPosesFromTheirDetectionsAlone) {
  test::on_every_device([](ocl::DeviceContext& device) {
    for (double arms_down : {0.0, 0.7}) {
      const Actor actor = test::make_test_actor(arms_down);
      const Camera camera = test::portrait_camera();
      PoseOptions options;
      options.rebone = false;
      PoseSolver solver(device, actor, camera, options);
      std::mt19937 rng(5);
      for (int trial = 0; trial < 30; ++trial) {
        const Pose truth = test::random_true_pose(actor, rng, 0.9);
        const Detections detections = exact_detections(actor, camera, truth);
        const std::optional<Pose> start = initialize_pose(actor, camera, detections, options);
        ASSERT_TRUE(start.has_value());
        const PoseResult result =
            solver.solve({.detections = detections, .initial = *start, .n_steps = options.first_steps});
        EXPECT_EQ(result.status, SolveStatus::kOk);
        printf("trial %d start %.1f end %.3f e2d %.4f energy %g\n", trial,
               test::keypoint_distance_mm(actor, *start, truth), test::keypoint_distance_mm(actor, result.pose, truth),
               result.keypoint_error_px, result.energy.total());
      }
    }
  });
}

}  // namespace
}  // namespace livecap
