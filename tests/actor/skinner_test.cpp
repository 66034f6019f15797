#include "actor/skinner.h"

#include <gtest/gtest.h>

#include "support/kernel_bodies.h"

namespace livecap {
namespace {

TEST(Skinner, KnownAnswers) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const auto results = skinner_self_test(device);
    EXPECT_EQ(results.size(), 3u);
    for (const auto& result : results) EXPECT_TRUE(result.ok) << result.kernel << ": " << result.detail;
  });
}

}  // namespace
}  // namespace livecap
