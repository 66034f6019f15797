// The importer's state and steps; private to onnx_import.cpp (values, sizes, shapes) and onnx_layers.cpp (operators).
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "nn/graph.h"
#include "nn/onnx_constants.h"
#include "nn/onnx_model.h"
#include "nn/onnx_node.h"

namespace livecap::nn {

// What a name of the ONNX graph stands for: a tensor of ours or a constant.
struct OnnxValue {
  int tensor = -1;                     // of the graph, as image [1,H,W,C]; -1 = a constant
  Dims dims;                           // as ONNX counts them: [1,C,H,W], [1,C], ...
  bool channels_last = false;          // dims are [1,H,W,C]: behind a Transpose
  bool shared = false;                 // another name stands for the same tensor and is read as well
  const OnnxTensor* stored = nullptr;  // a constant of the file
  Numbers numbers;                     // a constant that was computed
};

inline constexpr int64_t kMostInWindow = 4096;

// A list attribute of a window: n numbers within least..kMostInWindow.
std::vector<int> sizes(NodeReader& node, const char* name, size_t n, int64_t fallback, int64_t least);

class OnnxImporter {
 public:
  OnnxImporter(const OnnxModel& model, const std::string& name, int height, int width)
      : model_(model), height_(height), width_(width) {
    graph_.name = name;
  }
  Graph run();

 private:
  [[noreturn]] void fail(const std::string& what) const;

  // onnx_import.cpp
  void count_uses();
  void read_constants();
  void read_input();
  void read_outputs();
  void read_node(const OnnxNode& node, size_t index);
  bool fold(NodeReader& node);

  const OnnxValue& value(const NodeReader& node, size_t i) const;
  const OnnxValue& activation(const NodeReader& node, size_t i) const;  // no constant
  const OnnxValue& image(const NodeReader& node, size_t i) const;       // [1,C,H,W]
  const OnnxValue& constant(const NodeReader& node, size_t i) const;
  bool is_constant(const NodeReader& node, size_t i) const { return value(node, i).tensor < 0; }
  std::vector<double> numbers(const NodeReader& node, size_t i) const;  // of a small constant
  std::vector<float> weights(const NodeReader& node, size_t i) const;   // of any constant
  // One number per channel of x, from a constant that has one or n_channels along x's channel axis.
  std::vector<double> per_channel(const NodeReader& node, size_t i, const OnnxValue& x) const;
  const Shape& shape(const OnnxValue& value) const { return graph_.tensors[value.tensor].shape; }
  size_t channel_axis(const NodeReader& node, const OnnxValue& x) const;

  void define(const NodeReader& node, OnnxValue value);
  int add_constant(const NodeReader& node, Shape shape, std::vector<float> values);
  // Keeps the numbers of all constants together within kMaxElements.
  void count_constant(const NodeReader& node, size_t count);
  // Appends an operator; the result is an image [1,C,H,W].
  OnnxValue emit(const NodeReader& node, Attributes attributes, std::vector<int> inputs);
  // The same, with the dimensions of `like`, whose shape the result has.
  OnnxValue emit_like(const NodeReader& node, Attributes attributes, std::vector<int> inputs, const OnnxValue& like);
  // The operator that computes x, when nothing else reads x and it has no activation yet; else null.
  Op* open_producer(const NodeReader& node, size_t i);
  // The same elements under other dimensions.
  void rename(const NodeReader& node, Dims dims);

  // onnx_layers.cpp
  bool read_layer(NodeReader& node);
  bool read_elementwise(NodeReader& node);
  bool read_shape_change(NodeReader& node);
  void convolution(NodeReader& node);
  void transposed_convolution(NodeReader& node);
  // Tensor [1,H*stride_h,W*stride_w,C]: zeros behind each pixel of x.
  int spread(NodeReader& node, int x, int stride_h, int stride_w);
  void matrix_product(NodeReader& node);
  void normalization(NodeReader& node);
  void affine(NodeReader& node, size_t i, const std::vector<double>& factors, const std::vector<double>& offsets);
  void arithmetic(NodeReader& node);
  void activate(NodeReader& node, Activation activation);
  void clip(NodeReader& node);
  void pool(NodeReader& node);
  void global_pool(NodeReader& node);
  void resize(NodeReader& node);
  void pad(NodeReader& node);
  void transpose(NodeReader& node);
  void over_channels(NodeReader& node);
  Window window(NodeReader& node, const Shape& x, int kernel_h, int kernel_w, bool ceil_mode);

  const OnnxModel& model_;
  int height_, width_;
  Graph graph_;
  std::map<std::string_view, OnnxValue> values_;
  std::map<std::string_view, int> uses_;  // by nodes that matter and as outputs
  std::vector<char> needed_;              // per node
  std::map<int, size_t> producers_;       // tensor to op
  int64_t n_constants_ = 0;
};

}  // namespace livecap::nn
