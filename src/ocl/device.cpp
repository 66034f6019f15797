#include "ocl/device.h"

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <iterator>
#include <map>
#include <mutex>

#include "base/log.h"
#include "base/text.h"
#include "livecap/error.h"
#include "ocl/pocl_cache.h"
#include "ocl/pocl_library.h"
#include "ocl/status.h"

namespace livecap::ocl {
namespace {

std::string platform_text(cl_platform_id platform, cl_platform_info what) {
  size_t size = 0;
  check(clGetPlatformInfo(platform, what, 0, nullptr, &size), "clGetPlatformInfo");
  std::string text(size, '\0');
  check(clGetPlatformInfo(platform, what, size, text.data(), nullptr), "clGetPlatformInfo");
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

std::string device_text(cl_device_id device, cl_device_info what) {
  size_t size = 0;
  check(clGetDeviceInfo(device, what, 0, nullptr, &size), "clGetDeviceInfo");
  std::string text(size, '\0');
  check(clGetDeviceInfo(device, what, size, text.data(), nullptr), "clGetDeviceInfo");
  while (!text.empty() && text.back() == '\0') text.pop_back();
  return text;
}

template <typename T>
T device_value(cl_device_id device, cl_device_info what) {
  T value{};
  check(clGetDeviceInfo(device, what, sizeof(T), &value, nullptr), "clGetDeviceInfo");
  return value;
}

// Of the processor this runs on, which is the one that a CPU driver compiles for.
int processor_lanes() {
#ifdef __x86_64__
  return __builtin_cpu_supports("avx512f") ? 16 : 8;
#else
  return 8;
#endif
}

DeviceInfo describe(cl_platform_id platform, cl_device_id device) {
  DeviceInfo info;
  info.platform = platform;
  info.device = device;
  info.platform_name = platform_text(platform, CL_PLATFORM_NAME);
  info.platform_version = platform_text(platform, CL_PLATFORM_VERSION);
  info.device_name = device_text(device, CL_DEVICE_NAME);
  info.driver_version = device_text(device, CL_DRIVER_VERSION);
  const auto type = device_value<cl_device_type>(device, CL_DEVICE_TYPE);
  info.is_cpu = type & CL_DEVICE_TYPE_CPU;
  info.is_gpu = type & CL_DEVICE_TYPE_GPU;
  info.cpu_lanes = processor_lanes();
  info.compute_units = device_value<cl_uint>(device, CL_DEVICE_MAX_COMPUTE_UNITS);
  info.global_memory_bytes = device_value<cl_ulong>(device, CL_DEVICE_GLOBAL_MEM_SIZE);
  info.max_allocation_bytes = device_value<cl_ulong>(device, CL_DEVICE_MAX_MEM_ALLOC_SIZE);
  info.local_memory_bytes = device_value<cl_ulong>(device, CL_DEVICE_LOCAL_MEM_SIZE);
  info.max_work_group_size = device_value<size_t>(device, CL_DEVICE_MAX_WORK_GROUP_SIZE);
  const std::string extensions = device_text(device, CL_DEVICE_EXTENSIONS);
  info.has_double = extensions.find("cl_khr_fp64") != std::string::npos;
  info.has_long_atomics = extensions.find("cl_khr_int64_extended_atomics") != std::string::npos;
  return info;
}

// Whether kernels can be built for it: it is there, has a compiler, and is of OpenCL 1.2 or later ("OpenCL 1.2 ...").
bool is_usable(cl_device_id device) {
  if (!device_value<cl_bool>(device, CL_DEVICE_AVAILABLE) ||
      !device_value<cl_bool>(device, CL_DEVICE_COMPILER_AVAILABLE))
    return false;
  int major = 0, minor = 0;
  return std::sscanf(device_text(device, CL_DEVICE_VERSION).c_str(), "OpenCL %d.%d", &major, &minor) == 2 &&
         (major > 1 || (major == 1 && minor >= 2));
}

void add_usable_devices(cl_platform_id platform, std::vector<DeviceInfo>& result) {
  cl_uint n_devices = 0;
  const cl_int found = clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, 0, nullptr, &n_devices);
  if (found != CL_SUCCESS || n_devices == 0) return;  // a driver without hardware is not an error
  std::vector<cl_device_id> devices(n_devices);
  check(clGetDeviceIDs(platform, CL_DEVICE_TYPE_ALL, n_devices, devices.data(), nullptr), "clGetDeviceIDs");
  for (cl_device_id device : devices)
    if (is_usable(device)) result.push_back(describe(platform, device));
}

// PoCL's platform has its long name in some versions.
const std::string kPocl = "pocl";
const std::string kPoclLongName = "portable computing";

std::string lower(std::string text) {
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

// Indices of those that a selector without its index means, in the order that its index counts them.
std::vector<size_t> matching_devices(const std::vector<DeviceInfo>& devices, const std::string& name) {
  std::vector<size_t> matching;
  const auto add_where = [&](const auto& fits) {
    for (size_t i = 0; i < devices.size(); ++i)
      if (fits(devices[i])) matching.push_back(i);
  };
  if (name.empty()) {
    add_where([](const DeviceInfo& device) { return device.is_gpu; });
    add_where([](const DeviceInfo& device) { return !device.is_gpu; });
  } else if (name == "cpu") {
    add_where([](const DeviceInfo& device) { return device.is_cpu; });
  } else if (name == "gpu") {
    add_where([](const DeviceInfo& device) { return device.is_gpu; });
  } else {
    const auto named = [&](const std::string& part) {
      add_where([&](const DeviceInfo& device) { return lower(device.platform_name).find(part) != std::string::npos; });
    };
    named(name);
    if (matching.empty() && name == kPocl) named(kPoclLongName);
  }
  return matching;
}

// By which its platform is called for short: "pocl", "nvidia", "amd", "intel".
std::string platform_selector(const DeviceInfo& device) {
  if (device.is_pocl()) return kPocl;
  const std::string name = lower(device.platform_name);
  const auto is_letter = [](unsigned char c) { return std::isalpha(c) != 0; };
  const auto begin = std::find_if(name.begin(), name.end(), is_letter);
  return {begin, std::find_if_not(begin, name.end(), is_letter)};
}

// "pocl:0 (device name [platform name]); ..."
std::string valid_selectors(const std::vector<DeviceInfo>& devices) {
  std::string text;
  for (const DeviceInfo& device : devices)
    text += (text.empty() ? "" : "; ") + device_selectors(devices, device).front() + " (" + device.label() + ")";
  return text;
}

// Splits a CPU device into two equal sub-devices, once: they live as long as the process. Empty when the driver cannot.
std::vector<cl_device_id> split_in_two(const DeviceInfo& info) {
  static std::mutex mutex;
  static std::map<cl_device_id, std::vector<cl_device_id>> halves;
  if (info.compute_units < 2) return {};
  const std::scoped_lock lock(mutex);
  if (const auto found = halves.find(info.device); found != halves.end()) return found->second;
  const cl_device_partition_property properties[] = {
      CL_DEVICE_PARTITION_EQUALLY, static_cast<cl_device_partition_property>(info.compute_units / 2), 0};
  std::vector<cl_device_id> parts(info.compute_units);
  cl_uint count = 0;
  const cl_int status = clCreateSubDevices(info.device, properties, info.compute_units, parts.data(), &count);
  if (status != CL_SUCCESS || count < 2) return {};
  parts.resize(2);
  return halves[info.device] = parts;
}

}  // namespace

bool DeviceInfo::is_pocl() const {
  const std::string name = lower(platform_name);
  return name.find(kPocl) != std::string::npos || name.find(kPoclLongName) != std::string::npos;
}

std::string DeviceInfo::label() const {
  return device_name + " [" + platform_name + "]";
}

void prepare_platforms() {
  static std::once_flag once;
  std::call_once(once, [] {
    // A driver name that this PoCL does not know would leave it without devices: an unknown version keeps its default.
    const std::string driver = one_core_driver(icd_folders());
    if (driver.empty()) return;
    ::setenv("POCL_DEVICES", (driver + " " + driver).c_str(), 0);
    require_pocl_cache();
  });
}

std::vector<DeviceInfo> list_devices() {
  prepare_platforms();
  // Loaders and drivers start at the first of these calls, and several do not when asked by two threads at a time.
  static std::mutex mutex;
  const std::scoped_lock lock(mutex);
  cl_uint n_platforms = 0;
  const cl_int status = clGetPlatformIDs(0, nullptr, &n_platforms);
  if (status != CL_SUCCESS || n_platforms == 0) return {};
  std::vector<cl_platform_id> platforms(n_platforms);
  check(clGetPlatformIDs(n_platforms, platforms.data(), nullptr), "clGetPlatformIDs");
  std::vector<DeviceInfo> result;
  for (cl_platform_id platform : platforms) {
    try {
      add_usable_devices(platform, result);
    } catch (const OclError& error) {  // a broken driver beside a good one
      log_warning(std::string("an OpenCL driver is left out: ") + error.what());
    }
  }
  return result;
}

void require_any(const std::vector<DeviceInfo>& devices) {
  if (!devices.empty()) return;
  const std::string complaint = one_core_driver(icd_folders()).empty() ? "" : pocl_cache_complaint();
  throw OclError("no OpenCL device was found; " +
                 (complaint.empty() ? "install a driver (on Debian: apt install pocl-opencl-icd) and see `livecap "
                                      "devices`"
                                    : complaint + "; see POCL_CACHE_DIR"));
}

DeviceInfo select_device(const std::string& selector) {
  const auto devices = list_devices();
  require_any(devices);
  if (selector.empty()) return default_pair(devices).cnn;
  std::string name = lower(selector);
  size_t index = 0;
  if (const size_t colon = name.rfind(':'); colon != std::string::npos) {
    const std::string digits = name.substr(colon + 1);
    if (digits.empty() || digits.size() > 4 ||
        !std::all_of(digits.begin(), digits.end(), [](unsigned char c) { return std::isdigit(c); }))
      throw ConfigError("device selector \"" + selector +
                        "\": expected cpu, gpu or part of a platform name, then optionally :index");
    index = static_cast<size_t>(std::stoi(digits));
    name.resize(colon);
  }
  const std::vector<size_t> matching = matching_devices(devices, name);
  if (index >= matching.size())
    throw ConfigError("device selector \"" + selector + "\" " +
                      (matching.empty() ? "matches no device" : format("matches only %zu device(s)", matching.size())) +
                      "; valid are " + valid_selectors(devices));
  return devices[matching[index]];
}

std::vector<std::string> device_selectors(const std::vector<DeviceInfo>& devices, const DeviceInfo& device) {
  std::vector<std::string> selectors;
  const auto add = [&](const std::string& name) {
    const std::vector<size_t> matching = matching_devices(devices, name);
    for (size_t i = 0; i < matching.size(); ++i)
      if (devices[matching[i]].device == device.device) selectors.push_back(name + ":" + std::to_string(i));
  };
  if (device.is_cpu) add("cpu");
  if (device.is_gpu) add("gpu");
  add(platform_selector(device));
  return selectors;
}

DevicePair default_pair(const std::vector<DeviceInfo>& devices) {
  std::vector<DeviceInfo> candidates;
  for (const auto kind : {&DeviceInfo::is_gpu, &DeviceInfo::is_cpu}) {
    if (candidates.empty())
      std::copy_if(devices.begin(), devices.end(), std::back_inserter(candidates), std::mem_fn(kind));
  }
  if (candidates.empty()) candidates = devices;
  std::erase_if(candidates, [platform = candidates.at(0).platform](const DeviceInfo& device) {
    return device.platform != platform;
  });
  const DeviceInfo strongest =
      *std::max_element(candidates.begin(), candidates.end(),
                        [](const DeviceInfo& a, const DeviceInfo& b) { return a.compute_units < b.compute_units; });
  // Half of the work would take an integrated GPU longer than all of it takes the card beside it.
  std::erase_if(candidates, [&](const DeviceInfo& device) {
    return device.device_name != strongest.device_name && 2 * device.compute_units < strongest.compute_units;
  });
  return {candidates.front(), candidates.size() > 1 ? candidates[1] : candidates.front()};
}

DevicePair select_device_pair(const std::string& cnn_selector, const std::string& solver_selector) {
  DevicePair pair;
  if (cnn_selector.empty() && solver_selector.empty()) {
    const auto devices = list_devices();
    require_any(devices);
    pair = default_pair(devices);
  } else {
    pair.cnn = select_device(cnn_selector.empty() ? solver_selector : cnn_selector);
    pair.solver = select_device(solver_selector.empty() ? cnn_selector : solver_selector);
    // "pocl" for both means one each where PoCL offers its one-core driver twice.
    if (pair.cnn.device == pair.solver.device && pair.cnn.is_cpu && pair.cnn.compute_units < 2) {
      for (const auto& device : list_devices()) {
        if (device.platform == pair.cnn.platform && device.device != pair.cnn.device && device.is_cpu)
          pair.solver = device;
      }
    }
  }
  if (pair.cnn.device == pair.solver.device && pair.cnn.is_cpu) {
    const auto parts = split_in_two(pair.cnn);
    if (parts.size() == 2) {
      pair.cnn = describe(pair.cnn.platform, parts[0]);
      pair.solver = describe(pair.solver.platform, parts[1]);
    }
  }
  return pair;
}

}  // namespace livecap::ocl
