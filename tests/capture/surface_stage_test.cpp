// What stage II starts from.
#include "capture/surface_stage.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "cloth/hanging_cloth.h"
#include "image/silhouette.h"
#include "support/builtin_actor.h"
#include "support/gpu_bodies.h"
#include "support/pose_scene.h"
#include "support/test_device.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

constexpr double kFrame = 1 / 30.0;
constexpr float kAsideMm = 60;
constexpr float kPoseBesideMm = 20;
constexpr float kAstrayMm = 100;
constexpr float kDistanceMm = 3200;  // of test::standing_pose; the front of the skirt is nearer

// loose: as if all of the skirt lay in folds.
TrackerOptions stage_options(bool simulate, bool loose) {
  TrackerOptions options;
  options.simulate_cloth = simulate;
  if (loose) options.hanging.taut = 0, options.hanging.loose = 0.005f;
  return options;
}

// The built-in skirt. Without a picture the surface is what the pose and the simulation make of it.
class Scene {
 public:
  Scene(ocl::DeviceContext& device, const TrackerOptions& options)
      : device_(device),
        rasterizer_(device, actor_.mesh, camera_.width, camera_.height),
        visibility_(device, actor_.mesh, {}),
        stage_(device, actor_, camera_, options, rasterizer_, visibility_) {}
  Scene(ocl::DeviceContext& device, bool simulate, bool loose = false)
      : Scene(device, stage_options(simulate, loose)) {}

  std::vector<float> at(float x_mm, double time_s, double lifted_rad = 0) {
    Pose pose = test::standing_pose(actor_, 0.5);
    pose.root_translation_mm.x() += x_mm;
    for (int k = 0; k < actor_.skeleton.n_dofs(); ++k)
      if (actor_.skeleton.dofs[k].name == "left_hip_x") pose.angles_rad[k] = -lifted_rad;
    stage_.solve(pose, time_s, nullptr, {}, {1}, up);
    return stage_.vertices().read_all();
  }
  void reset() { stage_.reset(); }

  Eigen::Vector3d up = -Eigen::Vector3d::UnitY();

  // From a pose so far beside that of the picture, in which the actor is as skinning has it.
  std::vector<float> found_from(float beside_mm, const Light& light = {1}) {
    Pose pose = test::standing_pose(actor_, 0.5);
    stage_.skin_template(pose);
    rasterizer_.render(stage_.vertices(), camera_);
    const ImageRgb picture = textured();
    ImageGray mask{camera_.width, camera_.height, {}};
    for (int32_t t : rasterizer_.triangle_ids().read_all()) mask.pixels.push_back(t >= 0 ? 255 : 0);
    const Silhouette silhouette = make_silhouette(mask);
    DeviceFrame frame(device_, camera_.width, camera_.height);
    frame.upload(silhouette, picture);
    pose.root_translation_mm.x() += beside_mm;
    stage_.solve(pose, 0, &frame, bounding_box(mask), light, up);
    return stage_.vertices().read_all();
  }

 private:
  // What was rendered last with its texture, one texel a pixel.
  ImageRgb textured() const {
    const std::vector<int32_t> ids = rasterizer_.triangle_ids().read_all();
    const std::vector<float> projected = rasterizer_.projected().read_all();
    const ImageRgb& texture = actor_.texture;
    ImageRgb picture{camera_.width, camera_.height, std::vector<uint8_t>(3 * ids.size(), 128)};
    for (size_t p = 0; p < ids.size(); ++p) {
      if (ids[p] < 0) continue;
      Eigen::Matrix3d corners;  // u / z, v / z and 1 / z of each are linear in the picture
      Eigen::Matrix<double, 2, 3> uv;
      for (int k = 0; k < 3; ++k) {
        const size_t corner = size_t(3) * ids[p] + k;
        const float* at = &projected[size_t(4) * actor_.mesh.triangles[corner]];
        corners.col(k) = Eigen::Vector3d(at[0], at[1], 1) / at[2];
        for (int a = 0; a < 2; ++a) uv(a, k) = actor_.render.uvs[size_t(2) * actor_.render.triangles[corner] + a];
      }
      const Eigen::Vector3d pixel(double(p % camera_.width), double(p / camera_.width), 1);
      Eigen::Vector3d shares = corners.partialPivLu().solve(pixel);
      const Eigen::Vector2d place = uv * (shares / shares.sum());
      const int x = std::clamp(int(place.x() * texture.width), 0, texture.width - 1);
      const int y = std::clamp(int(place.y() * texture.height), 0, texture.height - 1);
      std::copy_n(&texture.pixels[3 * (size_t(y) * texture.width + x)], 3, &picture.pixels[3 * p]);
    }
    return picture;
  }

  ocl::DeviceContext& device_;
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
    // Two seconds later it hangs as one that never was elsewhere; a new person's skirt never was.
    Scene stayed(device, true);
    std::vector<float> later, always_there;
    for (int frame = 2; frame < 60; ++frame) {
      later = simulated.at(kAsideMm, frame * kFrame);
      always_there = stayed.at(kAsideMm, frame * kFrame);
    }
    EXPECT_LT(furthest_behind(later, always_there), kAsideMm / 8);
    simulated.reset();
    EXPECT_EQ(simulated.at(2 * kAsideMm, 3), Scene(device, true).at(2 * kAsideMm, 3));
  });
}

// A lifted thigh takes a skirt less far along than the actor's weights do.
TEST(SurfaceStage, ASkirtHangsFromTheHips) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const Actor& actor = test::builtin_actor("skirt");
    for (const bool simulate : {false, true}) {
      TrackerOptions as_painted = stage_options(simulate, false);
      as_painted.hanging.carried_power = 1;
      Scene hanging(device, simulate), carried(device, as_painted);
      const std::vector<float> rest = hanging.at(0, 0), carried_rest = carried.at(0, 0);
      std::vector<float> hung, along;
      for (int frame = 1; frame < 30; ++frame) {
        hung = hanging.at(0, frame * kFrame, 0.6);
        along = carried.at(0, frame * kFrame, 0.6);
      }
      double moved_hung = 0, moved_along = 0, elsewhere = 0;
      for (int k = 0; k < 3 * actor.n_vertices(); ++k) {
        if (hangs(actor, k / 3)) {
          moved_hung += std::abs(hung[k] - rest[k]);
          moved_along += std::abs(along[k] - carried_rest[k]);
        } else {
          elsewhere = std::max<double>(elsewhere, std::abs(hung[k] - along[k]));
        }
      }
      EXPECT_LT(moved_hung, 0.85 * moved_along) << simulate;
      EXPECT_GT(moved_hung, 0.1 * moved_along) << simulate;
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
    EXPECT_GT(fast, usual + 4);
    EXPECT_GT(usual, slow + 5);
    EXPECT_EQ(behind_after(-1), usual) << "where time does not rise it is a 30th of a second";
    EXPECT_EQ(behind_after(1e-6), behind_after(1 / 240.0)) << "time stamps of bunched frames hardly differ";
    Scene after_a_gap(device, true);
    after_a_gap.at(0, 5);
    EXPECT_EQ(after_a_gap.at(kAsideMm, 6), Scene(device, true).at(kAsideMm, 6)) << "it begins anew";
  });
}

// Before a camera that looks down by 0.2 rad, or leans, things do not fall down the picture.
TEST(SurfaceStage, ASkirtHangsTheWayThingsFall) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const auto hem_after = [&](const Eigen::Vector3d& up) {
      const Actor& actor = test::builtin_actor("skirt");
      Scene scene(device, true, true);
      scene.up = up;
      std::vector<float> out;
      for (int frame = 0; frame < 30; ++frame) out = scene.at(0, frame * kFrame);
      Eigen::Vector3d sum = Eigen::Vector3d::Zero();
      int n = 0;
      for (int i = 0; i < actor.n_vertices(); ++i)
        if (hangs(actor, i)) sum += Eigen::Vector3d(out[3 * i], out[3 * i + 1], out[3 * i + 2]), ++n;
      return Eigen::Vector3d(sum / n);
    };
    const Eigen::Vector3d level = hem_after(-Eigen::Vector3d::UnitY());
    // The ground is further away below: what hangs swings away from a camera that looks down.
    EXPECT_GT(hem_after(Eigen::Vector3d(0, -1, -0.2).normalized()).z(), level.z() + 10);
    EXPECT_LT(hem_after(Eigen::Vector3d(0.2, -1, 0).normalized()).x(), level.x() - 10);
  });
}

// Of a pose 20 mm beside the picture's, whose body stays there: how far what hangs behind or before the body's middle
// is beside its place in the picture, mm.
Eigen::ArrayXd beside_mm(ocl::DeviceContext& device, const TrackerOptions& options, bool behind) {
  const Actor& actor = test::builtin_actor("skirt");
  Scene scene(device, options);
  const std::vector<float> truth = scene.found_from(0), found = scene.found_from(kPoseBesideMm);
  std::vector<double> beside;
  for (int i = 0; i < actor.n_vertices(); ++i)
    if (hangs(actor, i) && (truth[3 * i + 2] > kDistanceMm) == behind) beside.push_back(found[3 * i] - truth[3 * i]);
  return Eigen::Map<const Eigen::ArrayXd>(beside.data(), Eigen::Index(beside.size()));
}

// What hangs is found again, nearer with each look.
TEST(SurfaceStage, WhatHangsIsMatchedAtEachLevel) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const auto away_mm = [&](std::vector<int> levels) {
      TrackerOptions options = stage_options(false, false);
      options.anew_share = 0;
      options.cloth_match_levels = std::move(levels);
      return beside_mm(device, options, false).abs().mean();
    };
    const double unmatched = away_mm({}), once = away_mm({2}), twice = away_mm({2, 1});
    EXPECT_LT(once, 0.85 * unmatched);
    EXPECT_LT(twice, 0.85 * once);
    EXPECT_LT(twice, 0.95 * away_mm({2, 2})) << "each look at its own level";
    EXPECT_LT(away_mm({2, 1, 0}), twice + 0.2) << "as many levels as there are steps";
  });
}

// The picture is not lit: drawn so, cloth is found, drawn in another light less of it.
TEST(SurfaceStage, WhatHangsIsDrawnInTheLightThatIsGiven) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const TrackerOptions options = stage_options(false, false);
    const std::vector<float> plain = Scene(device, options).found_from(kPoseBesideMm);
    EXPECT_EQ(plain, Scene(device, options).found_from(kPoseBesideMm, Light{1}));
    EXPECT_NE(plain, Scene(device, options).found_from(kPoseBesideMm, Light{0.7f, 0.6f, 0.6f}));
  });
}

// What the camera does not see goes some of the way with what it sees before it.
TEST(SurfaceStage, WhatHangsBehindMovesAsThatBeforeIt) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const auto moved_mm = [&](float share) {
      TrackerOptions options = stage_options(false, false);
      options.behind_share = share;
      return kPoseBesideMm - beside_mm(device, options, true).mean();
    };
    const double without = moved_mm(0), with = moved_mm(0.005f), more = moved_mm(0.1f);
    EXPECT_GT(with, without + 1) << without;
    EXPECT_GT(more, with + 1);
    EXPECT_LT(more, kPoseBesideMm);
  });
}

// In the second frame, of what was found in the first.
TEST(SurfaceStage, WornTautAndLooseClothesKeepTheirDisplacementsEachInItsWay) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const auto found = [&](bool loose, float worn, float taut_share, float loose_share) {
      TrackerOptions options = stage_options(false, loose);
      options.worn_carried_share = worn;
      options.taut_carried_share = taut_share;
      options.loose_carried_share = loose_share;
      Scene scene(device, options);
      scene.found_from(kAsideMm / 4);
      return scene.found_from(kAsideMm / 4);
    };
    EXPECT_NE(found(false, 0.5f, 0.1f, 0.5f), found(false, 0.5f, 0.9f, 0.5f));
    EXPECT_EQ(found(false, 0.5f, 0.5f, 0.1f), found(false, 0.5f, 0.5f, 0.9f));
    EXPECT_NE(found(true, 0.5f, 0.5f, 0.1f), found(true, 0.5f, 0.5f, 0.9f));

    // What lies on the body: the less is kept, the nearer it is to where the pose alone has it.
    const Actor& actor = test::builtin_actor("skirt");
    const std::vector<float> posed = Scene(device, false).at(kAsideMm / 4, 0);
    const auto away_mm = [&](float worn) {
      const std::vector<float> got = found(false, worn, 0.5f, 0.5f);
      double sum = 0;
      int n = 0;
      for (int i = 0; i < actor.n_vertices(); ++i) {
        if (hangs(actor, i) || actor.rigidity[i] > TrackerOptions{}.max_carried_rigidity) continue;
        for (int a = 0; a < 3; ++a) sum += std::abs(got[3 * i + a] - posed[3 * i + a]);
        ++n;
      }
      return sum / n;
    };
    EXPECT_LT(away_mm(0.1f), 0.9 * away_mm(0.9f));
  });
}

// A start far beside leaves cloth at other stripes, and what it carries on holds it there, unless it is matched from
// its simulation as well.
TEST(SurfaceStage, ClothThatWentAstrayComesBack) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const Actor& actor = test::builtin_actor("skirt");
    const auto astray_mm = [&](float anew_share) {
      TrackerOptions options = stage_options(false, false);
      options.anew_share = anew_share;
      const std::vector<float> truth = Scene(device, options).found_from(0);
      Scene scene(device, options);
      for (float beside : {kAstrayMm, 0.0f, 0.0f}) scene.found_from(beside);
      const std::vector<float> found = scene.found_from(0);
      double sum = 0;
      int n = 0;
      for (int i = 0; i < actor.n_vertices(); ++i)
        if (hangs(actor, i) && truth[3 * i + 2] < kDistanceMm) sum += std::abs(found[3 * i] - truth[3 * i]), ++n;
      return sum / n;
    };
    EXPECT_LT(astray_mm(0.9f), 0.75 * astray_mm(0));

    // Who is first seen carries nothing on.
    TrackerOptions once = stage_options(true, false), twice = once;
    once.anew_share = 0;
    Scene one(device, once), two(device, twice);
    for (int k = 0; k < 2; ++k) {
      EXPECT_EQ(one.found_from(kPoseBesideMm), two.found_from(kPoseBesideMm));
      EXPECT_NE(one.found_from(0), two.found_from(0));
      one.reset(), two.reset();
    }
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
