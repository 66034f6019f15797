// Small networks in ONNX's bytes, with seeded weights: blocks of the segmentation networks people have.
#pragma once

#include <algorithm>
#include <string>

#include "nn/random_graph.h"
#include "support/onnx_writer.h"

namespace livecap::test {

// Adds layers behind one another; `last` is the newest value's name.
class Net : public OnnxWriter {
 public:
  explicit Net(unsigned seed) : rng_(seed) {}

  std::string op(const std::string& type, const std::vector<std::string>& inputs,
                 const std::vector<std::string>& attributes = {}) {
    const std::string out = "v" + std::to_string(n_++);
    node(type, inputs, out, attributes);
    return last = out;
  }
  std::string random(const std::vector<int64_t>& dims, float low = -1, float high = 1) {
    int64_t count = 1;
    for (int64_t n : dims) count *= n;
    const std::string name = "w" + std::to_string(n_++);
    floats(name, dims, random_values(static_cast<size_t>(count), rng_, low, high));
    return name;
  }
  std::string list(const std::vector<int64_t>& values) {
    const std::string name = "i" + std::to_string(n_++);
    integers(name, values);
    return name;
  }
  std::string numbers(const std::vector<int64_t>& dims, const std::vector<float>& values) {
    const std::string name = "c" + std::to_string(n_++);
    floats(name, dims, values);
    return name;
  }
  // k x k, padded so that stride 1 keeps the size.
  std::string conv(const std::string& x, int n_in, int n_out, int k, int stride = 1, int dilation = 1, int group = 1,
                   bool bias = false) {
    std::vector<std::string> inputs = {x, random({n_out, n_in / group, k, k})};
    if (bias) inputs.push_back(random({n_out}));
    const int pad = (k - 1) / 2 * dilation;
    return op("Conv", inputs,
              {onnx_ints("kernel_shape", {k, k}), onnx_ints("strides", {stride, stride}),
               onnx_ints("dilations", {dilation, dilation}), onnx_ints("pads", {pad, pad, pad, pad}),
               onnx_int("group", group)});
  }
  std::string batch_norm(const std::string& x, int n) {
    return op("BatchNormalization", {x, random({n}, 0.5f, 1.5f), random({n}), random({n}), random({n}, 0.5f, 4.0f)},
              {onnx_float("epsilon", 1e-3f), onnx_float("momentum", 0.9f)});
  }
  std::string relu(const std::string& x) { return op("Relu", {x}); }
  // As attributes; OpenCV 4.6 does not know the inputs of opset 11.
  std::string relu6(const std::string& x) { return op("Clip", {x}, {onnx_float("min", 0), onnx_float("max", 6)}); }

  std::string last = "x";

 private:
  std::mt19937 rng_;
  int n_ = 0;
};

inline std::string mobile_net_block(int height = 22, int width = 17) {
  Net net(1);
  const std::string stem = net.relu6(net.batch_norm(net.conv("x", 3, 16, 3, 2), 16));
  const std::string wide = net.relu6(net.batch_norm(net.conv(stem, 16, 48, 1), 48));
  const std::string deep = net.relu6(net.batch_norm(net.conv(wide, 48, 48, 3, 1, 1, 48), 48));
  const std::string narrow = net.batch_norm(net.conv(deep, 48, 16, 1), 16);
  const std::string sum = net.op("Add", {stem, narrow});
  const std::string next = net.relu6(net.batch_norm(net.conv(sum, 16, 48, 1), 48));
  net.batch_norm(net.conv(net.relu6(net.batch_norm(net.conv(next, 48, 48, 5, 2, 1, 48), 48)), 48, 24, 1), 24);
  return net.model({1, 3, height, width}, {net.last});
}

inline std::string res_net_block() {
  Net net(2);
  const std::string stem = net.relu(net.batch_norm(net.conv("x", 3, 20, 7, 2), 20));
  const std::string pooled =
      net.op("MaxPool", {stem},
             {onnx_ints("kernel_shape", {3, 3}), onnx_ints("strides", {2, 2}), onnx_ints("pads", {1, 1, 1, 1})});
  const std::string a = net.relu(net.batch_norm(net.conv(pooled, 20, 32, 3, 2), 32));
  const std::string b = net.batch_norm(net.conv(a, 32, 32, 3), 32);
  const std::string skip = net.batch_norm(net.conv(pooled, 20, 32, 1, 2), 32);
  const std::string sum = net.relu(net.op("Add", {b, skip}));
  const std::string c = net.batch_norm(net.conv(net.relu(net.batch_norm(net.conv(sum, 32, 32, 3), 32)), 32, 32, 3), 32);
  const std::string out = net.relu(net.op("Add", {c, sum}));
  net.op("Flatten", {net.op("GlobalAveragePool", {out})});
  net.op("Gemm", {net.last, net.random({10, 32}), net.random({10})}, {onnx_int("transB", 1)});
  return net.model({1, 3, 33, 26}, {net.last});
}

inline std::string aspp_head(bool argmax) {
  Net net(3);
  std::vector<std::string> branches = {net.relu(net.batch_norm(net.conv("x", 6, 8, 1), 8))};
  for (int dilation : {2, 4}) branches.push_back(net.relu(net.batch_norm(net.conv("x", 6, 8, 3, 1, dilation), 8)));
  const std::string pooled = net.relu(net.conv(net.op("GlobalAveragePool", {"x"}), 6, 8, 1, 1, 1, 1, true));
  branches.push_back(net.op("Resize", {pooled, "", "", net.list({1, 8, 13, 11})},
                            {onnx_text("mode", "linear"), onnx_text("coordinate_transformation_mode", "half_pixel")}));
  const std::string all = net.op("Concat", branches, {onnx_int("axis", 1)});
  const std::string logits = net.conv(net.op("Dropout", {all}), 32, 20, 1, 1, 1, 1, true);
  net.op("Resize", {logits, "", net.numbers({4}, {1, 1, 2, 3})},
         {onnx_text("mode", "linear"), onnx_text("coordinate_transformation_mode", "align_corners")});
  if (argmax) net.op("ArgMax", {net.last}, {onnx_int("axis", 1), onnx_int("keepdims", 0)});
  return net.model({1, 6, 13, 11}, {net.last});
}

}  // namespace livecap::test
