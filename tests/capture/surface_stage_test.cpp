// What stage II starts from.
#include "capture/surface_stage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "cloth/hanging_cloth.h"
#include "support/builtin_actor.h"
#include "support/gpu_bodies.h"
#include "support/pose_scene.h"
#include "support/test_device.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

constexpr double kFrame = 1 / 30.0;
constexpr float kAsideMm = 60;

// The built-in skirt without a picture: the surface is what the pose and the simulation make of it.
class Scene {
 public:
  Scene(ocl::DeviceContext& device, bool simulate, bool loose = false)
      : rasterizer_(device, actor_.mesh, camera_.width, camera_.height),
        visibility_(device, actor_.mesh, {}),
        stage_(device, actor_, camera_, options(simulate, loose), rasterizer_, visibility_) {}

  std::vector<float> at(float x_mm, double time_s, double lifted_rad = 0) {
    Pose pose = test::standing_pose(actor_, 0.5);
    pose.root_translation_mm.x() += x_mm;
    for (int k = 0; k < actor_.skeleton.n_dofs(); ++k)
      if (actor_.skeleton.dofs[k].name == "left_hip_x") pose.angles_rad[k] = -lifted_rad;
    stage_.solve(pose, time_s, nullptr, {});
    return stage_.vertices().read_all();
  }
  void reset() { stage_.reset(); }

 private:
  // loose: as if all of the skirt lay in folds.
  static TrackerOptions options(bool simulate, bool loose) {
    TrackerOptions options;
    options.simulate_cloth = simulate;
    if (loose) options.hanging.taut = 0, options.hanging.loose = 0.005f;
    return options;
  }

  const Actor& actor_ = test::builtin_actor("skirt");
  Camera camera_ = test::portrait_camera();
  DepthRasterizer rasterizer_;
  SurfaceVisibility visibility_;
  SurfaceStage stage_;
};

float furthest_behind(const std::vector<float>& got, const std::vector<float>& skinned) {
  float most = 0;
  for (size_t k = 0; k < got.size(); k += 3) most = std::max(most, skinned[k] - got[k]);
  return most;
}

TEST(SurfaceStage, ASkirtStaysBehindWhoStepsAside) {
  test::on_every_device([](ocl::DeviceContext& device) {
    Scene simulated(device, true), skinned(device, false);
    simulated.at(0, 0);
    const std::vector<float> here = skinned.at(kAsideMm, 0);
    const std::vector<float> behind = simulated.at(kAsideMm, kFrame);
    EXPECT_GT(furthest_behind(behind, here), kAsideMm / 4);
    // All but cloth is where it was put.
    const Actor& actor = test::builtin_actor("skirt");
    for (int i = 0; i < actor.n_vertices(); ++i)
      if (!hangs(actor, i)) EXPECT_EQ(behind[3 * i], here[3 * i]) << i;
    // A second later it has swung out; a new person's skirt never was elsewhere.
    std::vector<float> later;
    for (int frame = 2; frame < 60; ++frame) later = simulated.at(kAsideMm, frame * kFrame);
    EXPECT_LT(furthest_behind(later, here), kAsideMm / 8);
    simulated.reset();
    EXPECT_LT(furthest_behind(simulated.at(2 * kAsideMm, 3), skinned.at(2 * kAsideMm, 3)), kAsideMm / 8);
  });
}

// A lifted thigh takes a skirt in folds less far along, and where it would swing to is there too.
TEST(SurfaceStage, ASkirtInFoldsIsNotPulled) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const Actor& actor = test::builtin_actor("skirt");
    for (const bool simulate : {false, true}) {
      Scene taut(device, simulate), loose(device, simulate, true);
      const std::vector<float> rest = taut.at(0, 0), loose_rest = loose.at(0, 0);
      std::vector<float> pulled, opened;
      for (int frame = 1; frame < 30; ++frame) {
        pulled = taut.at(0, frame * kFrame, 0.6);
        opened = loose.at(0, frame * kFrame, 0.6);
      }
      double moved_taut = 0, moved_loose = 0, elsewhere = 0;
      for (int k = 0; k < 3 * actor.n_vertices(); ++k) {
        if (hangs(actor, k / 3)) {
          moved_taut += std::abs(pulled[k] - rest[k]);
          moved_loose += std::abs(opened[k] - loose_rest[k]);
        } else {
          elsewhere = std::max<double>(elsewhere, std::abs(pulled[k] - opened[k]));
        }
      }
      EXPECT_LT(moved_loose, 0.8 * moved_taut) << simulate;
      EXPECT_GT(moved_loose, 0.1 * moved_taut) << simulate;
      EXPECT_EQ(elsewhere, 0) << simulate;
    }
  });
}

// Half as many pictures a second: the skirt has twice the time.
TEST(SurfaceStage, ASkirtSwingsByTheFramesTimes) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const auto behind_after = [&](double seconds) {
      Scene simulated(device, true), skinned(device, false);
      simulated.at(0, 5);
      return furthest_behind(simulated.at(kAsideMm, 5 + seconds), skinned.at(kAsideMm, 0));
    };
    const float fast = behind_after(1 / 60.0), usual = behind_after(kFrame), slow = behind_after(2 * kFrame);
    EXPECT_GT(fast, usual + 5);
    EXPECT_GT(usual, slow + 5);
    EXPECT_EQ(behind_after(-1), usual) << "where time does not rise it is a 30th of a second";
    EXPECT_EQ(behind_after(1e-6), behind_after(1 / 240.0)) << "time stamps of bunched frames hardly differ";
    EXPECT_LT(behind_after(1), kAsideMm / 8) << "after a gap it begins at rest";
  });
}

// There a CPU's work-groups of GPU kernels do not wait for each other: what the picture would tell too late.
TEST(SurfaceStage, WithoutPictureClothIsWholeWhereGroupsDoNotWait) {
  const auto places = [](int units) {
    std::vector<std::vector<float>> frames;
    test::on_every_gpu_body(
        [&](ocl::DeviceContext& device) {
          Scene scene(device, true);
          for (int frame = 0; frame < 3; ++frame) frames.push_back(scene.at(frame * kAsideMm, frame * kFrame));
        },
        units);
    EXPECT_FALSE(frames.empty());
    return frames;
  };
  EXPECT_EQ(places(3), places(1));
}

}  // namespace
}  // namespace livecap
