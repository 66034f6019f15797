// Graph rewrites before execution. Each returns a graph with the same results.
#pragma once

#include <string>
#include <vector>

#include "nn/graph.h"

namespace livecap::nn {

// Keeps only what the given outputs (tensor indices) need; they become the graph's outputs, in this order. Throws
// LogicError when one is not a computed tensor.
Graph prune(const Graph& graph, const std::vector<int>& outputs);

// Folds PADs into the windows of the convolutions behind them, and ADDs into the convolution or resize before them
// (as residual, with the ADD's activation). Tensors that are graph outputs stay.
Graph fuse(const Graph& graph);

}  // namespace livecap::nn
