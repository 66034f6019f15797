#include "actor/skinner.h"

#include <gtest/gtest.h>

#include "support/test_device.h"

namespace livecap {
namespace {

TEST(Skinner, KnownAnswersOnEveryDevice) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const auto results = skinner_self_test(device);
    EXPECT_EQ(results.size(), 3u);
    for (const auto& result : results) EXPECT_TRUE(result.ok) << result.kernel << ": " << result.detail;
  });
}

}  // namespace
}  // namespace livecap
