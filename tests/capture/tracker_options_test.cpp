// Every field at the ends of its range, and beyond.
#include "capture/tracker_options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "base/text.h"
#include "capture/tracker.h"
#include "livecap/error.h"
#include "match/layout.h"
#include "shared/exact_sum.h"
#include "support/builtin_actor.h"
#include "support/pose_scene.h"
#include "support/test_device.h"

namespace livecap {
namespace {

struct Field {
  std::string name;
  std::function<void(TrackerOptions&, double)> set;
  std::vector<double> right, wrong;
};

// For fields of any type of number.
#define LC_FIELD(field, ...)                                                                          \
  Field {                                                                                             \
#field, [](TrackerOptions & o, double value) { o.field = decltype(o.field)(value); }, __VA_ARGS__ \
  }

std::vector<Field> fields() {
  const double nan = std::nan(""), infinite = INFINITY, beyond = 1.01;
  const auto length = [&](Field field) {
    field.right = {0, 1000};
    field.wrong = {-0.01, nan, infinite};
    return field;
  };
  const auto share = [&](Field field) {
    field.right = {0, 1};
    field.wrong = {-0.01, beyond, nan};
    return field;
  };
  const auto count = [&](Field field) {
    field.right = {0, 1000};
    field.wrong = {-1};
    return field;
  };
  const auto factor = [&](Field field) {
    field.right = {0.01, 100};
    field.wrong = {0, 101, nan};
    return field;
  };
  const double most_share = LC_EXACT_MOST_SHARE;
  return {
      length(LC_FIELD(shares.min_matched_rigidity)),
      length(LC_FIELD(shares.max_matched_leg_weight)),
      share(LC_FIELD(shares.refined_hanging_share)),
      LC_FIELD(shares.foot_share, {1, most_share}, {0.9, most_share + 0.5, nan}),
      LC_FIELD(shares.rough_foot_share, {1, most_share}, {0.9, most_share + 0.5, nan}),
      {"rounds.match_levels",
       [](TrackerOptions& o, double value) {
         o.rounds.match_levels = {0, int(value)};
       },
       {0, LC_MATCH_LEVELS},
       {-1, LC_MATCH_LEVELS + 1}},
      {"cloth_match_levels",
       [](TrackerOptions& o, double value) {
         o.cloth_match_levels = {0, int(value)};
       },
       {0, LC_MATCH_LEVELS},
       {-1, LC_MATCH_LEVELS + 1}},
      count(LC_FIELD(rounds.refining_rounds)),
      length(LC_FIELD(rounds.settled_round_px)),
      length(LC_FIELD(rounds.settled_step_px)),
      length(LC_FIELD(rounds.settled_last_step_px)),
      LC_FIELD(rounds.matched_3d, {0.01, 1}, {0, beyond, nan}),
      share(LC_FIELD(rounds.refined_arms_3d)),
      length(LC_FIELD(rounds.refined_doubt_3d_mm)),
      share(LC_FIELD(rounds.on_feet_legs_3d)),
      share(LC_FIELD(rounds.free_legs_3d)),
      length(LC_FIELD(rounds.missed_px)),
      factor(LC_FIELD(guessed.keypoint_2d)),
      factor(LC_FIELD(guessed.silhouette)),
      factor(LC_FIELD(guessed.shading)),
      share(LC_FIELD(guessed.blur)),
      length(LC_FIELD(hidden_knees.least_cover_mm)),
      share(LC_FIELD(hidden_knees.keypoint_2d)),
      length(LC_FIELD(hidden_knees.refined_doubt_3d_mm)),
      share(LC_FIELD(hidden_knees.least_stands)),
      share(LC_FIELD(hidden_knees.balance_share)),
      {"starts.leans_rad",
       [](TrackerOptions& o, double value) {
         o.starts.leans_rad = {0.1, value};
       },
       {-1.5, 0, 1.5},
       {-1.6, 1.6, nan, infinite}},
      length(LC_FIELD(starts.least_turn_rad)),
      length(LC_FIELD(starts.least_twist_rad)),
      length(LC_FIELD(starts.least_found_twist_rad)),
      length(LC_FIELD(starts.cost_of_imbalance)),
      length(LC_FIELD(starts.strayed_share)),
      length(LC_FIELD(starts.strayed_arm_share)),
      length(LC_FIELD(starts.strayed_arm_depth_mm)),
      length(LC_FIELD(starts.on_edge_rad)),
      length(LC_FIELD(starts.cost_of_covering)),
      length(LC_FIELD(starts.least_mirrored_rad)),
      length(LC_FIELD(starts.mirrored_misfit)),
      count(LC_FIELD(starts.max_exchanged_frames)),
      count(LC_FIELD(starts.on_edge_frames)),
      LC_FIELD(starts.twisted_frames, {1, 1000}, {-1, 0}),
      length(LC_FIELD(max_carried_rigidity)),
      share(LC_FIELD(worn_carried_share)),
      share(LC_FIELD(taut_carried_share)),
      share(LC_FIELD(loose_carried_share)),
      share(LC_FIELD(behind_share)),
      share(LC_FIELD(anew_share)),
      length(LC_FIELD(lost_error_fraction)),
      count(LC_FIELD(max_doubtful_frames)),
      count(LC_FIELD(max_missed_frames)),
      share(LC_FIELD(least_missed_iou)),
      share(LC_FIELD(least_found_iou)),
  };
}

std::string refusal(const Field& field, double value) {
  TrackerOptions options;
  field.set(options, value);
  try {
    options.validate();
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "none";
}

TEST(TrackerOptions, EachFieldIsChecked) {
  EXPECT_NO_THROW(TrackerOptions().validate());
  for (const Field& field : fields()) {
    for (double value : field.right) EXPECT_EQ(refusal(field, value), "none") << field.name << " = " << value;
    for (double value : field.wrong) {
      const std::string begin = format("tracker option %s is %g; it must be ", field.name.c_str(), value);
      EXPECT_EQ(refusal(field, value).substr(0, begin.size()), begin);
    }
  }
}

TEST(TrackerOptions, AnActorWithoutRoundsIsAllowed) {
  TrackerOptions options;
  options.rounds.match_levels.clear();
  EXPECT_NO_THROW(options.validate());
  options.cloth_match_levels = {2, 1, 1, 0};  // more than there are steps
  EXPECT_THROW(options.validate(), ConfigError);
}

TEST(TrackerOptions, ADrapeThatMakesNoSenseIsRefused) {
  TrackerOptions options;
  options.drape.memory_s = 0;
  EXPECT_THROW(options.validate(), ConfigError);
}

TEST(TrackerOptions, WhoTakesThemChecksThem) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const Actor& actor = test::builtin_actor("skirt");
    const Camera camera = test::portrait_camera();
    DepthRasterizer rasterizer(device, actor.mesh, camera.width, camera.height);
    SurfaceVisibility visibility(device, actor.mesh, {});
    TrackerOptions options;
    options.taut_carried_share = 2;
    EXPECT_THROW(Tracker(device, actor, camera, options), ConfigError);
    EXPECT_THROW(PoseStage(device, actor, camera, options, rasterizer, visibility), ConfigError);
    EXPECT_THROW(SurfaceStage(device, actor, camera, options, rasterizer, visibility), ConfigError);
  });
}

}  // namespace
}  // namespace livecap
