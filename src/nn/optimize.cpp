#include "nn/optimize.h"

#include <algorithm>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap::nn {
namespace {

// How often each tensor is read; being a graph output counts.
std::vector<int> use_counts(const Graph& graph) {
  std::vector<int> uses(graph.tensors.size(), 0);
  for (const Op& op : graph.ops) {
    for (int index : op.inputs) {
      if (index >= 0) ++uses[index];
    }
    if (op.residual >= 0) ++uses[op.residual];
  }
  for (int index : graph.outputs) ++uses[index];
  return uses;
}

// Index of the op that computes each tensor, or -1.
std::vector<int> producers(const Graph& graph) {
  std::vector<int> result(graph.tensors.size(), -1);
  for (size_t i = 0; i < graph.ops.size(); ++i) result[graph.ops[i].output] = static_cast<int>(i);
  return result;
}

Window* convolution_window(Op& op) {
  if (auto* conv = std::get_if<Conv2d>(&op.attributes)) return &conv->window;
  if (auto* conv = std::get_if<DepthwiseConv2d>(&op.attributes)) return &conv->window;
  return nullptr;
}

void remove_marked(Graph& graph, const std::vector<char>& removed) {
  size_t kept = 0;
  for (size_t i = 0; i < graph.ops.size(); ++i) {
    if (removed[i]) continue;
    if (kept != i) graph.ops[kept] = std::move(graph.ops[i]);
    ++kept;
  }
  graph.ops.resize(kept);
}

// The window with the padding of `pad` added, if the result is one that graphs allow.
bool widen(const Graph& graph, const Op& op, const Pad& pad, Window& window) {
  const Shape& kernel = graph.tensors[op.inputs[1]].shape;
  window.pad_top += pad.height[0];
  window.pad_bottom += pad.height[1];
  window.pad_left += pad.width[0];
  window.pad_right += pad.width[1];
  const int reach_h = (kernel[1] - 1) * window.dilation_h + 1;
  const int reach_w = (kernel[2] - 1) * window.dilation_w + 1;
  return std::max(window.pad_top, window.pad_bottom) < reach_h && std::max(window.pad_left, window.pad_right) < reach_w;
}

void fuse_pads(Graph& graph) {
  std::vector<char> removed(graph.ops.size(), 0);
  std::vector<int> uses = use_counts(graph);
  for (size_t i = 0; i < graph.ops.size(); ++i) {
    const Pad* pad = std::get_if<Pad>(&graph.ops[i].attributes);
    if (!pad || pad->channels[0] || pad->channels[1] || graph.ops[i].residual >= 0 ||
        graph.ops[i].activation != Activation::kNone)
      continue;
    const int padded = graph.ops[i].output;
    std::vector<Op*> readers;
    int foldable_uses = 0;
    for (Op& op : graph.ops) {
      Window* window = convolution_window(op);
      if (!window || op.inputs[0] != padded) continue;
      Window widened = *window;
      if (!widen(graph, op, *pad, widened)) continue;
      readers.push_back(&op);
      ++foldable_uses;
    }
    if (foldable_uses == 0 || foldable_uses != uses[padded]) continue;
    for (Op* op : readers) {
      widen(graph, *op, *pad, *convolution_window(*op));
      op->inputs[0] = graph.ops[i].inputs[0];
    }
    removed[i] = 1;
  }
  remove_marked(graph, removed);
}

bool takes_residual(const Op& op) {
  return std::holds_alternative<Conv2d>(op.attributes) || std::holds_alternative<DepthwiseConv2d>(op.attributes) ||
         std::holds_alternative<ResizeBilinear>(op.attributes);
}

void fuse_adds(Graph& graph) {
  std::vector<char> removed(graph.ops.size(), 0);
  const std::vector<int> uses = use_counts(graph);
  std::vector<int> producer = producers(graph);
  for (size_t i = 0; i < graph.ops.size(); ++i) {
    const Op add = graph.ops[i];
    if (!std::holds_alternative<Add>(add.attributes) || add.residual >= 0 || add.inputs[0] == add.inputs[1]) continue;
    int chosen = -1;  // which of the two inputs is computed by an op that can take the other as its residual
    for (int side = 0; side < 2; ++side) {
      const int index = producer[add.inputs[side]];
      if (index < 0 || uses[add.inputs[side]] != 1) continue;
      const Op& op = graph.ops[index];
      if (!takes_residual(op) || op.residual >= 0 || op.activation != Activation::kNone) continue;
      if (chosen < 0 || std::holds_alternative<Conv2d>(op.attributes)) chosen = side;
    }
    if (chosen < 0) continue;
    // The fused op runs where the ADD ran, when its residual is certainly there.
    const int index = producer[add.inputs[chosen]];
    Op fused = graph.ops[index];
    fused.residual = add.inputs[1 - chosen];
    fused.activation = add.activation;
    fused.output = add.output;
    graph.ops[i] = std::move(fused);
    producer[add.output] = static_cast<int>(i);
    removed[index] = 1;
  }
  remove_marked(graph, removed);
}

}  // namespace

Graph prune(const Graph& graph, const std::vector<int>& outputs) {
  std::vector<char> needed(graph.tensors.size(), 0);
  for (int index : outputs) {
    if (index < 0 || index >= int(graph.tensors.size()) || graph.tensors[index].is_constant)
      throw LogicError(format("nn::prune: output %d is not a computed tensor of ", index) + graph.name);
    needed[index] = 1;
  }
  std::vector<char> removed(graph.ops.size(), 0);
  for (size_t i = graph.ops.size(); i-- > 0;) {
    const Op& op = graph.ops[i];
    removed[i] = !needed[op.output];
    if (removed[i]) continue;
    for (int index : op.inputs) {
      if (index >= 0) needed[index] = 1;
    }
    if (op.residual >= 0) needed[op.residual] = 1;
  }
  Graph result = graph;
  remove_marked(result, removed);
  result.outputs = outputs;
  for (size_t i = 0; i < result.tensors.size(); ++i) {
    if (needed[i]) continue;
    result.tensors[i].is_constant = false;
    result.tensors[i].values = {};
  }
  return result;
}

Graph fuse(const Graph& graph) {
  Graph result = graph;
  fuse_pads(result);
  fuse_adds(result);
  return result;
}

}  // namespace livecap::nn
