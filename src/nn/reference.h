// Every operator as plain loops: what the device kernels are checked against. Slow on purpose.
#pragma once

#include <vector>

#include "nn/graph.h"

namespace livecap::nn {

// Output of one op. values[i]: what tensor i holds (constants are taken from the graph). Sums are in double.
std::vector<float> reference_op(const Graph& graph, const Op& op, const std::vector<std::vector<float>>& values);

// Runs the graph on its single input; the result holds every tensor's values.
std::vector<std::vector<float>> reference_run(const Graph& graph, const std::vector<float>& input);

}  // namespace livecap::nn
