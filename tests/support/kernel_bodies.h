// CPUs and GPUs run different bodies of some kernels (LC_CPU), CPUs with and without AVX-512 too (LC_VECTOR); all are
// right on any device.
#pragma once

#include <gtest/gtest.h>

#include "support/test_device.h"

namespace livecap::test {

// GPUs without double precision take some steps on the host.
enum class Doubles { kAsTheyAre, kAlsoWithout };

// Runs check(device) on every test device with its own kernel bodies, on CPUs once more with those of the other number
// of lanes and with those for GPUs.
template <typename Check>
void on_every_device_and_body(Check&& check, Doubles doubles = Doubles::kAsTheyAre) {
  for (const std::string& selector : device_selectors()) {
    const ocl::DeviceInfo own = ocl::select_device(selector);
    const auto run = [&](const ocl::DeviceInfo& info) {
      ocl::DeviceContext device(info);
      SCOPED_TRACE(info.label() + ", LC_VECTOR " + std::to_string(device.lanes()));
      check(device);
    };
    run(own);
    if (!own.is_cpu) continue;
    ocl::DeviceInfo other = own;
    other.cpu_lanes = 24 - own.cpu_lanes;
    run(other);
    other.is_cpu = false;
    run(other);
    if (doubles == Doubles::kAsTheyAre) continue;
    other.has_double = false;
    run(other);
  }
}

}  // namespace livecap::test
