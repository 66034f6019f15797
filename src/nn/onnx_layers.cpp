// The operators of ONNX (github.com/onnx/onnx, Operators.md) as operators of nn::Graph.
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "nn/onnx_importer.h"

namespace livecap::nn {

std::vector<int> sizes(NodeReader& node, const char* name, size_t n, int64_t fallback, int64_t least) {
  const std::vector<int64_t> given = node.integers(name, std::vector<int64_t>(n, fallback));
  if (given.size() != n) node.fail_attribute(name, format("has %zu numbers, must have %zu", given.size(), n));
  std::vector<int> out;
  for (int64_t v : given) {
    if (v < least || v > kMostInWindow)
      node.fail_attribute(name, format("%lld must be in %lld..%lld", static_cast<long long>(v),
                                       static_cast<long long>(least), static_cast<long long>(kMostInWindow)));
    out.push_back(static_cast<int>(v));
  }
  return out;
}

bool OnnxImporter::read_layer(NodeReader& node) {
  const std::string_view type = node.type();
  if (type == "Conv") {
    convolution(node);
  } else if (type == "ConvTranspose") {
    transposed_convolution(node);
  } else if (type == "Gemm" || type == "MatMul") {
    matrix_product(node);
  } else if (type == "BatchNormalization") {
    normalization(node);
  } else if (type == "MaxPool" || type == "AveragePool") {
    pool(node);
  } else if (type == "GlobalAveragePool" || type == "GlobalMaxPool" || type == "ReduceMean") {
    global_pool(node);
  } else if (type == "Resize" || type == "Upsample") {
    resize(node);
  } else if (type == "Pad") {
    pad(node);
  } else if (type == "Concat") {
    const OnnxValue& first = activation(node, 0);
    const int64_t axis = positive_axis(node, node.integer("axis", 1), first.dims.size());
    if (static_cast<size_t>(axis) != channel_axis(node, first))
      node.fail_attribute("axis", "only the channels can be concatenated");
    std::vector<int> inputs;
    for (size_t i = 0; i < node.node().inputs.size(); ++i) inputs.push_back(image(node, i).tensor);
    define(node, emit(node, Concat{}, inputs));
  } else if (type == "Softmax" || type == "ArgMax") {
    over_channels(node);
  } else {
    return false;
  }
  return true;
}

bool OnnxImporter::read_elementwise(NodeReader& node) {
  const std::string_view type = node.type();
  if (type == "Add" || type == "Sub" || type == "Mul" || type == "Div" || type == "Sum") {
    arithmetic(node);
  } else if (type == "Relu") {
    activate(node, Activation::kRelu);
  } else if (type == "Clip") {
    clip(node);
  } else if (type == "Sigmoid" || type == "LeakyRelu" || type == "HardSigmoid" || type == "HardSwish") {
    const OnnxValue& x = activation(node, 0);
    Attributes attributes = Logistic{};
    if (type == "LeakyRelu") attributes = LeakyRelu{node.real("alpha", 0.01f)};
    if (type == "HardSigmoid") attributes = HardSigmoid{node.real("alpha", 0.2f), node.real("beta", 0.5f), false};
    if (type == "HardSwish") attributes = HardSigmoid{1.0f / 6, 0.5f, true};
    define(node, emit_like(node, attributes, {x.tensor}, x));
  } else {
    return false;
  }
  return true;
}

bool OnnxImporter::read_shape_change(NodeReader& node) {
  const std::string_view type = node.type();
  const auto axes = [&]() -> std::vector<int64_t> {
    if (!node.has_input(1)) return node.integers("axes", {});
    return integers_of(numbers(node, 1));
  };
  if (type == "Identity" || type == "Dropout" || type == "Cast") {
    if (type == "Dropout") {
      node.real("ratio", 0);
      node.integer("seed", 0);
    } else if (type == "Cast") {
      // Labels as integers are floats here, too; whole numbers stay what they are.
      const Op* op = producers_.count(activation(node, 0).tensor)
                         ? &graph_.ops[producers_.at(activation(node, 0).tensor)]
                         : nullptr;
      const int64_t to = node.integer("to", 0);
      if (to != 1 && !(op && std::holds_alternative<ArgMax>(op->attributes)))
        node.fail_attribute(
            "to", format("%lld: only a cast to float, or behind ArgMax, is supported", static_cast<long long>(to)));
    }
    rename(node, activation(node, 0).dims);
  } else if (type == "Transpose") {
    transpose(node);
  } else if (type == "Reshape") {
    node.require("allowzero", 0);
    rename(node, reshaped(node, activation(node, 0).dims, numbers(node, 1)));
  } else if (type == "Flatten") {
    const Dims dims = activation(node, 0).dims;
    const int64_t given = node.integer("axis", 1);
    const int64_t axis = given == static_cast<int64_t>(dims.size()) ? given : positive_axis(node, given, dims.size());
    Dims flat = {1, 1};
    for (size_t i = 0; i < dims.size(); ++i) flat[static_cast<int64_t>(i) >= axis] *= dims[i];
    rename(node, flat);
  } else if (type == "Squeeze") {
    rename(node, squeezed(node, activation(node, 0).dims, axes()));
  } else if (type == "Unsqueeze") {
    rename(node, unsqueezed(node, activation(node, 0).dims, axes()));
  } else {
    return false;
  }
  return true;
}

// Padding: explicit, or so that the output has ceil(size / stride) pixels with the odd one at one side.
Window OnnxImporter::window(NodeReader& node, const Shape& x, int kernel_h, int kernel_w, bool ceil_mode) {
  const std::vector<int> strides = sizes(node, "strides", 2, 1, 1);
  const std::vector<int> dilations = sizes(node, "dilations", 2, 1, 1);
  std::vector<int> pads = sizes(node, "pads", 4, 0, 0);  // top, left, bottom, right
  const std::string rule = node.text("auto_pad", "NOTSET");
  if (rule != "NOTSET" && rule != "SAME_UPPER" && rule != "SAME_LOWER" && rule != "VALID")
    node.fail_attribute("auto_pad", "\"" + rule + "\" must be NOTSET, SAME_UPPER, SAME_LOWER or VALID");
  const int kernel[2] = {kernel_h, kernel_w};
  for (int axis : {0, 1}) {
    const int64_t size = x[axis + 1], stride = strides[axis];
    const int64_t reach = int64_t(kernel[axis] - 1) * dilations[axis] + 1;
    int& before = pads[axis];
    int& after = pads[axis + 2];
    if (rule == "VALID") before = after = 0;
    if (rule == "SAME_UPPER" || rule == "SAME_LOWER") {
      const int64_t outputs = (size + stride - 1) / stride;
      const int64_t total = std::max<int64_t>((outputs - 1) * stride + reach - size, 0);
      before = static_cast<int>(rule == "SAME_UPPER" ? total / 2 : total - total / 2);
      after = static_cast<int>(total - before);
    }
    if (ceil_mode) {  // one window more, if it begins inside the image
      const int64_t space = size + before + after - reach;
      const int64_t outputs = space < 0 ? 0 : (space + stride - 1) / stride + 1;
      if (outputs > 0 && (outputs - 1) * stride < size + before)
        after += static_cast<int>(std::max<int64_t>((outputs - 1) * stride - space, 0));
    }
  }
  return {strides[0], strides[1], dilations[0], dilations[1], pads[0], pads[1], pads[2], pads[3]};
}

void OnnxImporter::convolution(NodeReader& node) {
  const OnnxValue x = image(node, 0);
  const Dims dims = constant(node, 1).dims;
  if (dims.size() != 4 || std::any_of(dims.begin(), dims.end(), [](int64_t n) { return n < 1; }))
    node.fail("weights of shape " + to_string(dims) + " must be [out,in,height,width]: only 2D is supported");
  const int64_t channels = shape(x)[3], groups = node.integer("group", 1);
  const int64_t n_out = dims[0], kh = dims[2], kw = dims[3];
  if (groups < 1 || channels % groups != 0 || n_out % groups != 0)
    node.fail_attribute(
        "group", format("%lld does not divide %lld input and %lld output channels", static_cast<long long>(groups),
                        static_cast<long long>(channels), static_cast<long long>(n_out)));
  if (dims[1] != channels / groups)
    node.fail("weights of shape " + to_string(dims) +
              format(" on %lld channels in %lld groups, must be [out,%lld,height,width]",
                     static_cast<long long>(channels), static_cast<long long>(groups),
                     static_cast<long long>(channels / groups)));
  if (node.integers("kernel_shape", {kh, kw}) != std::vector<int64_t>{kh, kw})
    node.fail_attribute("kernel_shape", "must be that of the weights " + to_string(dims));
  if (kh > kMostInWindow || kw > kMostInWindow) node.fail("weights of shape " + to_string(dims) + " are too large");
  const Window where = window(node, shape(x), static_cast<int>(kh), static_cast<int>(kw), false);
  const std::vector<float> given = weights(node, 1);
  const bool depthwise = groups == channels && n_out == channels && groups > 1;
  // Other groups become a full convolution with zeros between them.
  const int64_t inner = depthwise ? 1 : channels;
  if (n_out * inner > kMaxElements / (kh * kw)) node.fail("the weights are larger than 2^28 numbers");
  std::vector<float> turned(static_cast<size_t>(n_out * inner * kh * kw), 0.0f);
  for (int64_t n = 0; n < n_out; ++n) {
    const int64_t first = depthwise ? 0 : n / (n_out / groups) * dims[1];
    for (int64_t k = 0; k < dims[1]; ++k) {
      for (int64_t tap = 0; tap < kh * kw; ++tap) {
        const int64_t to = depthwise ? tap * channels + n : (n * kh * kw + tap) * channels + first + k;
        turned[to] = given[(n * dims[1] + k) * kh * kw + tap];
      }
    }
  }
  const int h = static_cast<int>(kh), w = static_cast<int>(kw), out = static_cast<int>(n_out);
  const Shape packed = depthwise ? Shape{1, h, w, out} : Shape{out, h, w, static_cast<int>(channels)};
  const int weight = add_constant(node, packed, std::move(turned));
  const int bias = node.has_input(2) ? add_constant(node, {out}, weights(node, 2)) : -1;
  const Attributes attributes = depthwise ? Attributes(DepthwiseConv2d{where}) : Attributes(Conv2d{where});
  define(node, emit(node, attributes, {x.tensor, weight, bias}));
}

// x [1,K] (or an image with its channels last) times a constant [K,N]: a 1x1 convolution.
void OnnxImporter::matrix_product(NodeReader& node) {
  const OnnxValue x = activation(node, 0);
  const bool gemm = node.type() == "Gemm";
  if (gemm) node.require("transA", 0);
  const bool turned = gemm && node.integer("transB", 0) != 0;
  const double alpha = gemm ? node.real("alpha", 1) : 1, beta = gemm ? node.real("beta", 1) : 1;
  const Dims dims = constant(node, 1).dims;
  const int64_t channels = shape(x)[3];
  if (channel_axis(node, x) + 1 != x.dims.size())
    node.fail("input of shape " + to_string(x.dims) + " must end with the channels");
  if (dims.size() != 2 || dims[turned ? 1 : 0] != channels || dims[turned ? 0 : 1] < 1)
    node.fail("weights of shape " + to_string(dims) + format(" on %lld channels", static_cast<long long>(channels)));
  const std::vector<float> given = weights(node, 1);
  const int64_t n_out = dims[turned ? 0 : 1];
  std::vector<float> rows(given.size());
  for (int64_t n = 0; n < n_out; ++n) {
    for (int64_t k = 0; k < channels; ++k)
      rows[n * channels + k] = static_cast<float>(alpha * given[turned ? n * channels + k : k * n_out + n]);
  }
  const int out = static_cast<int>(n_out);
  const int weight = add_constant(node, {out, 1, 1, static_cast<int>(channels)}, std::move(rows));
  int bias = -1;
  if (gemm && node.has_input(2)) {
    std::vector<float> values = weights(node, 2);
    if (values.size() == 1) values.assign(n_out, values[0]);
    for (float& v : values) v = static_cast<float>(beta * v);
    const int n_values = static_cast<int>(values.size());
    bias = add_constant(node, {n_values}, std::move(values));
  }
  OnnxValue y = emit(node, Conv2d{}, {x.tensor, weight, bias});
  y.dims = x.dims;
  y.dims.back() = n_out;
  y.channels_last = x.channels_last;
  define(node, y);
}

void OnnxImporter::normalization(NodeReader& node) {
  const OnnxValue& x = activation(node, 0);
  const double epsilon = node.real("epsilon", 1e-5f);
  node.real("momentum", 0);
  node.require("training_mode", 0);
  node.require("spatial", 1);
  const size_t channels = static_cast<size_t>(shape(x)[3]);
  std::vector<double> parameters[4];  // scale, offset, mean, variance
  for (size_t i = 0; i < 4; ++i) {
    parameters[i] = numbers(node, i + 1);
    if (parameters[i].size() != channels)
      node.fail(format("input %zu has %zu values for %zu channels", i + 1, parameters[i].size(), channels));
  }
  std::vector<double> factors(channels), offsets(channels);
  for (size_t c = 0; c < channels; ++c) {
    if (!(parameters[3][c] + epsilon > 0))
      node.fail(format("variance %g of channel %zu must be positive", parameters[3][c], c));
    factors[c] = parameters[0][c] / std::sqrt(parameters[3][c] + epsilon);
    offsets[c] = parameters[1][c] - parameters[2][c] * factors[c];
  }
  channel_axis(node, x);
  affine(node, 0, factors, offsets);
}

// factor * x + offset per channel: into the convolution before it, else a depthwise one of its own.
void OnnxImporter::affine(NodeReader& node, size_t i, const std::vector<double>& factors,
                          const std::vector<double>& offsets) {
  const OnnxValue x = activation(node, i);
  const size_t channels = factors.size();
  Op* op = open_producer(node, i);
  const bool depthwise = op && std::holds_alternative<DepthwiseConv2d>(op->attributes);
  if (op && (depthwise || std::holds_alternative<Conv2d>(op->attributes))) {
    std::vector<float>& w = graph_.tensors[op->inputs[1]].values;
    const size_t inner = w.size() / channels;
    for (size_t k = 0; k < w.size(); ++k)
      w[k] = static_cast<float>(w[k] * factors[depthwise ? k % channels : k / inner]);
    if (op->inputs[2] < 0) {
      const int bias = add_constant(node, {static_cast<int>(channels)}, std::vector<float>(channels, 0.0f));
      op->inputs[2] = bias;
    }
    std::vector<float>& b = graph_.tensors[op->inputs[2]].values;
    for (size_t c = 0; c < channels; ++c) b[c] = static_cast<float>(b[c] * factors[c] + offsets[c]);
    define(node, x);
    return;
  }
  const int weight = add_constant(node, {1, 1, 1, static_cast<int>(channels)}, {factors.begin(), factors.end()});
  const int bias = add_constant(node, {static_cast<int>(channels)}, {offsets.begin(), offsets.end()});
  define(node, emit_like(node, DepthwiseConv2d{}, {x.tensor, weight, bias}, x));
}

void OnnxImporter::arithmetic(NodeReader& node) {
  const std::string_view type = node.type();
  if (node.node().inputs.size() != 2) node.fail(format("has %zu inputs, must have 2", node.node().inputs.size()));
  const bool first_constant = is_constant(node, 0), second_constant = is_constant(node, 1);
  if (first_constant || second_constant) {
    const size_t i = first_constant ? 1 : 0;
    const std::vector<double> given = per_channel(node, 1 - i, activation(node, i));
    std::vector<double> factors(given.size(), 1.0), offsets(given.size(), 0.0);
    for (size_t c = 0; c < given.size(); ++c) {
      if (type == "Mul") factors[c] = given[c];
      if (type == "Div") factors[c] = 1 / given[c];
      if (type == "Add" || type == "Sum") offsets[c] = given[c];
      if (type == "Sub") offsets[c] = first_constant ? given[c] : -given[c];
      if (type == "Sub" && first_constant) factors[c] = -1;
    }
    if (type == "Div" && first_constant) node.fail("a constant divided by an input is not supported");
    affine(node, i, factors, offsets);
    return;
  }
  if (type == "Sub" || type == "Div") node.fail("of two inputs is not supported; of an input and a constant it is");
  OnnxValue a = activation(node, 0), b = activation(node, 1);
  if (a.dims != b.dims) {  // one pixel on an image: repeated
    OnnxValue& small = element_count(shape(a)) < element_count(shape(b)) ? a : b;
    const OnnxValue& large = &small == &a ? b : a;
    Dims one = large.dims;
    if (one.size() == 4) one[large.channels_last ? 1 : 2] = one[large.channels_last ? 2 : 3] = 1;
    if (small.dims != one || small.dims.size() != 4)
      node.fail("of shapes " + to_string(a.dims) + " and " + to_string(b.dims) +
                " is not supported: must be equal, or one with height and width 1");
    const Shape to = shape(large);
    const OnnxValue wide = emit(node, ResizeNearest{to[1], to[2]}, {small.tensor});
    small.tensor = wide.tensor;
    small.dims = large.dims;
  }
  if (a.channels_last != b.channels_last) node.fail("of a transposed and an image that is not is not supported");
  const Attributes attributes = type == "Mul" ? Attributes(Mul{}) : Attributes(Add{});
  define(node, emit_like(node, attributes, {a.tensor, b.tensor}, a));
}

void OnnxImporter::activate(NodeReader& node, Activation activation) {
  const OnnxValue x = this->activation(node, 0);
  Op* op = open_producer(node, 0);
  if (op && !std::holds_alternative<Logistic>(op->attributes)) {
    op->activation = activation;
    define(node, x);
    return;
  }
  const OnnxValue y = emit_like(node, Clamp{}, {x.tensor}, x);
  graph_.ops.back().activation = activation;
  define(node, y);
}

// Bounds: attributes, since opset 11 inputs.
void OnnxImporter::clip(NodeReader& node) {
  const auto bound = [&](const char* name, size_t i, float none) {
    if (!node.has_input(i)) return node.real(name, none);
    const std::vector<double> given = numbers(node, i);
    if (given.size() != 1) node.fail(format("input %zu must be one number", i));
    return static_cast<float>(given[0]);
  };
  const float low = bound("min", 1, -INFINITY), high = bound("max", 2, INFINITY);
  if (low == 0 && high == 6) {
    activate(node, Activation::kRelu6);
  } else if (low == 0 && high >= 3e38f) {
    activate(node, Activation::kRelu);
  } else {
    node.fail(format("to %g..%g is not supported: must be 0..6 or from 0 on", low, high));
  }
}

void OnnxImporter::pool(NodeReader& node) {
  const OnnxValue x = image(node, 0);
  if (!node.has("kernel_shape")) node.fail_attribute("kernel_shape", "is missing");
  const std::vector<int> kernel = sizes(node, "kernel_shape", 2, 1, 1);
  const bool ceil_mode = node.integer("ceil_mode", 0) != 0;
  const Window where = window(node, shape(x), kernel[0], kernel[1], ceil_mode);
  if (where.dilation_h != 1 || where.dilation_w != 1) node.fail_attribute("dilations", "must be 1 for pooling");
  if (node.type() == "MaxPool") {
    node.require("storage_order", 0);
    define(node, emit(node, MaxPool2d{where, kernel[0], kernel[1]}, {x.tensor}));
    return;
  }
  const bool count_padding = node.integer("count_include_pad", 0) != 0;
  if (count_padding && ceil_mode) node.fail_attribute("count_include_pad", "with ceil_mode is not supported");
  define(node, emit(node, AveragePool2d{where, kernel[0], kernel[1], count_padding}, {x.tensor}));
}

void OnnxImporter::global_pool(NodeReader& node) {
  const OnnxValue x = image(node, 0);
  const int h = shape(x)[1], w = shape(x)[2];
  Dims dims = {1, shape(x)[3], 1, 1};
  if (node.type() == "ReduceMean") {
    std::vector<int64_t> axes = node.integers("axes", {});
    if (node.has_input(1)) axes = integers_of(numbers(node, 1));
    for (int64_t& axis : axes) axis = positive_axis(node, axis, 4);
    std::sort(axes.begin(), axes.end());
    if (axes != std::vector<int64_t>{2, 3}) node.fail("only the mean over height and width is supported (axes 2, 3)");
    node.require("noop_with_empty_axes", 0);
    if (node.integer("keepdims", 1) == 0) dims.resize(2);
  }
  OnnxValue y = node.type() == "GlobalMaxPool" ? emit(node, MaxPool2d{{}, h, w}, {x.tensor})
                                               : emit(node, AveragePool2d{{}, h, w}, {x.tensor});
  y.dims = dims;
  define(node, y);
}

void OnnxImporter::resize(NodeReader& node) {
  const OnnxValue x = image(node, 0);
  const bool upsample = node.type() == "Upsample";
  const bool old = upsample || node.node().inputs.size() <= 2;  // opset 10: x and scales
  const std::string mode = node.text("mode", "nearest");
  const std::string where = node.text("coordinate_transformation_mode", old ? "asymmetric" : "half_pixel");
  const std::string rounding = node.text("nearest_mode", old ? "floor" : "round_prefer_floor");
  node.real("cubic_coeff_a", 0);
  node.real("extrapolation_value", 0);
  node.require("exclude_outside", 0);
  node.require("antialias", 0);
  if (node.text("keep_aspect_ratio_policy", "stretch") != "stretch")
    node.fail_attribute("keep_aspect_ratio_policy", "must be stretch");

  // Sizes of batch, channels, height and width, or factors.
  const size_t scales_at = old ? 1 : 2;
  std::vector<double> factors;
  if (node.has("scales")) {
    const std::vector<float> given = node.reals("scales");
    factors.assign(given.begin(), given.end());
  } else if (node.has_input(scales_at)) {
    factors = numbers(node, scales_at);
  }
  std::vector<double> to;
  if (!old && node.has_input(3)) to = numbers(node, 3);
  if (to.empty() && factors.size() == 4) {
    for (size_t i = 0; i < 4; ++i) {
      const double size = factors[i] * static_cast<double>(x.dims[i]);
      if (!(std::abs(size - std::round(size)) < 1e-3))
        node.fail(
            format("factor %g of size %lld must give a whole size", factors[i], static_cast<long long>(x.dims[i])));
      to.push_back(std::round(size));
    }
  }
  if (to.size() != 4) node.fail("must have 4 constant scales or sizes");
  for (double size : to) {
    if (!(size >= 1 && size <= 65536)) node.fail(format("size %g is out of range", size));
  }
  if (to[0] != 1 || to[1] != static_cast<double>(x.dims[1])) node.fail("only height and width can be resized");

  const bool half_pixel = where == "half_pixel" || where == "pytorch_half_pixel";
  if (!half_pixel && where != "align_corners" && where != "asymmetric")
    node.fail_attribute("coordinate_transformation_mode",
                        "\"" + where + "\" must be half_pixel, pytorch_half_pixel, align_corners or asymmetric");
  const int height = static_cast<int>(to[2]), width = static_cast<int>(to[3]);
  if (where == "pytorch_half_pixel" && (height == 1 || width == 1))
    node.fail_attribute("coordinate_transformation_mode", "pytorch_half_pixel to a size of 1 is not supported");
  if (mode == "linear") {
    define(node, emit(node, ResizeBilinear{height, width, where == "align_corners", half_pixel}, {x.tensor}));
    return;
  }
  if (mode != "nearest") node.fail_attribute("mode", "\"" + mode + "\" must be nearest or linear");
  ResizeNearest nearest{height, width, where == "align_corners", half_pixel, ResizeNearest::Rounding::kFloor};
  if (rounding == "ceil") {
    nearest.rounding = ResizeNearest::Rounding::kCeil;
  } else if (rounding == "round_prefer_floor") {
    nearest.rounding = ResizeNearest::Rounding::kNearestFloor;
  } else if (rounding == "round_prefer_ceil") {
    nearest.rounding = ResizeNearest::Rounding::kNearestCeil;
  } else if (rounding != "floor") {
    node.fail_attribute("nearest_mode",
                        "\"" + rounding + "\" must be floor, ceil, round_prefer_floor or round_prefer_ceil");
  }
  define(node, emit(node, nearest, {x.tensor}));
}

void OnnxImporter::pad(NodeReader& node) {
  const OnnxValue x = image(node, 0);
  const std::string mode = node.text("mode", "constant");
  if (mode != "constant") node.fail_attribute("mode", "\"" + mode + "\" must be constant");
  std::vector<double> amounts;  // begin of each dimension, end of each
  if (node.has_input(1)) {
    amounts = numbers(node, 1);
  } else {
    const std::vector<int64_t> given = node.integers("pads", {});
    amounts.assign(given.begin(), given.end());
  }
  if (amounts.size() != 8) node.fail(format("has %zu paddings, must have 8", amounts.size()));
  double value = node.real("value", 0);
  if (node.has_input(2)) {
    const std::vector<double> given = numbers(node, 2);
    value = given.size() == 1 ? given[0] : NAN;
  }
  if (value != 0) node.fail(format("with %g is not supported, must be 0", value));
  int n[8];
  for (size_t i = 0; i < 8; ++i) {
    if (!(amounts[i] >= 0 && amounts[i] <= kMostInWindow))
      node.fail(format("padding %g must be in 0..%lld", amounts[i], static_cast<long long>(kMostInWindow)));
    n[i] = static_cast<int>(amounts[i]);
  }
  if (n[0] != 0 || n[4] != 0) node.fail("pads the batch");
  define(node, emit(node, Pad{{n[2], n[6]}, {n[3], n[7]}, {n[1], n[5]}}, {x.tensor}));
}

void OnnxImporter::transpose(NodeReader& node) {
  OnnxValue x = activation(node, 0);
  std::vector<int64_t> order;
  for (size_t i = x.dims.size(); i-- > 0;) order.push_back(static_cast<int64_t>(i));
  order = node.integers("perm", order);
  const bool to_last = order == std::vector<int64_t>{0, 2, 3, 1}, to_first = order == std::vector<int64_t>{0, 3, 1, 2};
  if (x.dims.size() != 4 || !((to_last && !x.channels_last) || (to_first && x.channels_last)))
    node.fail_attribute("perm", to_string(order) + " of shape " + to_string(x.dims) +
                                    " is not supported: only between [1,C,H,W] and [1,H,W,C]");
  Dims dims;
  for (int64_t axis : order) dims.push_back(x.dims[axis]);
  x.shared = x.shared || uses_.at(node.node().inputs[0]) > 1;
  x.dims = dims;
  x.channels_last = to_last;
  define(node, std::move(x));
}

// Softmax and ArgMax.
void OnnxImporter::over_channels(NodeReader& node) {
  const OnnxValue x = activation(node, 0);
  const bool softmax = node.type() == "Softmax";
  const int64_t axis = positive_axis(node,
                                     node.integer("axis", !softmax            ? 0
                                                          : model_.opset < 13 ? 1
                                                                              : -1),
                                     x.dims.size());
  if (static_cast<size_t>(axis) != channel_axis(node, x))
    node.fail_attribute("axis", format("%lld: only over the channels is supported", static_cast<long long>(axis)));
  if (softmax) {
    // Before opset 13 the sum is over all dimensions from the axis on.
    if (model_.opset < 13 && shape(x)[1] * shape(x)[2] != 1 && !x.channels_last)
      node.fail("over an image needs operator set 13 or later");
    define(node, emit_like(node, Softmax{}, {x.tensor}, x));
    return;
  }
  node.require("select_last_index", 0);
  OnnxValue y = emit(node, ArgMax{}, {x.tensor});
  y.dims = x.dims;
  y.channels_last = x.channels_last;
  if (node.integer("keepdims", 1) != 0) {
    y.dims[axis] = 1;
  } else {
    y.dims.erase(y.dims.begin() + axis);
    y.channels_last = false;
  }
  define(node, y);
}

}  // namespace livecap::nn
