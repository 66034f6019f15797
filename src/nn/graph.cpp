#include "nn/graph.h"

#include <limits>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap::nn {
namespace {

constexpr int kMaxSide = 1 << 20;

[[noreturn]] void fail(const Graph& graph, const Op& op, const std::string& what) {
  throw IoError(graph.name + ": operator " + op_name(op) +
                (op.output >= 0 && op.output < int(graph.tensors.size())
                     ? " (output \"" + graph.tensors[op.output].name + "\")"
                     : "") +
                ": " + what);
}

const Tensor* input_or_null(const Graph& graph, const Op& op, size_t position) {
  if (position >= op.inputs.size() || op.inputs[position] < 0) return nullptr;
  if (op.inputs[position] >= int(graph.tensors.size()))
    fail(graph, op, format("input %zu is tensor %d of %zu", position, op.inputs[position], graph.tensors.size()));
  return &graph.tensors[op.inputs[position]];
}

const Tensor& input(const Graph& graph, const Op& op, size_t position) {
  const Tensor* tensor = input_or_null(graph, op, position);
  if (!tensor) fail(graph, op, format("input %zu is missing", position));
  return *tensor;
}

const Tensor& image_input(const Graph& graph, const Op& op) {
  const Tensor& x = input(graph, op, 0);
  if (x.shape.size() != 4 || x.shape[0] != 1)
    fail(graph, op, "input shape " + to_string(x.shape) + " must be [1,height,width,channels]");
  return x;
}

int window_outputs(const Graph& graph, const Op& op, int size, int before, int after, int kernel, int dilation,
                   int stride) {
  const bool sane = kernel >= 1 && kernel <= kMaxSide && dilation >= 1 && dilation <= kMaxSide && stride >= 1 &&
                    stride <= kMaxSide && before >= 0 && after >= 0 && before <= kMaxSide && after <= kMaxSide;
  if (!sane)
    fail(graph, op,
         format("kernel %d, stride %d, dilation %d or padding %d,%d is out of range", kernel, stride, dilation, before,
                after));
  const int64_t reach = int64_t(kernel - 1) * dilation + 1;
  const int64_t space = int64_t(size) + before + after - reach;
  if (space < 0) fail(graph, op, format("kernel of %lld does not fit into %d", static_cast<long long>(reach), size));
  // A window entirely inside the padding would read nothing.
  if (before >= reach || after >= reach)
    fail(graph, op,
         format("padding %d,%d is not smaller than the kernel %lld", before, after, static_cast<long long>(reach)));
  return static_cast<int>(space / stride) + 1;
}

Shape window_shape(const Graph& graph, const Op& op, const Shape& x, const Window& w, int kernel_h, int kernel_w,
                   int channels) {
  return {1, window_outputs(graph, op, x[1], w.pad_top, w.pad_bottom, kernel_h, w.dilation_h, w.stride_h),
          window_outputs(graph, op, x[2], w.pad_left, w.pad_right, kernel_w, w.dilation_w, w.stride_w), channels};
}

const Tensor& weights_input(const Graph& graph, const Op& op) {
  const Tensor& weights = input(graph, op, 1);
  if (!weights.is_constant) fail(graph, op, "weights are not constant");
  if (weights.shape.size() != 4)
    fail(graph, op, "weight shape " + to_string(weights.shape) + " must have 4 dimensions");
  return weights;
}

void check_bias(const Graph& graph, const Op& op, int channels) {
  const Tensor* bias = input_or_null(graph, op, 2);
  if (!bias) return;
  if (!bias->is_constant || element_count(bias->shape) != channels)
    fail(graph, op,
         format("bias of shape %s must be a constant of %d values", to_string(bias->shape).c_str(), channels));
}

Shape infer(const Graph& graph, const Op& op, const Conv2d& conv) {
  const Tensor& x = image_input(graph, op);
  const Tensor& weights = weights_input(graph, op);
  if (weights.shape[3] != x.shape[3])
    fail(graph, op,
         format("weights for %d input channels on an input of %d (grouped convolutions are not supported)",
                weights.shape[3], x.shape[3]));
  check_bias(graph, op, weights.shape[0]);
  return window_shape(graph, op, x.shape, conv.window, weights.shape[1], weights.shape[2], weights.shape[0]);
}

Shape infer(const Graph& graph, const Op& op, const DepthwiseConv2d& conv) {
  const Tensor& x = image_input(graph, op);
  const Tensor& weights = weights_input(graph, op);
  if (weights.shape[0] != 1 || weights.shape[3] != x.shape[3])
    fail(graph, op,
         "weight shape " + to_string(weights.shape) + format(" must be [1,kh,kw,%d] (depth multiplier 1)", x.shape[3]));
  check_bias(graph, op, x.shape[3]);
  return window_shape(graph, op, x.shape, conv.window, weights.shape[1], weights.shape[2], x.shape[3]);
}

Shape infer_pair(const Graph& graph, const Op& op) {
  const Tensor& a = input(graph, op, 0);
  const Tensor& b = input(graph, op, 1);
  if (a.shape != b.shape)
    fail(graph, op,
         "inputs of shapes " + to_string(a.shape) + " and " + to_string(b.shape) + " must be equal (no broadcasting)");
  if (a.is_constant || b.is_constant) fail(graph, op, "a constant input is not supported");
  return a.shape;
}

Shape infer(const Graph& graph, const Op& op, const Add&) {
  return infer_pair(graph, op);
}

Shape infer(const Graph& graph, const Op& op, const Mul&) {
  return infer_pair(graph, op);
}

Shape infer(const Graph& graph, const Op& op, const Concat&) {
  Shape shape = image_input(graph, op).shape;
  for (size_t i = 1; i < op.inputs.size(); ++i) {
    const Tensor& x = input(graph, op, i);
    if (x.is_constant) fail(graph, op, "a constant input is not supported");
    if (x.shape.size() != 4 || x.shape[0] != 1 || x.shape[1] != shape[1] || x.shape[2] != shape[2])
      fail(graph, op, "input shape " + to_string(x.shape) + format(" must be [1,%d,%d,channels]", shape[1], shape[2]));
    if (x.shape[3] > kMaxSide || shape[3] > kMaxSide) fail(graph, op, "too many channels");
    shape[3] += x.shape[3];
  }
  return shape;
}

template <typename Pool>
Shape infer_pool(const Graph& graph, const Op& op, const Pool& pool) {
  const Tensor& x = image_input(graph, op);
  if (pool.window.dilation_h != 1 || pool.window.dilation_w != 1) fail(graph, op, "dilation is not supported");
  return window_shape(graph, op, x.shape, pool.window, pool.kernel_h, pool.kernel_w, x.shape[3]);
}

Shape infer(const Graph& graph, const Op& op, const MaxPool2d& pool) {
  return infer_pool(graph, op, pool);
}

Shape infer(const Graph& graph, const Op& op, const AveragePool2d& pool) {
  return infer_pool(graph, op, pool);
}

Shape infer(const Graph& graph, const Op& op, const Pad& pad) {
  Shape shape = image_input(graph, op).shape;
  const int* amounts[3] = {pad.height, pad.width, pad.channels};
  for (int d = 0; d < 3; ++d) {
    const int before = amounts[d][0], after = amounts[d][1];
    if (before < 0 || after < 0 || before > kMaxSide || after > kMaxSide)
      fail(graph, op, format("padding %d,%d is out of range", before, after));
    shape[d + 1] += before + after;
  }
  return shape;
}

template <typename Resize>
Shape infer_resize(const Graph& graph, const Op& op, const Resize& resize) {
  const Tensor& x = image_input(graph, op);
  if (resize.height < 1 || resize.width < 1 || resize.height > kMaxSide || resize.width > kMaxSide)
    fail(graph, op, format("size %dx%d is out of range", resize.width, resize.height));
  return {1, resize.height, resize.width, x.shape[3]};
}

Shape infer(const Graph& graph, const Op& op, const ResizeBilinear& resize) {
  return infer_resize(graph, op, resize);
}

Shape infer(const Graph& graph, const Op& op, const ResizeNearest& resize) {
  // Twice the product of the sizes is computed in 32 bits.
  const Shape shape = infer_resize(graph, op, resize);
  const Shape& x = graph.tensors[op.inputs[0]].shape;
  for (int axis : {1, 2}) {
    if (int64_t(x[axis] + 1) * (shape[axis] + 1) > (1 << 28)) fail(graph, op, "the image is too large");
  }
  return shape;
}

Shape infer(const Graph& graph, const Op& op, const Reshape& reshape) {
  const Tensor& x = input(graph, op, 0);
  for (int n : reshape.shape) {
    if (n < 1 || n > kMaxElements) fail(graph, op, "shape " + to_string(reshape.shape) + " is out of range");
  }
  if (element_count(reshape.shape) != element_count(x.shape))
    fail(graph, op, "shape " + to_string(x.shape) + " cannot become " + to_string(reshape.shape));
  return reshape.shape;
}

Shape infer(const Graph& graph, const Op& op, const Logistic&) {
  return input(graph, op, 0).shape;
}

Shape infer(const Graph& graph, const Op& op, const Clamp&) {
  return input(graph, op, 0).shape;
}

Shape infer(const Graph& graph, const Op& op, const LeakyRelu&) {
  return input(graph, op, 0).shape;
}

Shape infer(const Graph& graph, const Op& op, const HardSigmoid&) {
  return input(graph, op, 0).shape;
}

Shape infer(const Graph& graph, const Op& op, const Softmax&) {
  return image_input(graph, op).shape;
}

Shape infer(const Graph& graph, const Op& op, const ArgMax&) {
  const Shape& x = image_input(graph, op).shape;
  return {1, x[1], x[2], 1};
}

}  // namespace

ClampRange clamp_range(Activation activation) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  switch (activation) {
    case Activation::kRelu:
      return {0, kInfinity};
    case Activation::kRelu6:
      return {0, 6};
    case Activation::kNone:
      break;
  }
  return {-kInfinity, kInfinity};
}

const char* op_name(const Op& op) {
  constexpr const char* kNames[] = {"CONV_2D",
                                    "DEPTHWISE_CONV_2D",
                                    "ADD",
                                    "MAX_POOL_2D",
                                    "PAD",
                                    "RESIZE_BILINEAR",
                                    "RESHAPE",
                                    "LOGISTIC",
                                    "AVERAGE_POOL_2D",
                                    "RESIZE_NEAREST",
                                    "MUL",
                                    "CONCATENATION",
                                    "CLAMP",
                                    "LEAKY_RELU",
                                    "HARD_SIGMOID",
                                    "SOFTMAX",
                                    "ARG_MAX"};
  static_assert(std::size(kNames) == std::variant_size_v<Attributes>);
  return kNames[op.attributes.index()];
}

int64_t element_count(const Shape& shape) {
  int64_t count = 1;
  for (int n : shape) {
    if (n < 1 || count > kMaxElements) return std::numeric_limits<int64_t>::max();
    count *= n;
  }
  return count;
}

std::string to_string(const Shape& shape) {
  std::string text = "[";
  for (size_t i = 0; i < shape.size(); ++i) {
    if (i) text += ',';
    text += std::to_string(shape[i]);
  }
  text += ']';
  return text;
}

Shape infer_shape(const Graph& graph, const Op& op) {
  return std::visit([&](const auto& attributes) { return infer(graph, op, attributes); }, op.attributes);
}

void validate(const Graph& graph) {
  const int n_tensors = static_cast<int>(graph.tensors.size());
  std::vector<char> available(n_tensors, 0);
  for (const Tensor& tensor : graph.tensors) {
    if (tensor.shape.size() > 4 || element_count(tensor.shape) > kMaxElements)
      throw IoError(graph.name + ": tensor \"" + tensor.name + "\": shape " + to_string(tensor.shape) +
                    " must have at most 4 dimensions, all positive, and 2^28 elements");
    if (tensor.is_constant) {
      if (int64_t(tensor.values.size()) != element_count(tensor.shape))
        throw IoError(graph.name + ": tensor \"" + tensor.name +
                      format("\": holds %zu values, shape ", tensor.values.size()) + to_string(tensor.shape));
      available[&tensor - graph.tensors.data()] = 1;
    }
  }
  for (int index : graph.inputs) {
    if (index < 0 || index >= n_tensors || available[index])
      throw IoError(graph.name + format(": graph input %d is not a tensor that can be fed", index));
    available[index] = 1;
  }
  for (const Op& op : graph.ops) {
    for (int index : op.inputs) {
      if (index < -1 || index >= n_tensors) fail(graph, op, format("input tensor %d of %d", index, n_tensors));
      if (index >= 0 && !available[index])
        fail(graph, op, "input \"" + graph.tensors[index].name + "\" is used before it is computed");
    }
    if (op.residual >= n_tensors || op.residual < -1)
      fail(graph, op, format("residual tensor %d of %d", op.residual, n_tensors));
    if (op.residual >= 0 && (!available[op.residual] || graph.tensors[op.residual].is_constant))
      fail(graph, op, "residual is used before it is computed");
    if (op.output < 0 || op.output >= n_tensors)
      fail(graph, op, format("output tensor %d of %d", op.output, n_tensors));
    if (available[op.output]) fail(graph, op, "writes a tensor that already has a value");
    const Shape shape = infer_shape(graph, op);
    if (shape != graph.tensors[op.output].shape)
      fail(graph, op,
           "output shape " + to_string(graph.tensors[op.output].shape) + " is stated, " + to_string(shape) +
               " follows from its inputs");
    if (op.residual >= 0 && graph.tensors[op.residual].shape != shape)
      fail(graph, op,
           "residual of shape " + to_string(graph.tensors[op.residual].shape) + " must have shape " + to_string(shape));
    if (input(graph, op, 0).is_constant) fail(graph, op, "a constant input is not supported");
    available[op.output] = 1;
  }
  if (graph.inputs.empty() || graph.outputs.empty())
    throw IoError(graph.name + ": the graph needs at least one input and one output");
  for (int index : graph.outputs) {
    if (index < 0 || index >= n_tensors || !available[index])
      throw IoError(graph.name + format(": graph output %d is never computed", index));
    if (graph.tensors[index].is_constant)
      throw IoError(graph.name + ": graph output \"" + graph.tensors[index].name + "\" is a constant");
  }
}

int64_t multiply_add_count(const Graph& graph) {
  int64_t count = 0;
  for (const Op& op : graph.ops) {
    if (!std::holds_alternative<Conv2d>(op.attributes) && !std::holds_alternative<DepthwiseConv2d>(op.attributes))
      continue;
    const Shape& y = graph.tensors[op.output].shape;
    const Shape& w = graph.tensors[op.inputs[1]].shape;
    count += int64_t(y[1]) * y[2] * element_count(w);
  }
  return count;
}

}  // namespace livecap::nn
