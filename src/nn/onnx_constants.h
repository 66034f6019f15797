// Small constants of an ONNX graph and the operators on them. Exporters compute sizes for Resize and Reshape with nodes
// (Shape, Gather, Concat, ...); with a fixed input size they all are constants.
#pragma once

#include <vector>

#include "nn/onnx_node.h"

namespace livecap::nn {

struct Numbers {
  Dims dims;
  std::vector<double> values;
  bool integer = false;
};

// Whether fold_constants knows the operator.
bool is_foldable(std::string_view type);

// The node's output from its inputs; null = an optional one that is not there. Throws IoError naming the node.
Numbers fold_constants(NodeReader& node, const std::vector<const Numbers*>& inputs);

// Of constants that are sizes, axes or indices; NaN is 0.
std::vector<int64_t> integers_of(const std::vector<double>& values);

// `axis` counted from the front; IoError naming the node when it is not below `rank`.
int64_t positive_axis(const NodeReader& node, int64_t axis, size_t rank);

// What Reshape makes of the dimensions, 0 and -1 resolved.
Dims reshaped(const NodeReader& node, const Dims& from, const std::vector<double>& target);

// Squeeze and Unsqueeze. No axes: Squeeze drops all ones.
Dims squeezed(const NodeReader& node, const Dims& from, const std::vector<int64_t>& axes);
Dims unsqueezed(const NodeReader& node, const Dims& from, const std::vector<int64_t>& axes);

}  // namespace livecap::nn
