// Kernel bodies for GPUs give the same anywhere.
#pragma once

#include "support/test_device.h"

namespace livecap::test {

// Runs check(device) on every test device with its own kernel bodies; on CPUs once more with those for GPUs, and with
// those for GPUs without double precision.
template <typename Check>
void on_every_device_and_gpu_body(Check&& check) {
  on_every_device([&](ocl::DeviceContext& device) {
    check(device);
    if (!device.is_cpu()) return;
    for (const bool has_double : {true, false}) {
      ocl::DeviceInfo info = device.info();
      info.is_cpu = false;
      info.has_double = has_double;
      ocl::DeviceContext as_gpu(info);
      check(as_gpu);
    }
  });
}

}  // namespace livecap::test
