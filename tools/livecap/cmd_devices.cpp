// livecap devices: what OpenCL offers, which two devices a capture would take, and a known-answer test of every kernel
// on every device.
#include <cstdio>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "acquire/hull.h"
#include "actor/skinner.h"
#include "base/joined.h"
#include "base/log.h"
#include "base/text.h"
#include "cloth/cloth_simulation.h"
#include "command.h"
#include "detect/self_test.h"
#include "image/self_test.h"
#include "livecap/error.h"
#include "match/texture_matcher.h"
#include "nn/executor.h"
#include "ocl/context.h"
#include "ocl/device.h"
#include "pose/pose_solver.h"
#include "progress.h"
#include "raster/self_test.h"
#include "solve/term_check.h"
#include "standard_output.h"
#include "surface/surface_solver.h"

namespace livecap::tools {
namespace {

struct DevicesOptions {
  bool no_test = false;
};

using SelfTest = std::function<std::vector<ocl::SelfTestResult>(ocl::DeviceContext&)>;

// Every room that has kernels.
const std::vector<std::pair<const char*, SelfTest>>& self_tests() {
  static const std::vector<std::pair<const char*, SelfTest>> tests = {
      {"actor", skinner_self_test},         {"image", image_self_test},
      {"raster", raster_self_test},         {"nn", nn::nn_self_test},
      {"solve", solve_self_test},           {"pose", pose_self_test},
      {"surface", surface_self_test},       {"acquire", acquire::acquire_self_test},
      {"match", match_self_test},           {"cloth", cloth_self_test},
      {"detect", detect::detect_self_test},
  };
  return tests;
}

// selectors: what --cnn-device and --solver-device call it.
void print_device(int index, const ocl::DeviceInfo& device, const std::vector<std::string>& selectors) {
  std::printf("[%d] %s\n", index, device.label().c_str());
  std::printf("    selected by     %s\n", joined(selectors).c_str());
  std::printf("    type            %s\n", device.is_gpu ? "GPU" : device.is_cpu ? "CPU" : "other");
  std::printf("    driver          %s (%s)\n", device.driver_version.c_str(), device.platform_version.c_str());
  std::printf("    compute units   %u\n", device.compute_units);
  std::printf("    global memory   %llu MiB\n", static_cast<unsigned long long>(device.global_memory_bytes >> 20));
  std::printf("    local memory    %llu KiB\n", static_cast<unsigned long long>(device.local_memory_bytes >> 10));
  std::printf("    work-group      %zu\n", device.max_work_group_size);
}

// Number of kernels that failed.
int run_self_tests(const ocl::DeviceInfo& info) {
  int failed = 0;
  std::unique_ptr<ocl::DeviceContext> device;
  try {
    device = std::make_unique<ocl::DeviceContext>(info);
  } catch (const Error& error) {
    std::printf("    FAILED  context: %s\n", error.what());
    return 1;
  }
  for (const auto& [room, test] : self_tests()) {
    try {
      for (const ocl::SelfTestResult& result : test(*device)) {
        const bool named = result.kernel.find('/') != std::string::npos;
        std::printf("    %-7s %s%s%s%s%s\n", result.ok ? "ok" : "FAILED", named ? "" : room, named ? "" : "/",
                    result.kernel.c_str(), result.detail.empty() ? "" : ": ", result.detail.c_str());
        failed += !result.ok;
      }
    } catch (const std::exception& error) {
      if (interrupted()) break;  // it also reaches the compiler that a driver has started
      std::printf("    FAILED  %s: %s\n", room, error.what());
      ++failed;
    }
    if (interrupted() || !is_heard()) break;
  }
  return failed;
}

int run(const DevicesOptions& options) {
  catch_interrupt();
  const std::vector<ocl::DeviceInfo> devices = ocl::list_devices();
  ocl::require_any(devices);
  int failed = 0;
  int index = 0;
  for (const ocl::DeviceInfo& device : devices) {
    print_device(index++, device, ocl::device_selectors(devices, device));
    if (!options.no_test) failed += run_self_tests(device);
    if (interrupted()) throw Error("interrupted");
    if (!is_heard()) return kExitOk;  // main() tells why
  }
  const ocl::DevicePair pair = ocl::select_device_pair("", "");
  std::printf("default: network on %s, solver on %s\n", pair.cnn.label().c_str(), pair.solver.label().c_str());
  if (failed == 0) return kExitOk;
  log_error(format("%d self-test(s) failed", failed));
  return kExitRunFailed;
}

}  // namespace

void add_devices_command(CLI::App& app, Action& action) {
  auto options = std::make_shared<DevicesOptions>();
  CLI::App* command = app.add_subcommand("devices", "list OpenCL devices and test every kernel on each");
  command->add_flag("--no-test", options->no_test, "only list");
  command->callback([options, &action] { action = [options] { return run(*options); }; });
}

}  // namespace livecap::tools
