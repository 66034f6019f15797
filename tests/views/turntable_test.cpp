// Which frames of a turn are taken, and which videos are refused.
#include "views/turntable.h"

#include <gtest/gtest.h>

#include <cmath>

#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

constexpr double kDegree = M_PI / 180;

// angles in degrees, one a frame; everybody whole and equally sharp.
std::vector<TurnSample> film(const std::vector<double>& degrees) {
  std::vector<TurnSample> samples;
  for (double angle : degrees) samples.push_back({true, true, std::remainder(angle * kDegree, 2 * M_PI), 1});
  return samples;
}

// Still for 20 frames, then `degrees` in 200 frames, then still again.
std::vector<TurnSample> turn_by(double degrees) {
  std::vector<double> angles;
  for (int i = 0; i < 240; ++i) angles.push_back(degrees * std::clamp((i - 20) / 200.0, 0.0, 1.0));
  return film(angles);
}

std::string refusal(const std::vector<TurnSample>& samples) {
  std::vector<double> angles;
  try {
    choose_turn(samples, 70, "v.mp4", angles);
  } catch (const ConfigError& error) {
    return error.what();
  }
  return "none";
}

TEST(Turntable, TakesOneTurnEvenlyEitherWay) {
  for (double degrees : {380.0, -380.0, 900.0}) {
    std::vector<double> angles;
    const std::vector<int> chosen = choose_turn(turn_by(degrees), 50, "v.mp4", angles);
    ASSERT_EQ(chosen.size(), angles.size());
    EXPECT_GE(chosen.size(), 45u);
    EXPECT_NEAR(std::abs(angles.back() - angles.front()), 2 * M_PI, 12 * kDegree);
    for (size_t i = 1; i < chosen.size(); ++i) {
      EXPECT_GT(chosen[i], chosen[i - 1]);
      EXPECT_GT(degrees * (angles[i] - angles[i - 1]), 0);
      EXPECT_LT(std::abs(angles[i] - angles[i - 1]), 15 * kDegree);
    }
  }
}

TEST(Turntable, TakesTheSharpestOfEachSide) {
  auto samples = turn_by(370);
  for (size_t i = 0; i < samples.size(); ++i) samples[i].sharpness = i % 6 == 3 ? 1 : 0.7;
  std::vector<double> angles;
  int n_sharp = 0;
  const auto chosen = choose_turn(samples, 16, "v.mp4", angles);
  for (int i : chosen) n_sharp += samples[i].sharpness == 1;
  EXPECT_GE(n_sharp, static_cast<int>(chosen.size()) - 1);
}

TEST(Turntable, OneWrongFrameDoesNotMatter) {
  auto samples = turn_by(370);
  samples[80].facing_rad = std::remainder(samples[80].facing_rad + M_PI, 2 * M_PI);
  std::vector<double> angles;
  for (int i : choose_turn(samples, 70, "v.mp4", angles)) EXPECT_GE(i, 0);
  EXPECT_NEAR(std::abs(angles.back() - angles.front()), 2 * M_PI, 12 * kDegree);
}

// From behind the network may see one direction for a while.
TEST(Turntable, TakesFramesWhereTheDirectionStands) {
  auto samples = turn_by(370);
  for (int i = 110; i < 126; ++i) samples[i].facing_rad = samples[110].facing_rad;
  std::vector<double> angles;
  const auto chosen = choose_turn(samples, 70, "v.mp4", angles);
  int widest = 0;
  for (size_t i = 1; i < chosen.size(); ++i) widest = std::max(widest, chosen[i] - chosen[i - 1]);
  EXPECT_LE(widest, 6);
  EXPECT_EQ(angles.size(), chosen.size());
}

// But a long pause shows the same picture over and over.
TEST(Turntable, APauseAddsFewFrames) {
  std::vector<double> degrees;
  for (int i = 0; i < 500; ++i) degrees.push_back(i < 100 ? 1.85 * i : i < 400 ? 185 : 185 + 1.85 * (i - 400));
  std::vector<double> angles;
  EXPECT_LE(choose_turn(film(degrees), 70, "v.mp4", angles).size(), 77u);
}

TEST(Turntable, RefusalsSayWhy) {
  EXPECT_NE(refusal(turn_by(20)).find("does not turn (20 degrees)"), std::string::npos) << refusal(turn_by(20));
  EXPECT_NE(refusal(turn_by(270)).find("by only 270 degrees"), std::string::npos) << refusal(turn_by(270));
  EXPECT_EQ(refusal(turn_by(356)), "none");

  auto nobody = turn_by(370);
  for (auto& sample : nobody) sample.person = sample.whole = false;
  EXPECT_NE(refusal(nobody).find("v.mp4: the network sees nobody"), std::string::npos);
  EXPECT_NE(refusal({}).find("nobody"), std::string::npos);

  auto cut_off = turn_by(370);
  for (auto& sample : cut_off) sample.whole = false;
  EXPECT_NE(refusal(cut_off).find("no frame shows all"), std::string::npos) << refusal(cut_off);
  auto leaves = turn_by(370);
  for (int i = 100; i < 130; ++i) leaves[i].whole = false;  // 55 degrees
  EXPECT_NE(refusal(leaves).find("leaves the picture"), std::string::npos) << refusal(leaves);
  auto gone = turn_by(370);
  for (int i = 100; i < 240; ++i) gone[i].person = gone[i].whole = false;
  EXPECT_NE(refusal(gone).find("leaves the picture"), std::string::npos) << refusal(gone);
  auto feet_cut_off = turn_by(370);
  for (size_t i = 15; i < feet_cut_off.size(); ++i) feet_cut_off[i].whole = false;  // what is left hardly turns
  EXPECT_NE(refusal(feet_cut_off).find("leaves the picture"), std::string::npos) << refusal(feet_cut_off);

  std::vector<double> to_and_fro;
  for (int i = 0; i < 240; ++i)
    to_and_fro.push_back(i < 80 ? 2.5 * i : i < 120 ? 200 - 2.5 * (i - 80) : 100 + 2.5 * (i - 120));
  EXPECT_NE(refusal(film(to_and_fro)).find("turns back by 9"), std::string::npos) << refusal(film(to_and_fro));
  std::vector<double> quick;
  for (int i = 0; i < 12; ++i) quick.push_back(36 * i);
  EXPECT_NE(refusal(film(quick)).find("turn slower"), std::string::npos) << refusal(film(quick));
}

TEST(Turntable, FacingFollowsHipsAndShoulders) {
  for (double degrees : {-150.0, -30.0, 0.0, 60.0, 170.0}) {
    // Turned to their left by an angle: camera x right, z away, so the left side goes away first.
    Detections seen;
    const double c = std::cos(degrees * kDegree), s = std::sin(degrees * kDegree);
    for (auto [k, side] : {std::pair{kLeftHip, 1.0}, {kRightHip, -1.0}, {kLeftShoulder, 2.0}, {kRightShoulder, -2.0}}) {
      seen.keypoints[k].x_mm = static_cast<float>(100 * side * c);
      seen.keypoints[k].z_mm = static_cast<float>(100 * side * s);
    }
    EXPECT_NEAR(facing_rad(seen), degrees * kDegree, test::kFacingRad) << degrees;
  }
}

}  // namespace
}  // namespace livecap
