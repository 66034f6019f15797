#include "image/self_test.h"

#include <gtest/gtest.h>

#include "support/kernel_bodies.h"
#include "support/launched_kernels.h"

namespace livecap {
namespace {

TEST(SelfTest, AllKernelsGiveTheKnownAnswers) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const auto results = image_self_test(device);
    EXPECT_GE(results.size(), 5u);
    for (const auto& result : results) EXPECT_TRUE(result.ok) << result.kernel << ": " << result.detail;
    test::expect_every_kernel_launched(device.info(), "image/image.cl", image_self_test);
  });
}

}  // namespace
}  // namespace livecap
