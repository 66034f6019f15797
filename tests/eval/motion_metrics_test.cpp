// Jitter, sliding feet and losses against values worked out by hand.
#include "eval/motion_metrics.h"

#include <gtest/gtest.h>

#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using test::kDoubleExact;
using test::kFloatRelative;

TEST(MotionMetrics, JitterOfAParabola) {
  // Truth: x = 4 t^2 mm per frame squared: second difference 8 mm, at 10 fps 800 mm/s^2 = 0.8 m/s^2. The capture moves
  // at constant speed: no acceleration of its own, error 0.8.
  JitterMeter meter(10);
  for (int t = 0; t < 5; ++t) {
    meter.add(std::vector<float>{100.0f * t, 0, 3000}, std::vector<float>{4.0f * t * t, 0, 3000});
  }
  const Jitter jitter = meter.result();
  EXPECT_EQ(jitter.n, 3);
  EXPECT_NEAR(jitter.truth, 0.8, kDoubleExact);
  EXPECT_NEAR(jitter.captured, 0, kDoubleExact);
  EXPECT_NEAR(jitter.error, 0.8, kDoubleExact);
}

TEST(MotionMetrics, OppositeAccelerationsAddUp) {
  // +3 and -1 mm per frame squared in y for one point, both 2 in z for the other: error 4 and 0, at 30 fps * 0.9.
  JitterMeter meter(30);
  for (int t = 0; t < 3; ++t) {
    const float square = 0.5f * t * t;
    meter.add(std::vector<float>{0, 3 * square, 0, 0, 0, 2 * square},
              std::vector<float>{0, -square, 0, 9, 9, 2 * square});
  }
  const Jitter jitter = meter.result();
  EXPECT_EQ(jitter.n, 2);
  EXPECT_NEAR(jitter.error, 0.9 * (4 + 0) / 2, kDoubleExact);
  EXPECT_NEAR(jitter.captured, 0.9 * (3 + 2) / 2, kDoubleExact);
  EXPECT_NEAR(jitter.truth, 0.9 * (1 + 2) / 2, kDoubleExact);
}

TEST(MotionMetrics, AWobbleOfTheWholeBodyIsGoneWhenCentred) {
  for (const bool centred : {false, true}) {
    JitterMeter meter(10, centred);
    for (int t = 0; t < 4; ++t) {
      const float wobble = t % 2 ? 10.0f : 0.0f;  // second difference +-20 mm: 2 m/s^2
      meter.add(std::vector<float>{wobble, 0, 0, wobble + 5, 0, 0}, std::vector<float>{0, 0, 0, 5, 0, 0});
    }
    EXPECT_NEAR(meter.result().error, centred ? 0 : 2, kFloatRelative) << centred;
  }
}

TEST(MotionMetrics, AnUnknownPointBreaksItsOwnSequence) {
  JitterMeter meter(10);
  for (int t = 0; t < 4; ++t) {
    const float unknown = t == 3 ? NAN : 0;
    meter.add(std::vector<float>{unknown, 0, 0, 10.0f * t * t, 0, 0}, std::vector<float>{0, 0, 0, 0, 0, 0});
  }
  EXPECT_EQ(meter.result().n, 3);  // one of the first point, two of the second
  EXPECT_NEAR(meter.result().error, (0 + 2 + 2) / 3.0, kDoubleExact);
}

TEST(MotionMetrics, AGapBreaksTheSequence) {
  JitterMeter meter(10);
  const std::vector<float> here = {0, 0, 0}, far = {9999, 0, 0};
  meter.add(here, here);
  meter.add(here, here);
  meter.add({}, far);  // no result
  meter.add(far, far);
  meter.add(far, far);
  EXPECT_EQ(meter.result().n, 0);
  meter.add(far, far);
  EXPECT_EQ(meter.result().n, 1);
  EXPECT_EQ(meter.result().error, 0);
  EXPECT_THROW(meter.add(std::vector<float>(6), std::vector<float>(6)), LogicError);
  EXPECT_THROW(JitterMeter(0), LogicError);
}

using Foot = std::vector<std::vector<float>>;

TEST(MotionMetrics, AStandingFootThatSlides) {
  // 30 fps, so that it must stand for two frames on either side. It stands for nine frames: planted are 2..6, judged
  // the steps into 3..6. The capture slides by 3 mm in x and 4 mm in z (5 mm horizontally) and 100 mm in y, which does
  // not count: 150 mm/s.
  Foot truth(9, {0, 900, 3000});
  Foot captured;
  for (int t = 0; t < 9; ++t) captured.push_back({3.0f * t, 100.0f * t, 4.0f * t});
  const FootSlide slide = foot_slide(captured, truth, 30);
  EXPECT_EQ(slide.n, 4);
  EXPECT_NEAR(slide.mm_per_s, 150, kDoubleExact);
  EXPECT_NEAR(slide.truth_mm_per_s, 0, kDoubleExact);
}

TEST(MotionMetrics, AWalkingFootIsNotJudged) {
  Foot walking;
  for (int t = 0; t < 20; ++t) walking.push_back({20.0f * t, 0, 0});
  EXPECT_EQ(foot_slide(walking, walking, 30).n, 0);
  // At 300 fps these are 2 mm a frame: 20 frames around it span 40 mm from its place, still more than 15.
  Foot slow;
  for (int t = 0; t < 60; ++t) slow.push_back({2.0f * t, 0, 0});
  EXPECT_EQ(foot_slide(slow, slow, 300).n, 0);
  // 0.5 mm a frame: 10 mm in 20 frames stands, and slides as the truth does.
  Foot slower;
  for (int t = 0; t < 60; ++t) slower.push_back({0.5f * t, 0, 0});
  const FootSlide slide = foot_slide(slower, slower, 300);
  EXPECT_EQ(slide.n, 60 - 2 * 20 - 1);
  EXPECT_NEAR(slide.mm_per_s, 150, kDoubleExact);
  EXPECT_NEAR(slide.truth_mm_per_s, 150, kDoubleExact);
}

TEST(MotionMetrics, MissingResultsAreLeftOutOfTheSlide) {
  Foot truth(9, {0, 0, 0});
  Foot captured(9, {0, 0, 0});
  captured[4] = {};
  EXPECT_EQ(foot_slide(captured, truth, 30).n, 2);  // steps into 3 and 6
  truth[8] = {};                                    // frame 6 no longer stands for sure
  EXPECT_EQ(foot_slide(captured, truth, 30).n, 1);
  EXPECT_THROW(foot_slide(captured, Foot(3), 30), LogicError);
}

TEST(MotionMetrics, SlidesCombineByTheirSteps) {
  const FootSlide sum = combined({3, 100, 10}, {1, 500, 50});
  EXPECT_EQ(sum.n, 4);
  EXPECT_NEAR(sum.mm_per_s, 200, kDoubleExact);
  EXPECT_NEAR(sum.truth_mm_per_s, 20, kDoubleExact);
  EXPECT_EQ(combined({}, {}).n, 0);
}

std::vector<bool> flags(const std::string& text) {
  std::vector<bool> result;
  for (char c : text) result.push_back(c == '1');
  return result;
}

TEST(MotionMetrics, LossesAndRecoveries) {
  // The person enters at 2, is tracked from 4, lost at 6..8 and 10, leaves at 12 while lost, returns at 14, tracked at
  // 17, lost to the end.
  const std::vector<bool> person = flags("00111111111100111111");
  const std::vector<bool> track_ = flags("00001100010000000100");
  const Losses losses = count_losses(person, track_);
  EXPECT_EQ(losses.lost, 2 + 3 + 2 + 3 + 2);
  EXPECT_EQ(losses.n_losses, 3);
  EXPECT_EQ(losses.n_recovered, 1);
  EXPECT_EQ(losses.longest, 3);
  EXPECT_EQ(losses.longest_entry, 3);
  EXPECT_EQ(count_losses(person, person).lost, 0);
  EXPECT_EQ(count_losses(person, person).longest_entry, 0);
  EXPECT_THROW(count_losses(person, flags("1")), LogicError);
}

}  // namespace
}  // namespace livecap
