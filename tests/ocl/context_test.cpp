#include "ocl/context.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <numeric>
#include <thread>
#include <vector>

#include "base/text.h"
#include "livecap/error.h"
#include "livecap/log.h"
#include "ocl/buffer.h"
#include "ocl/kernel.h"
#include "ocl/kernel_source.h"
#include "support/kernel_bodies.h"
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

TEST(Context, SiblingsShareTheirPrograms) {
  test::on_every_device([](ocl::DeviceContext& device) {
    auto first = std::make_unique<ocl::DeviceContext>(device.info());
    auto sibling = std::make_unique<ocl::DeviceContext>(*first, ocl::SharedMemory{});
    EXPECT_EQ(first->program("surface/surface.cl"), sibling->program("surface/surface.cl"));
    first.reset();
    ocl::Buffer<int32_t> order(*sibling, std::vector<int32_t>{0});
    ocl::Buffer<float> packed(*sibling, std::vector<float>{1, 2, 3}), planes(*sibling, 3);
    ocl::Kernel pack(*sibling, "surface/surface.cl", "pack_planes");
    pack.launch(ocl::Range{1, 1, 1, 1}, 1, 1, 1, order, packed, packed, packed, packed, planes, planes, planes, planes);
    EXPECT_EQ(planes.read_all(), (std::vector<float>{1, 2, 3}));
  });
}

// PoCL's assertion (ocl/program_twins.h) ended three of four processes with two captures.
TEST(Context, TwoMayRunTheSameKernelsOverDifferentSizes) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const auto run = [&](int n) {
      ocl::DeviceContext own(device.info());
      std::vector<float> values(3 * size_t(n), 2.0f);
      std::vector<int32_t> rows(n);
      std::iota(rows.begin(), rows.end(), 0);
      const ocl::Buffer<int32_t> order(own, rows);
      const ocl::Buffer<float> packed(own, values);
      ocl::Buffer<float> planes(own, values.size());
      ocl::Kernel pack(own, "surface/surface.cl", "pack_planes");
      for (int round = 0; round < 2000 * n; round += 1 + n / 2)
        pack.launch(ocl::Range{1 + size_t(round) % n, 1, 1, 1}, n, n, n, order, packed, packed, packed, packed, planes,
                    planes, planes, planes);
      pack.launch(ocl::Range{size_t(n), 1, 1, 1}, n, n, n, order, packed, packed, packed, packed, planes, planes,
                  planes, planes);
      EXPECT_EQ(planes.read_all(), values);
    };
    std::vector<std::thread> threads;
    for (int n : {3, 50, 7, 400}) threads.emplace_back(run, n);
    for (std::thread& thread : threads) thread.join();
  });
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

TEST(Context, LaterTransfersKeepTheirOrder) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    constexpr int kCount = 1000;
    ocl::Buffer<int32_t> source(device, kCount), copy(device, kCount);
    std::vector<std::vector<int32_t>> seen(3, std::vector<int32_t>(kCount));
    for (int round = 0; round < 3; ++round) {
      std::vector<int32_t> values(kCount, round + 1);
      source.write_later(values);
      std::fill(values.begin(), values.end(), -1);  // they were copied
      copy.copy_from(source);
      copy.read_later(seen[round]);
    }
    source.write_later(std::vector<int32_t>(2, 9));
    ocl::Buffer<int32_t> moved = std::move(source);
    EXPECT_EQ(moved.read_all()[1], 9);
    EXPECT_EQ(moved.read_all()[2], 3);
    for (int round = 0; round < 3; ++round) EXPECT_EQ(seen[round], std::vector<int32_t>(kCount, round + 1));
    EXPECT_THROW(copy.write_later(std::vector<int32_t>(kCount + 1)), LogicError);
  });
}

// More of them under way than the page-locked memory of a GPU's queue holds, and one that is larger than it is.
TEST(Context, LaterTransfersMayBeLarge) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    for (int count : {400'000, 1'500'000}) {
      ocl::Buffer<int32_t> source(device, count), copy(device, count);
      std::vector<std::vector<int32_t>> seen(4, std::vector<int32_t>(count));
      for (int round = 0; round < 4; ++round) {
        std::vector<int32_t> values(count, round + 1);
        source.hand_over(values);
        source.hand_over(std::vector<int32_t>(1, -round), count - 1);
        values.assign(count, -1);
        copy.copy_from(source);
        copy.read_later(seen[round]);
      }
      device.finish();
      for (int round = 0; round < 4; ++round) {
        EXPECT_EQ(std::count(seen[round].begin(), seen[round].end(), round + 1), count - 1);
        EXPECT_EQ(seen[round].back(), -round);
      }
      EXPECT_THROW(copy.hand_over(std::vector<int32_t>(1), count), LogicError);
    }
  });
}

// Arguments that stay the same are not set again; those of a kernel whose buffers were made anew are.
TEST(Context, KernelsSeeTheArgumentsOfEachLaunch) {
  test::on_every_device([](ocl::DeviceContext& device) {
    constexpr int kWidth = 20;
    ocl::Kernel overlaps(device, "raster/raster.cl", "row_overlaps");
    const ocl::Buffer<int32_t> ids(device, std::vector<int32_t>(kWidth, 0));
    const auto first = std::make_unique<ocl::Buffer<uint8_t>>(device, std::vector<uint8_t>(kWidth, 255));
    auto second = std::make_unique<ocl::Buffer<uint8_t>>(device, std::vector<uint8_t>(kWidth, 0));
    ocl::Buffer<int32_t> overlap(device, 2);
    const auto both = [&](int width, const ocl::Buffer<uint8_t>& mask) {
      overlaps.launch(ocl::Range{1, 1, 1, 1}, width, 1, ids, mask, overlap);
      return overlap.read_all()[0];
    };
    EXPECT_EQ(both(kWidth, *first), kWidth);
    EXPECT_EQ(both(kWidth, *first), kWidth);
    EXPECT_EQ(both(kWidth, *second), 0);
    EXPECT_EQ(both(kWidth - 3, *first), kWidth - 3);
    EXPECT_EQ(both(kWidth, *second), 0);
    second.reset();
    second = std::make_unique<ocl::Buffer<uint8_t>>(device, std::vector<uint8_t>(kWidth, 200));
    EXPECT_EQ(both(kWidth, *second), kWidth);
  });
}

// What an editor shows of an exception, and livecap_last_error() returns, is one line.
TEST(Context, AProgramThatDoesNotBuildSaysWhyInOneLine) {
  const std::filesystem::path folder =
      std::filesystem::temp_directory_path() / format("livecap_kernels_%d", int(::getpid()));
  std::filesystem::create_directories(folder);
  write_file_atomically(folder / "broken.cl", "kernel void broken(global int* x) {\n  *x = nowhere;\n}\n");
  ::setenv("LIVECAP_KERNEL_DIR", folder.c_str(), 1);
  std::string logged, message;
  set_log_sink([&](LogLevel, const std::string& lines) { logged += lines + "\n"; });
  test::on_every_device([&](ocl::DeviceContext& device) {
    logged.clear();
    message.clear();
    try {
      device.program("broken.cl");
    } catch (const OclError& error) {
      message = error.what();
    }
    EXPECT_NE(message.find("kernels/broken.cl"), std::string::npos) << message;
    EXPECT_NE(message.find("nowhere"), std::string::npos) << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    EXPECT_NE(logged.find("nowhere"), std::string::npos) << logged;
    EXPECT_GE(std::count(logged.begin(), logged.end(), '\n'), 2) << logged;
  });
  set_log_sink({});
  ::unsetenv("LIVECAP_KERNEL_DIR");
  std::filesystem::remove_all(folder);
}

TEST(Context, UnknownSelectorListsWhatWouldBeValid) {
  for (const std::string selector : {"no-such-platform", "pocl:99"}) {
    try {
      ocl::select_device(selector);
      FAIL() << "expected ConfigError";
    } catch (const ConfigError& e) {
      EXPECT_NE(std::string(e.what()).find(selector), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find("valid are "), std::string::npos) << e.what();
      EXPECT_NE(std::string(e.what()).find(":0 ("), std::string::npos) << e.what();
    }
  }
}

TEST(Context, EverySelectorThatIsToldSelectsItsDevice) {
  const std::vector<ocl::DeviceInfo> devices = ocl::list_devices();
  ASSERT_FALSE(devices.empty());
  for (const ocl::DeviceInfo& device : devices) {
    const std::vector<std::string> selectors = ocl::device_selectors(devices, device);
    EXPECT_EQ(selectors.size(), device.is_cpu || device.is_gpu ? 2u : 1u);
    for (const std::string& selector : selectors) EXPECT_EQ(ocl::select_device(selector).device, device.device);
  }
}

// Two platforms of one vendor share their index; a device that is neither CPU nor GPU has its platform alone.
TEST(Context, SelectorsCountAcrossPlatforms) {
  const auto device = [](size_t id, const char* platform, bool is_cpu, bool is_gpu) {
    ocl::DeviceInfo info;
    info.device = reinterpret_cast<cl_device_id>(id);
    info.platform_name = platform;
    info.is_cpu = is_cpu;
    info.is_gpu = is_gpu;
    return info;
  };
  const std::vector<ocl::DeviceInfo> devices = {
      device(1, "Intel(R) OpenCL", true, false), device(2, "Intel(R) OpenCL HD Graphics", false, true),
      device(3, "NVIDIA CUDA", false, true), device(4, "Portable Computing Language", true, false),
      device(5, "Intel(R) FPGA Emulation Platform", false, false)};
  using Selectors = std::vector<std::string>;
  EXPECT_EQ(ocl::device_selectors(devices, devices[0]), (Selectors{"cpu:0", "intel:0"}));
  EXPECT_EQ(ocl::device_selectors(devices, devices[1]), (Selectors{"gpu:0", "intel:1"}));
  EXPECT_EQ(ocl::device_selectors(devices, devices[2]), (Selectors{"gpu:1", "nvidia:0"}));
  EXPECT_EQ(ocl::device_selectors(devices, devices[3]), (Selectors{"cpu:1", "pocl:0"}));
  EXPECT_EQ(ocl::device_selectors(devices, devices[4]), (Selectors{"intel:2"}));
}

TEST(Context, EveryKernelFileResolvesItsIncludes) {
  const auto paths = ocl::kernel_paths();
  EXPECT_GT(paths.size(), 10u);
  for (const auto& path : paths) EXPECT_NO_THROW(ocl::resolve_kernel_source(path)) << path;
}

}  // namespace
}  // namespace livecap
