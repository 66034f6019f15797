// Which of the devices that a machine has are taken when nobody says.
#include "ocl/device.h"

#include <gtest/gtest.h>

#include <cstdint>

namespace livecap {
namespace {

enum Kind { kGpu, kCpu, kOther };

ocl::DeviceInfo device(intptr_t platform, intptr_t id, Kind kind) {
  ocl::DeviceInfo info;
  info.platform = reinterpret_cast<cl_platform_id>(platform);
  info.device = reinterpret_cast<cl_device_id>(id);
  info.is_gpu = kind == kGpu;
  info.is_cpu = kind == kCpu;
  return info;
}

ocl::DeviceInfo gpu(intptr_t id, const char* name, uint32_t compute_units) {
  ocl::DeviceInfo info = device(1, id, kGpu);
  info.device_name = name;
  info.compute_units = compute_units;
  return info;
}

void expect_pair(const std::vector<ocl::DeviceInfo>& devices, intptr_t cnn, intptr_t solver) {
  const ocl::DevicePair pair = ocl::default_pair(devices);
  EXPECT_EQ(reinterpret_cast<intptr_t>(pair.cnn.device), cnn);
  EXPECT_EQ(reinterpret_cast<intptr_t>(pair.solver.device), solver);
}

TEST(Device, GpusComeBeforeCpus) {
  expect_pair({device(1, 1, kCpu), device(2, 2, kGpu)}, 2, 2);
  expect_pair({device(1, 1, kCpu), device(2, 2, kGpu), device(2, 3, kGpu)}, 2, 3);
}

TEST(Device, OneCardUnderTwoDriversIsOne) {
  expect_pair({device(1, 1, kGpu), device(2, 2, kGpu)}, 1, 1);
  expect_pair({device(1, 1, kGpu), device(2, 2, kGpu), device(1, 3, kGpu)}, 1, 3);
}

TEST(Device, AWeakGpuBesideAStrongOneGetsNoWork) {
  expect_pair({gpu(1, "integrated", 2), gpu(2, "card", 40)}, 2, 2);
  expect_pair({gpu(1, "card", 40), gpu(2, "integrated", 2)}, 1, 1);
  expect_pair({gpu(1, "integrated", 2), gpu(2, "card", 40), gpu(3, "card", 40)}, 2, 3);
}

TEST(Device, GpusOfAboutTheSameStrengthShareTheWork) {
  expect_pair({gpu(1, "older card", 20), gpu(2, "card", 40)}, 1, 2);
  expect_pair({gpu(1, "older card", 19), gpu(2, "card", 40)}, 2, 2);
  // One name is enough.
  expect_pair({gpu(1, "card", 14), gpu(2, "card", 98)}, 1, 2);
}

TEST(Device, OneProcessorUnderTwoDriversIsOne) {
  expect_pair({device(1, 1, kCpu), device(2, 2, kCpu), device(2, 3, kCpu)}, 1, 1);
}

TEST(Device, EmulatorsOfOtherHardwareComeLast) {
  expect_pair({device(1, 1, kOther), device(2, 2, kCpu), device(2, 3, kCpu)}, 2, 3);
  expect_pair({device(1, 1, kOther)}, 1, 1);
}

}  // namespace
}  // namespace livecap
