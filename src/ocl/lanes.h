// Kernels that take a vector of rows a work-item on CPUs and one row on GPUs (kernels/shared/lanes.h).
#pragma once

#include <cstddef>

#include "base/round_up.h"

namespace livecap::ocl {

// Work-items for n rows, `lanes` each (DeviceContext::lanes).
constexpr size_t lane_items(size_t n, int lanes) {
  return round_up(n, size_t(lanes)) / size_t(lanes);
}

}  // namespace livecap::ocl
