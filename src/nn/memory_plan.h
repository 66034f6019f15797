// Where each activation lives: one arena, tensors that are never alive together may share memory.
#pragma once

#include <cstdint>
#include <vector>

#include "nn/graph.h"

namespace livecap::nn {

struct MemoryPlan {
  std::vector<int64_t> offsets;  // floats, per tensor; -1 for constants and tensors that are not used
  int64_t size = 0;              // floats, with the zeros in front and the slack behind (kernels/nn/op_params.h)
};

// Offsets are multiples of 16 floats. A RESHAPE shares its input's memory. Graph inputs and outputs are alive from
// beginning to end, so that they can be read after the run and written before the next.
MemoryPlan plan_memory(const Graph& graph);

}  // namespace livecap::nn
