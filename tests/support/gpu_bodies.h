// Kernels that only GPUs run, on every device that can.
#pragma once

#include "support/test_device.h"

namespace livecap::test {

// Every device with double precision, with the kernel bodies for GPUs; a CPU as `units` units: the groups of more than
// one do not wait for each other there.
template <typename Check>
void on_every_gpu_body(Check&& check, int units = 1) {
  on_every_device([&](ocl::DeviceContext& device) {
    ocl::DeviceInfo info = device.info();
    if (!info.has_double) return;
    if (info.is_cpu) info.compute_units = units;
    info.is_cpu = false;
    ocl::DeviceContext as_gpu(info);
    check(as_gpu);
  });
}

}  // namespace livecap::test
