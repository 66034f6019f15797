// A network that an importer accepts must be one that can be planned and run.
#pragma once

#include "fuzz/fuzz.h"
#include "nn/memory_plan.h"
#include "nn/optimize.h"
#include "nn/reference.h"

namespace livecap::fuzz {

inline void run_network(const nn::Graph& graph) {
  constexpr int64_t kFewNumbers = 1 << 16;  // larger ones are not run, which takes long
  nn::validate(graph);
  const nn::Graph fused = nn::fuse(nn::prune(graph, graph.outputs));
  nn::plan_memory(fused);
  int64_t total = nn::multiply_add_count(graph);
  for (const nn::Tensor& tensor : graph.tensors) {
    total += nn::element_count(tensor.shape);
    if (total > kFewNumbers) return;
  }
  for (const nn::Graph& each : {graph, fused}) {
    if (each.inputs.size() != 1) return;
    const std::vector<float> input(nn::element_count(each.tensors[each.inputs[0]].shape), 0.5f);
    const std::vector<std::vector<float>> values = nn::reference_run(each, input);
    for (int output : each.outputs)
      require(static_cast<int64_t>(values[output].size()) == nn::element_count(each.tensors[output].shape),
              "outputs of the stated shape");
  }
}

}  // namespace livecap::fuzz
