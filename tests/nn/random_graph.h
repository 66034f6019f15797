// One-operator graphs with seeded random weights, for comparing the device with the reference.
#pragma once

#include <random>
#include <utility>
#include <vector>

#include "nn/graph.h"

namespace livecap::test {

inline std::vector<float> random_values(size_t n, std::mt19937& rng, float low = -1, float high = 1) {
  std::uniform_real_distribution<float> uniform(low, high);
  std::vector<float> values(n);
  for (float& v : values) v = uniform(rng);
  return values;
}

inline int add_tensor(nn::Graph& graph, nn::Shape shape) {
  graph.tensors.push_back({"t" + std::to_string(graph.tensors.size()), std::move(shape), false, {}});
  return static_cast<int>(graph.tensors.size()) - 1;
}

inline int add_constant(nn::Graph& graph, nn::Shape shape, std::mt19937& rng) {
  const int index = add_tensor(graph, std::move(shape));
  graph.tensors[index].is_constant = true;
  graph.tensors[index].values = random_values(nn::element_count(graph.tensors[index].shape), rng);
  return index;
}

// Appends the op with the output shape that follows; returns the output tensor.
inline int add_op(nn::Graph& graph, nn::Op op) {
  const nn::Shape shape = nn::infer_shape(graph, op);
  op.output = add_tensor(graph, shape);
  graph.ops.push_back(op);
  return op.output;
}

inline nn::Graph input_graph(int height, int width, int channels) {
  nn::Graph graph;
  graph.name = "test graph";
  graph.inputs = {add_tensor(graph, {1, height, width, channels})};
  return graph;
}

inline int add_conv(nn::Graph& graph, int input, int n_out, int kernel_h, int kernel_w, nn::Window window,
                    nn::Activation activation, std::mt19937& rng, bool bias = true) {
  const int w = add_constant(graph, {n_out, kernel_h, kernel_w, graph.tensors[input].shape[3]}, rng);
  const int b = bias ? add_constant(graph, {n_out}, rng) : -1;
  return add_op(graph, {nn::Conv2d{window}, {input, w, b}, -1, activation, -1});
}

inline int add_depthwise(nn::Graph& graph, int input, int kernel_h, int kernel_w, nn::Window window,
                         nn::Activation activation, std::mt19937& rng) {
  const int channels = graph.tensors[input].shape[3];
  const int w = add_constant(graph, {1, kernel_h, kernel_w, channels}, rng);
  const int b = add_constant(graph, {channels}, rng);
  return add_op(graph, {nn::DepthwiseConv2d{window}, {input, w, b}, -1, activation, -1});
}

}  // namespace livecap::test
