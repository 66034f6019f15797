// The light of a scene from samples of brightness whose light is known.
#include "match/skin_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

// A bright sky and a sun from the upper left in front, without their shadows: linear and quadratic in n.
double brightness(const Eigen::Vector3d& n) {
  const double sun = n.dot(Eigen::Vector3d(-0.3, -0.6, -0.5));
  return 0.6 - 0.2 * n.y() + 0.4 * sun + 0.3 * sun * sun;
}

// Normals of what a camera sees: towards -z.
std::vector<SkinSample> frame(std::mt19937& rng, int n, double noise, double share_in_shadow) {
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0, 1);
  std::vector<SkinSample> samples;
  while (int(samples.size()) < n) {
    const Eigen::Vector3d v = Eigen::Vector3d(normal(rng), normal(rng), normal(rng)).normalized();
    if (v.z() > -0.3) continue;
    const double shadow = uniform(rng) < share_in_shadow ? 0.3 : 1;
    const double seen = shadow * brightness(v) + noise * normal(rng);
    samples.push_back({int(samples.size()), v.cast<float>(), float(seen), 10});
  }
  return samples;
}

double largest_error(const SkinLight& light) {
  std::mt19937 rng(99);
  double worst = 0;
  for (const SkinSample& s : frame(rng, 200, 0, 0)) {
    const Eigen::Vector3d n = s.normal.cast<double>();
    worst = std::max(worst, std::abs(light.residual(n, brightness(n))) * light.deviation());
  }
  return worst;
}

TEST(SkinLight, IsFoundFromNoisySamplesSomeInShadow) {
  std::mt19937 rng(1);
  SkinLight light{SkinLightOptions{}};
  for (int f = 0; f < 60; ++f) light.learn(frame(rng, 150, 0.05, 0.15));
  EXPECT_LT(largest_error(light), test::kSkinLight);
  EXPECT_NEAR(light.deviation(), 0.06, 0.02);
}

TEST(SkinLight, IsNotKnownBeforeEnoughFramesWithEnoughSkin) {
  std::mt19937 rng(2);
  SkinLight light{SkinLightOptions{}};
  for (int f = 0; f < 5; ++f) {
    EXPECT_FALSE(light.known()) << f;
    light.learn(frame(rng, 150, 0.02, 0));
  }
  light.learn(frame(rng, 150, 0.02, 0));
  EXPECT_TRUE(light.known());
  SkinLight dark{SkinLightOptions{}};
  for (int f = 0; f < 50; ++f) dark.learn(frame(rng, 19, 0.02, 0));
  EXPECT_FALSE(dark.known());
  for (int f = 0; f < 20; ++f) dark.learn(frame(rng, 20, 0.02, 0));  // a quarter of full_area_px
  EXPECT_FALSE(dark.known());
}

// A lamp goes out: after a few memories only the new light is left.
TEST(SkinLight, IsForgotten) {
  std::mt19937 rng(3);
  SkinLightOptions options;
  options.memory_frames = 30;
  SkinLight light(options);
  for (int f = 0; f < 50; ++f) {
    std::vector<SkinSample> samples = frame(rng, 150, 0, 0);
    for (SkinSample& s : samples) s.brightness *= 0.5f;
    light.learn(samples);
  }
  EXPECT_GT(largest_error(light), 0.1);
  for (int f = 0; f < 300; ++f) light.learn(frame(rng, 150, 0, 0));
  EXPECT_LT(largest_error(light), test::kSkinLight);
}

// A skirt that covers a third of what should be skin: darker, and of another colour.
TEST(SkinLight, IsNotThatOfWhatHasAnotherColour) {
  std::mt19937 rng(5);
  SkinLight light{SkinLightOptions{}};
  EXPECT_GT(light.off_tint(), 1e9);
  for (int f = 0; f < 60; ++f) {
    std::vector<SkinSample> samples = frame(rng, 150, 0, 0);
    for (size_t i = 0; i < samples.size(); ++i) {
      samples[i].tint = {1.1f, 0.8f};
      if (i % 3 > 0) continue;
      samples[i].tint = {0.6f, 1.7f};
      samples[i].brightness *= 0.4f;
      samples[i].area_px *= -1;
    }
    light.learn(samples);
  }
  EXPECT_LT(largest_error(light), test::kSkinLight);
  EXPECT_NEAR((light.tint() - Eigen::Vector2d(1.1, 0.8)).norm(), 0, test::kFloatRelative);
  EXPECT_EQ(light.off_tint(), SkinLightOptions{}.off_tint);
}

// The camera changes its white balance: nothing is of the skin's colour any more, for a few frames.
TEST(SkinLight, TheTintFollows) {
  std::mt19937 rng(6);
  SkinLight light{SkinLightOptions{}};
  light.learn(frame(rng, 50, 0, 0));
  EXPECT_EQ(light.tint(), Eigen::Vector2d(1, 1));
  for (int f = 0; f < 20; ++f) {
    std::vector<SkinSample> samples = frame(rng, 50, 0, 0);
    for (SkinSample& s : samples) {
      s.tint = {1.5f, 0.5f};
      if ((s.tint.cast<double>() - light.tint()).lpNorm<Eigen::Infinity>() > light.off_tint()) s.area_px *= -1;
    }
    light.learn(samples);
  }
  EXPECT_LT((light.tint() - Eigen::Vector2d(1.5, 0.5)).lpNorm<Eigen::Infinity>(), light.off_tint() / 2);
}

TEST(SkinLight, BadOptionsAreRefused) {
  for (double SkinLightOptions::*field :
       {&SkinLightOptions::memory_frames, &SkinLightOptions::least_frames, &SkinLightOptions::least_deviation,
        &SkinLightOptions::full_area_px, &SkinLightOptions::off_tint}) {
    SkinLightOptions options;
    options.*field = 0;
    EXPECT_THROW(SkinLight{options}, ConfigError);
  }
}

}  // namespace
}  // namespace livecap
