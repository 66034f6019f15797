// Finding OpenCL devices and choosing the two the method runs on: one for the network, one for the solvers.
#pragma once

#include <CL/cl.h>

#include <cstdint>
#include <string>
#include <vector>

namespace livecap::ocl {

// A root device or a sub-device. Plain handles: devices are never released by this library.
struct DeviceInfo {
  cl_platform_id platform = nullptr;
  cl_device_id device = nullptr;
  std::string platform_name;
  std::string platform_version;
  std::string device_name;
  std::string driver_version;
  bool is_cpu = false;
  bool is_gpu = false;
  uint32_t compute_units = 0;
  uint64_t global_memory_bytes = 0;
  uint64_t max_allocation_bytes = 0;
  uint64_t local_memory_bytes = 0;
  size_t max_work_group_size = 0;
  bool has_double = false;        // cl_khr_fp64
  bool has_long_atomics = false;  // cl_khr_int64_extended_atomics
  // Of a CPU: floats in a vector, 16 where they are one of 32 registers (AVX-512), else 8. Kernels see it as LC_VECTOR.
  int cpu_lanes = 8;

  bool is_pocl() const;
  // "device name [platform name]".
  std::string label() const;
};

// On PoCL asks for its synchronous one-core driver twice (POCL_DEVICES), which partitions two cores exactly, unless the
// user set that variable, and gives it a folder that it can write to. Must run before the first OpenCL call of the
// process; later calls do nothing.
void prepare_platforms();

// All devices of OpenCL 1.2 or later with a compiler, of all platforms in platform order. What does not answer what it
// is asked is left out, with a warning. Empty when there is none.
std::vector<DeviceInfo> list_devices();

// Throws OclError when there is none, which says what to do about it.
void require_any(const std::vector<DeviceInfo>& devices);

// selector: "" (the network's of default_pair), "cpu", "gpu", "cpu:1", "gpu:1", or a case-insensitive
// substring of the platform name with an optional index ("pocl", "nvidia:0"). Throws ConfigError listing what would be
// valid, OclError when there is no device at all.
DeviceInfo select_device(const std::string& selector);

// Selectors of one of `devices`, which are all there are: by its type, where it has one, and by its platform, both with
// an index: {"cpu:0", "pocl:0"}.
std::vector<std::string> device_selectors(const std::vector<DeviceInfo>& devices, const DeviceInfo& device);

struct DevicePair {
  DeviceInfo cnn;
  DeviceInfo solver;
};

// Of these: the first two GPUs of the first one's platform that are about equally strong, the network's first, or the
// strongest for both; without a GPU CPUs likewise, else what there is. Of one platform, since two may offer the same
// processor. `devices` must not be empty.
DevicePair default_pair(const std::vector<DeviceInfo>& devices);

// Chooses both devices. Both selectors empty: default_pair. One of them empty: it is taken to be as the other. When
// both fall on one CPU device with at least two compute units it is split with clCreateSubDevices.
DevicePair select_device_pair(const std::string& cnn_selector, const std::string& solver_selector);

}  // namespace livecap::ocl
