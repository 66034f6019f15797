// CPUs and GPUs run different bodies of some kernels (LC_CPU), CPUs with and without AVX-512 too (LC_VECTOR); all are
// right on any device.
#pragma once

#include "support/test_device.h"

namespace livecap::test {

// Runs check(device) on every test device with its own kernel bodies, on CPUs once more with those of the other number
// of lanes and once with those for GPUs.
template <typename Check>
void on_every_device_and_body(Check&& check) {
  for (const std::string& selector : device_selectors()) {
    ocl::DeviceInfo info = ocl::select_device(selector);
    {
      ocl::DeviceContext device(info);
      check(device);
    }
    if (!info.is_cpu) continue;
    {
      info.cpu_lanes = 24 - info.cpu_lanes;
      ocl::DeviceContext device(info);
      check(device);
    }
    info.is_cpu = false;
    ocl::DeviceContext device(info);
    check(device);
  }
}

}  // namespace livecap::test
