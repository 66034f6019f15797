#include "nn/memory_plan.h"

#include <algorithm>

#include "base/round_up.h"
#include "nn/op_params.h"

namespace livecap::nn {
namespace {

struct Interval {
  int tensor = -1;
  int first = 0;  // op that writes it
  int last = 0;   // last op that reads it
  int64_t size = 0;
  int64_t offset = -1;
};

// Of offsets and sizes, so that vectors are aligned.
int64_t rounded_up(int64_t n) {
  return static_cast<int64_t>(round_up(static_cast<size_t>(n), 16));
}

}  // namespace

MemoryPlan plan_memory(const Graph& graph) {
  const int n_tensors = static_cast<int>(graph.tensors.size());
  const int end = static_cast<int>(graph.ops.size());
  std::vector<int> root(n_tensors);  // the tensor whose memory is used
  for (int i = 0; i < n_tensors; ++i) root[i] = i;
  std::vector<Interval> of(n_tensors);
  auto read = [&](int index, int when) {
    if (index >= 0 && !graph.tensors[index].is_constant) of[root[index]].last = std::max(of[root[index]].last, when);
  };
  int max_channels = 0;
  for (int index : graph.inputs) of[index] = {index, -1, end, element_count(graph.tensors[index].shape)};
  for (int i = 0; i < end; ++i) {
    const Op& op = graph.ops[i];
    for (int index : op.inputs) read(index, i);
    read(op.residual, i);
    const Shape& in = graph.tensors[op.inputs[0]].shape;
    if (in.size() == 4) max_channels = std::max(max_channels, in[3]);
    if (std::holds_alternative<Reshape>(op.attributes)) {
      root[op.output] = root[op.inputs[0]];
    } else {
      of[op.output] = {op.output, i, i, element_count(graph.tensors[op.output].shape)};
    }
  }
  for (int index : graph.outputs) read(index, end);

  // Largest first, each at the lowest place that is free during its whole life.
  std::vector<Interval*> order;
  for (Interval& interval : of) {
    if (interval.tensor >= 0) order.push_back(&interval);
  }
  std::stable_sort(order.begin(), order.end(), [](const Interval* a, const Interval* b) { return a->size > b->size; });
  const int64_t zeros = rounded_up(max_channels + NN_SLACK);
  MemoryPlan plan;
  plan.size = zeros;
  std::vector<Interval*> placed;  // ascending offset
  for (Interval* interval : order) {
    int64_t at = zeros;
    for (const Interval* other : placed) {
      if (other->last < interval->first || other->first > interval->last) continue;
      if (at + interval->size <= other->offset) break;
      at = std::max(at, rounded_up(other->offset + other->size));
    }
    interval->offset = at;
    plan.size = std::max(plan.size, at + interval->size);
    placed.insert(std::upper_bound(placed.begin(), placed.end(), interval,
                                   [](const Interval* a, const Interval* b) { return a->offset < b->offset; }),
                  interval);
  }
  plan.size += NN_SLACK;
  plan.offsets.assign(n_tensors, -1);
  for (int i = 0; i < n_tensors; ++i) plan.offsets[i] = of[root[i]].offset;
  return plan;
}

}  // namespace livecap::nn
