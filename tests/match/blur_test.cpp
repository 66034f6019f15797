// The blur of the drawn actor, against a sum over each pixel's neighbours in double precision.
#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "match/layout.h"
#include "match/texture_matcher.h"
#include "ocl/kernel.h"
#include "support/kernel_bodies.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

constexpr MatchBox kBox{0, 0, 48, 37};

struct Drawn {
  std::vector<float> light, weight;
};

Drawn random_actor() {
  std::mt19937 rng(3);
  std::uniform_real_distribution<float> uniform(0, 1);
  Drawn drawn;
  for (int p = 0; p < kBox.width * kBox.height; ++p) {
    drawn.weight.push_back(uniform(rng) < 0.7f ? 1.0f : 0.0f);
    drawn.light.push_back(drawn.weight.back() * uniform(rng));
  }
  return drawn;
}

std::vector<float> blurred(ocl::DeviceContext& device, const Drawn& drawn, float blur) {
  ocl::Buffer<float> result(device, drawn.light.size());
  const size_t columns = device.is_cpu() ? kBox.width / 16 : kBox.width;
  ocl::Kernel(device, kMatchProgram, "blur_actor")
      .launch(ocl::Range{columns, size_t(kBox.height), 1, 1}, kBox, blur, ocl::Buffer<float>(device, drawn.light),
              ocl::Buffer<float>(device, drawn.weight), result);
  return result.read_all();
}

double expected_at(int x, int y, const Drawn& drawn, double blur) {
  double light = 0, weight = 0;
  if (drawn.weight[size_t(y) * kBox.width + x] == 0) return 0;
  for (int dy = -1; dy <= 1; ++dy) {
    for (int dx = -1; dx <= 1; ++dx) {
      if (x + dx < 0 || x + dx >= kBox.width || y + dy < 0 || y + dy >= kBox.height) continue;
      const size_t p = size_t(y + dy) * kBox.width + x + dx;
      const double counts = (dx ? blur : 1) * (dy ? blur : 1);
      light += counts * drawn.light[p];
      weight += counts * drawn.weight[p];
    }
  }
  return light / weight;
}

TEST(Blur, IsTheMeanOfWhatIsDrawnBeside) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Drawn drawn = random_actor();
    for (const float blur : {0.15f, 1.0f}) {
      const std::vector<float> found = blurred(device, drawn, blur);
      for (int y = 0; y < kBox.height; ++y)
        for (int x = 0; x < kBox.width; ++x)
          EXPECT_NEAR(found[size_t(y) * kBox.width + x], expected_at(x, y, drawn, blur), test::kFloatRelative)
              << x << ", " << y << ", blur " << blur;
    }
  });
}

TEST(Blur, OfZeroLeavesTheActorAsItIs) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const Drawn drawn = random_actor();
    EXPECT_EQ(blurred(device, drawn, 0), drawn.light);
  });
}

}  // namespace
}  // namespace livecap
