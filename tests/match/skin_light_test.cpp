// What is told of skin and what is not, by its tint.
#include "match/skin_light.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "livecap/error.h"
#include "match/light_frames.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

std::vector<SkinSample> frame(std::mt19937& rng, int n) {
  std::vector<SkinSample> samples;
  for (const auto& [normal, brightness] : test::light_frame(rng, n, 0, 0))
    samples.push_back({int(samples.size()), normal, brightness, 10});
  return samples;
}

// A skirt that covers a third of what should be skin: darker, and of another colour.
TEST(SkinLight, IsNotThatOfWhatHasAnotherColour) {
  std::mt19937 rng(5);
  SkinLight light{SkinLightOptions{}};
  EXPECT_GT(light.off_tint(), 1e9);
  for (int f = 0; f < 60; ++f) {
    std::vector<SkinSample> samples = frame(rng, 150);
    for (size_t i = 0; i < samples.size(); ++i) {
      samples[i].tint = {1.1f, 0.8f};
      if (i % 3 > 0) continue;
      samples[i].tint = {0.6f, 1.7f};
      samples[i].brightness *= 0.4f;
      samples[i].area_px *= -1;
    }
    light.learn(samples);
  }
  EXPECT_LT(test::largest_error(light.harmonics()), test::kSkinLight);
  EXPECT_NEAR((light.tint() - Eigen::Vector2d(1.1, 0.8)).norm(), 0, test::kFloatRelative);
  EXPECT_EQ(light.off_tint(), SkinLightOptions{}.off_tint);
}

// The camera changes its white balance: nothing is of the skin's colour any more, for a few frames.
TEST(SkinLight, TheTintFollows) {
  std::mt19937 rng(6);
  SkinLight light{SkinLightOptions{}};
  light.learn(frame(rng, 50));
  EXPECT_EQ(light.tint(), Eigen::Vector2d(1, 1));
  for (int f = 0; f < 20; ++f) {
    std::vector<SkinSample> samples = frame(rng, 50);
    for (SkinSample& s : samples) {
      s.tint = {1.5f, 0.5f};
      if ((s.tint.cast<double>() - light.tint()).lpNorm<Eigen::Infinity>() > light.off_tint()) s.area_px *= -1;
    }
    light.learn(samples);
  }
  EXPECT_LT((light.tint() - Eigen::Vector2d(1.5, 0.5)).lpNorm<Eigen::Infinity>(), light.off_tint() / 2);
}

TEST(SkinLight, BadOptionsAreRefused) {
  SkinLightOptions options;
  options.off_tint = 0;
  EXPECT_THROW(SkinLight{options}, ConfigError);
  options = {};
  options.harmonics.memory_frames = 0;
  EXPECT_THROW(SkinLight{options}, ConfigError);
}

}  // namespace
}  // namespace livecap
