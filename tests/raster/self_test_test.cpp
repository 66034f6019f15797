#include "raster/self_test.h"

#include <gtest/gtest.h>

#include "scenes.h"
#include "support/kernel_bodies.h"

namespace livecap {
namespace {

TEST(SelfTest, AllKernelsGiveTheKnownAnswers) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const auto results = raster_self_test(device);
    EXPECT_GE(results.size(), 7u);
    for (const auto& result : results) EXPECT_TRUE(result.ok) << result.kernel << ": " << result.detail;
  });
}

}  // namespace
}  // namespace livecap
