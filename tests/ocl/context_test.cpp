#include "ocl/context.h"

#include <gtest/gtest.h>

#include "livecap/error.h"
#include "ocl/buffer.h"
#include "ocl/kernel_source.h"
#include "support/test_device.h"

namespace livecap {
namespace {

TEST(Context, DefaultPairIsTwoContexts) {
  const ocl::DevicePair pair = ocl::select_device_pair("pocl", "pocl");
  ocl::DeviceContext cnn(pair.cnn);
  ocl::DeviceContext solver(pair.solver);
  EXPECT_NE(cnn.context(), solver.context());
  EXPECT_NE(pair.cnn.device, pair.solver.device);
}

TEST(Context, BuffersKeepWhatIsWritten) {
  test::on_every_device([](ocl::DeviceContext& device) {
    for (size_t n : {0u, 1u, 63u, 64u, 65u}) {
      std::vector<float> values(n);
      for (size_t i = 0; i < n; ++i) values[i] = static_cast<float>(i) * 0.5f;
      ocl::Buffer<float> buffer(device, values);
      EXPECT_EQ(buffer.read_all(), values);
    }
  });
}

TEST(Context, TransfersOutsideABufferAreRefused) {
  test::on_every_device([](ocl::DeviceContext& device) {
    ocl::Buffer<float> buffer(device, 4);
    EXPECT_THROW(buffer.write(std::vector<float>(5)), LogicError);
  });
}

TEST(Context, UnknownSelectorListsWhatThereIs) {
  try {
    ocl::select_device("no-such-platform");
    FAIL() << "expected OclError";
  } catch (const OclError& e) {
    EXPECT_NE(std::string(e.what()).find("available:"), std::string::npos) << e.what();
  }
}

TEST(Context, EveryKernelFileResolvesItsIncludes) {
  const auto paths = ocl::kernel_paths();
  EXPECT_GT(paths.size(), 10u);
  for (const auto& path : paths) EXPECT_NO_THROW(ocl::resolve_kernel_source(path)) << path;
}

}  // namespace
}  // namespace livecap
