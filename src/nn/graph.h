// The network as a graph of tensors and operators: what every importer fills (.tflite, .onnx) and every
// executor reads. Activations are NHWC float32 with batch 1; padding is explicit, so no importer's convention leaks in.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "livecap/error.h"

namespace livecap::nn {

// A name from a network's file as messages show it, of at most 80 bytes.
inline std::string printable(std::string_view name) {
  return one_line(name, 80);
}

using Shape = std::vector<int>;  // up to 4 dimensions, all >= 1

enum class Activation { kNone, kRelu, kRelu6 };

// The bounds an activation clamps to; none = (-inf, inf).
struct ClampRange {
  float low;
  float high;
};
ClampRange clamp_range(Activation activation);

// A window that slides over an image. Rows and columns outside the image count as zero (convolutions) or are left out
// (pooling). Bottom and right padding follow from the output size.
struct Window {
  int stride_h = 1;
  int stride_w = 1;
  int dilation_h = 1;
  int dilation_w = 1;
  int pad_top = 0;
  int pad_left = 0;
  int pad_bottom = 0;
  int pad_right = 0;
};

// inputs: x [1,H,W,Cin], weights [Cout,KH,KW,Cin], bias [Cout] or -1.
struct Conv2d {
  Window window;
};

// inputs: x [1,H,W,C], weights [1,KH,KW,C], bias [C] or -1.
struct DepthwiseConv2d {
  Window window;
};

// inputs: a, b of the same shape.
struct Add {};

// inputs: x [1,H,W,C].
struct MaxPool2d {
  Window window;
  int kernel_h = 1;
  int kernel_w = 1;
};

// inputs: x [1,H,W,C]. The mean of a window's pixels inside the image, or with count_padding the sum over its area.
struct AveragePool2d {
  Window window;
  int kernel_h = 1;
  int kernel_w = 1;
  bool count_padding = false;
};

// inputs: x [1,H,W,C]. Zeros around it; entries are {before, after}.
struct Pad {
  int height[2] = {0, 0};
  int width[2] = {0, 0};
  int channels[2] = {0, 0};
};

// inputs: x [1,H,W,C].
struct ResizeBilinear {
  int height = 0;
  int width = 0;
  bool align_corners = false;
  bool half_pixel_centers = false;
};

// inputs: x [1,H,W,C]. One source pixel for each: the position of ResizeBilinear, rounded.
struct ResizeNearest {
  enum class Rounding { kFloor, kCeil, kNearestFloor, kNearestCeil };  // the last two: where halves go
  int height = 0;
  int width = 0;
  bool align_corners = false;
  bool half_pixel_centers = false;
  Rounding rounding = Rounding::kFloor;
};

// inputs: x; the same elements under another shape.
struct Reshape {
  Shape shape;
};

// inputs: x of any shape. 1 / (1 + exp(-x)).
struct Logistic {};

// inputs: a, b of the same shape.
struct Mul {};

// inputs: any number of [1,H,W,*]: their channels one after another.
struct Concat {};

// inputs: x of any shape. Its activation alone.
struct Clamp {};

// inputs: x of any shape. x > 0 ? x : slope * x.
struct LeakyRelu {
  float slope = 0.01f;
};

// inputs: x of any shape. min(max(slope * x + offset, 0), 1), times x when `swish`.
struct HardSigmoid {
  float slope = 1.0f / 6;
  float offset = 0.5f;
  bool swish = false;
};

// inputs: x [1,H,W,C]. exp(x) over its sum over the channels.
struct Softmax {};

// inputs: x [1,H,W,C]. [1,H,W,1]: the first channel with the largest value.
struct ArgMax {};

using Attributes =
    std::variant<Conv2d, DepthwiseConv2d, Add, MaxPool2d, Pad, ResizeBilinear, Reshape, Logistic, AveragePool2d,
                 ResizeNearest, Mul, Concat, Clamp, LeakyRelu, HardSigmoid, Softmax, ArgMax>;

struct Tensor {
  std::string name;
  Shape shape;
  bool is_constant = false;
  std::vector<float> values;  // constants only: [element_count(shape)]
};

// output = activation(attributes(inputs) + residual).
struct Op {
  Attributes attributes;
  std::vector<int> inputs;  // tensor indices; -1 = an optional input that is not there
  int output = -1;          // tensor index
  Activation activation = Activation::kNone;
  int residual = -1;  // tensor index of the output's shape, or -1; set by fusion only (nn/optimize.h)
};

struct Graph {
  std::string name;  // the file it came from, for messages
  std::vector<Tensor> tensors;
  std::vector<Op> ops;       // in an order in which they can run
  std::vector<int> inputs;   // tensor indices
  std::vector<int> outputs;  // tensor indices
};

// "CONV_2D", ...
const char* op_name(const Op& op);

// The most numbers that a tensor may have, and all constants of a graph together: a file can name the same bytes again
// and again.
inline constexpr int64_t kMaxElements = int64_t(1) << 28;

int64_t element_count(const Shape& shape);
std::string to_string(const Shape& shape);  // "[1,256,256,3]"

// The output shape that the op's inputs and attributes imply. Throws IoError (one line: graph name, operator, what is
// wrong) when they do not fit together.
Shape infer_shape(const Graph& graph, const Op& op);

// Checks everything an executor relies on: indices, one producer per tensor, order, constants' sizes, inferred shapes
// equal to the stated ones, at most 2^28 elements in a tensor. Throws IoError naming graph, operator and field.
void validate(const Graph& graph);

// Multiply-adds of the convolutions.
int64_t multiply_add_count(const Graph& graph);

}  // namespace livecap::nn
