// Kernels that take a vector of rows a work-item on CPUs and one row on GPUs (kernels/shared/lanes.h).
#pragma once

#include <cstddef>

#include "base/round_up.h"

namespace livecap::ocl {

inline constexpr size_t kCpuLanes = 16;  // LANES there

// Work-items for n rows.
constexpr size_t lane_items(size_t n, bool is_cpu) {
  return is_cpu ? round_up(n, kCpuLanes) / kCpuLanes : n;
}

}  // namespace livecap::ocl
