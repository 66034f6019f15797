#include "raster/self_test.h"

#include <gtest/gtest.h>

#include "scenes.h"

namespace livecap {
namespace {

TEST(SelfTest, AllKernelsGiveTheKnownAnswers) {
  test::on_every_body([](ocl::DeviceContext& device) {
    const auto results = raster_self_test(device);
    EXPECT_GE(results.size(), 7u);
    for (const auto& result : results) EXPECT_TRUE(result.ok) << result.kernel << ": " << result.detail;
  });
}

}  // namespace
}  // namespace livecap
