// The light of a scene from samples of brightness whose light is known.
#include "match/harmonic_light.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "livecap/error.h"
#include "match/light_frames.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

std::vector<LightSample> frame(std::mt19937& rng, int n, double noise, double share_in_shadow) {
  std::vector<LightSample> samples;
  for (const auto& [normal, brightness] : test::light_frame(rng, n, noise, share_in_shadow))
    samples.push_back({normal, brightness, 10});
  return samples;
}

TEST(HarmonicLight, IsFoundFromNoisySamplesSomeInShadow) {
  std::mt19937 rng(1);
  HarmonicLight light{HarmonicLightOptions{}};
  for (int f = 0; f < 60; ++f) light.learn(frame(rng, 150, 0.05, 0.15));
  EXPECT_LT(test::largest_error(light), test::kSkinLight);
  EXPECT_NEAR(light.deviation(), 0.06, 0.02);
}

TEST(HarmonicLight, IsNotKnownBeforeEnoughFramesWithEnoughWeight) {
  std::mt19937 rng(2);
  HarmonicLight light{HarmonicLightOptions{}};
  for (int f = 0; f < 5; ++f) {
    EXPECT_FALSE(light.known()) << f;
    light.learn(frame(rng, 150, 0.02, 0));
  }
  light.learn(frame(rng, 150, 0.02, 0));
  EXPECT_TRUE(light.known());
  HarmonicLight dark{HarmonicLightOptions{}};
  for (int f = 0; f < 50; ++f) dark.learn(frame(rng, 19, 0.02, 0));
  EXPECT_FALSE(dark.known());
  for (int f = 0; f < 20; ++f) dark.learn(frame(rng, 20, 0.02, 0));  // a quarter of full_weight
  EXPECT_FALSE(dark.known());
}

// A lamp goes out: after a few memories only the new light is left.
TEST(HarmonicLight, IsForgotten) {
  std::mt19937 rng(3);
  HarmonicLightOptions options;
  options.memory_frames = 30;
  HarmonicLight light(options);
  for (int f = 0; f < 50; ++f) {
    std::vector<LightSample> samples = frame(rng, 150, 0, 0);
    for (LightSample& s : samples) s.brightness *= 0.5f;
    light.learn(samples);
  }
  EXPECT_GT(test::largest_error(light), 0.1);
  for (int f = 0; f < 300; ++f) light.learn(frame(rng, 150, 0, 0));
  EXPECT_LT(test::largest_error(light), test::kSkinLight);
}

// Half of the samples, of another light, weigh a twentieth of the others.
TEST(HarmonicLight, IsThatOfWhatWeighsMost) {
  std::mt19937 rng(4);
  HarmonicLight light{HarmonicLightOptions{}};
  for (int f = 0; f < 60; ++f) {
    std::vector<LightSample> samples = frame(rng, 150, 0, 0);
    for (size_t i = 0; i < samples.size(); i += 2) {
      samples[i].brightness *= 1.2f;
      samples[i].weight /= 20;
    }
    light.learn(samples);
  }
  EXPECT_LT(test::largest_error(light), test::kSkinLight);
}

// Most samples are dark ones, and so noisy, but weigh next to nothing.
TEST(HarmonicLight, DeviatesAsWhatWeighsMostDoes) {
  std::mt19937 rng(6);
  std::normal_distribution<float> noise(0, 0.5);
  HarmonicLight light{HarmonicLightOptions{}};
  for (int f = 0; f < 60; ++f) {
    std::vector<LightSample> samples = frame(rng, 150, 0.05, 0);
    for (size_t i = 0; i < samples.size(); ++i) {
      if (i % 3 == 0) continue;
      samples[i].brightness += noise(rng);
      samples[i].weight /= 100;
    }
    light.learn(samples);
  }
  EXPECT_NEAR(light.deviation(), 0.05, 0.01);
}

TEST(HarmonicLight, BadOptionsAreRefused) {
  for (double HarmonicLightOptions::*field :
       {&HarmonicLightOptions::memory_frames, &HarmonicLightOptions::least_frames,
        &HarmonicLightOptions::least_deviation, &HarmonicLightOptions::full_weight}) {
    HarmonicLightOptions options;
    options.*field = 0;
    EXPECT_THROW(HarmonicLight{options}, ConfigError);
  }
}

}  // namespace
}  // namespace livecap
