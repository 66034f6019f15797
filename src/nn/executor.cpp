#include "nn/executor.h"

#include <algorithm>
#include <limits>
#include <string_view>

#include "base/text.h"
#include "livecap/error.h"
#include "nn/memory_plan.h"
#include "nn/optimize.h"

namespace livecap::nn {
namespace {

constexpr size_t kLocal = 64;           // work-group size of the kernels that let the compiler vectorise
constexpr int kCacheFloats = 6 * 1024;  // weights up to this size stay in a CPU's first-level cache

constexpr int kNarrow = 3;  // output channels up to which a CPU vectorises over the input channels instead

// A GPU with fewer work-items than this mostly waits for memory: several then share a sum, of this many terms each.
constexpr int kManyItems = 32768;
constexpr int kFewTerms = 8;
// Work-groups of a layer that is launched by itself, for each compute unit.
constexpr size_t kGroupsAlone = 16;

int panels(int channels) {
  return (channels + NN_PANEL - 1) / NN_PANEL;
}

// [cout][taps][cin] to [cout/16][taps][cin][16].
int pack_conv(const Tensor& weights, std::vector<float>& out) {
  const int offset = static_cast<int>(out.size());
  const int n_out = weights.shape[0];
  const int inner = weights.shape[1] * weights.shape[2] * weights.shape[3];
  out.resize(out.size() + size_t(panels(n_out)) * inner * NN_PANEL, 0.0f);
  for (int n = 0; n < n_out; ++n) {
    float* panel = &out[offset + size_t(n / NN_PANEL) * inner * NN_PANEL + n % NN_PANEL];
    for (int i = 0; i < inner; ++i) panel[size_t(i) * NN_PANEL] = weights.values[size_t(n) * inner + i];
  }
  return offset;
}

// [taps][c] to [c/16][taps][16].
int pack_depthwise(const Tensor& weights, std::vector<float>& out) {
  const int offset = static_cast<int>(out.size());
  const int taps = weights.shape[1] * weights.shape[2];
  const int channels = weights.shape[3];
  out.resize(out.size() + size_t(panels(channels)) * taps * NN_PANEL, 0.0f);
  for (int c = 0; c < channels; ++c) {
    for (int i = 0; i < taps; ++i)
      out[offset + (size_t(c / NN_PANEL) * taps + i) * NN_PANEL + c % NN_PANEL] =
          weights.values[size_t(i) * channels + c];
  }
  return offset;
}

int pack_bias(const Graph& graph, int index, int channels, std::vector<float>& out) {
  const int offset = static_cast<int>(out.size());
  out.resize(out.size() + size_t(panels(channels)) * NN_PANEL, 0.0f);
  if (index >= 0)
    std::copy(graph.tensors[index].values.begin(), graph.tensors[index].values.end(), out.begin() + offset);
  return offset;
}

void set_window(NnOp& step, const Window& window, int kernel_h, int kernel_w) {
  step.kernel_h = kernel_h;
  step.kernel_w = kernel_w;
  step.stride_h = window.stride_h;
  step.stride_w = window.stride_w;
  step.dilation_h = window.dilation_h;
  step.dilation_w = window.dilation_w;
  step.pad_top = window.pad_top;
  step.pad_left = window.pad_left;
}

// Sizes as an image; tensors of other ranks count as one row.
void image_size(const Shape& shape, int& height, int& width, int& channels) {
  const bool image = shape.size() == 4;
  height = image ? shape[1] : 1;
  width = image ? shape[2] : 1;
  channels = image ? shape[3] : static_cast<int>(element_count(shape));
}

}  // namespace

Executor::Executor(ocl::DeviceContext& device, const Graph& graph, const std::vector<int>& requested, bool fused)
    : device_(device) {
  std::vector<int> outputs;
  for (int i : requested) {
    if (i < 0 || i >= int(graph.outputs.size()))
      throw LogicError(format("nn::Executor: output %d of %zu of %s", i, graph.outputs.size(), graph.name.c_str()));
    outputs.push_back(graph.outputs[i]);
  }
  if (outputs.empty()) throw LogicError("nn::Executor: no output requested");
  if (graph.inputs.size() != 1)
    throw IoError(graph.name + format(": has %zu inputs, only networks with one are supported", graph.inputs.size()));
  graph_ = prune(graph, outputs);
  if (fused) graph_ = fuse(graph_);
  validate(graph_);

  const MemoryPlan plan = plan_memory(graph_);
  const uint64_t bytes = uint64_t(plan.size) * sizeof(float);
  if (plan.size > std::numeric_limits<int>::max() || bytes > device.info().max_allocation_bytes)
    throw IoError(graph.name +
                  format(": needs %llu MB for activations, more than ", static_cast<unsigned long long>(bytes >> 20)) +
                  device.info().label() + " allocates");
  offsets_ = plan.offsets;

  convert_u8_ = kernel("convert_u8");
  if (!device.is_cpu()) {
    run_layers_ = kernel("run_layers", "nn/layers.cl");
    groups_ = ocl::GroupsTogether(device, std::numeric_limits<size_t>::max());
  }
  std::vector<float> weights;
  for (const Op& op : graph_.ops) {
    add_step(op, plan.offsets, weights);
    if (weights.size() > size_t(std::numeric_limits<int>::max()) / 2)
      throw IoError(graph.name + ": the weights are larger than 4 GB");
  }
  weights.resize(weights.size() + NN_PANEL, 0.0f);
  weights_ = ocl::Buffer<float>(device, weights);
  arena_ = ocl::Buffer<float>(device, static_cast<size_t>(plan.size));
  arena_.fill(0.0f);
  input_u8_ = ocl::Buffer<uint8_t>(device, static_cast<size_t>(element_count(input_shape())));
  layers_on_device_ = ocl::Buffer<NnLayer>(device, layers_);
  for (Tensor& tensor : graph_.tensors) tensor.values = {};
  // The first launch compiles on some devices: pay before the first frame.
  set_input_u8(std::vector<uint8_t>(input_u8_.size(), 0), 0, 0);
  run();
  device.finish();
  gave_up();
}

size_t Executor::kernel(const char* name, const char* file) {
  for (size_t i = 0; i < kernels_.size(); ++i) {
    if (kernels_[i].name() == name) return i;
  }
  kernels_.emplace_back(device_, file, name);
  return kernels_.size() - 1;
}

void Executor::add_step(const Op& op, const std::vector<int64_t>& offsets, std::vector<float>& weights) {
  const Tensor& in = graph_.tensors[op.inputs[0]];
  const Tensor& out = graph_.tensors[op.output];
  Step step;
  NnOp& p = step.op;
  image_size(in.shape, p.in_height, p.in_width, p.in_channels);
  image_size(out.shape, p.out_height, p.out_width, p.out_channels);
  p.in_offset = static_cast<int>(offsets[op.inputs[0]]);
  p.out_offset = static_cast<int>(offsets[op.output]);
  p.residual_offset = op.residual >= 0 ? static_cast<int>(offsets[op.residual]) : -1;
  const ClampRange range = clamp_range(op.activation);
  p.low = range.low;
  p.high = range.high;
  const int pixels = p.out_height * p.out_width;
  const int elements = static_cast<int>(element_count(out.shape));
  const bool cpu = device_.is_cpu();
  p.count = elements;
  step.local = kLocal;

  if (const auto* conv = std::get_if<Conv2d>(&op.attributes)) {
    const Tensor& w = graph_.tensors[op.inputs[1]];
    set_window(p, conv->window, w.shape[1], w.shape[2]);
    const bool pointwise = p.kernel_h == 1 && p.kernel_w == 1 && p.stride_h == 1 && p.stride_w == 1 &&
                           p.out_height == p.in_height && p.out_width == p.in_width;
    const bool narrow = cpu && p.out_channels <= kNarrow && p.in_channels % 8 == 0 && p.out_height > 1;
    if (narrow) {
      p.weight_offset = static_cast<int>(weights.size());
      weights.insert(weights.end(), w.values.begin(), w.values.end());
    } else {
      p.weight_offset = pack_conv(w, weights);
    }
    p.bias_offset = pack_bias(graph_, op.inputs[2], p.out_channels, weights);
    p.panels_innermost = element_count(w.shape) <= kCacheFloats;
    if (!cpu) {
      add_layer(step, pointwise ? NN_POINTWISE : NN_WINDOW);
    } else {
      step.kernel = kernel(narrow ? "conv_narrow" : pointwise ? "conv_pointwise" : "conv_window");
      const int n_panels = panels(p.out_channels);
      const int tiles =
          pointwise ? (pixels + NN_STRIP - 1) / NN_STRIP : p.out_height * ((p.out_width + NN_TILE - 1) / NN_TILE);
      p.count = narrow ? p.out_height : tiles * ((n_panels + 1) / 2);
      step.local = 1;
    }
    step.has_weights = true;
  } else if (const auto* depthwise = std::get_if<DepthwiseConv2d>(&op.attributes)) {
    const Tensor& w = graph_.tensors[op.inputs[1]];
    set_window(p, depthwise->window, w.shape[1], w.shape[2]);
    p.weight_offset = pack_depthwise(w, weights);
    p.bias_offset = pack_bias(graph_, op.inputs[2], p.out_channels, weights);
    if (cpu && p.out_channels == NN_PANEL / 2) {  // for vectors of two pixels
      const auto repeat = [&](int offset, int n_vectors) {
        for (int v = 0; v < n_vectors; ++v)
          std::copy_n(&weights[offset + v * NN_PANEL], NN_PANEL / 2, &weights[offset + v * NN_PANEL + NN_PANEL / 2]);
      };
      repeat(p.weight_offset, p.kernel_h * p.kernel_w);
      repeat(p.bias_offset, 1);
    }
    if (cpu) {
      const bool plain = p.dilation_h == 1 && p.dilation_w == 1 && p.kernel_h == p.kernel_w;
      const char* name = !plain                                                      ? "depthwise_any"
                         : p.kernel_h == 3 && p.stride_w == 1 && p.out_channels == 8 ? "depthwise_3x3_pairs"
                         : p.kernel_h == 3 && p.stride_w == 1                        ? "depthwise_3x3"
                         : p.kernel_h == 3 && p.stride_w == 2                        ? "depthwise_3x3_stride_2"
                         : p.kernel_h == 5 && p.stride_w == 1                        ? "depthwise_5x5"
                         : p.kernel_h == 5 && p.stride_w == 2                        ? "depthwise_5x5_stride_2"
                                                                                     : "depthwise_any";
      const bool by_row = name != std::string_view("depthwise_any");
      step.kernel = kernel(name);
      p.count = panels(p.out_channels) * (by_row ? p.out_height : pixels);
      step.local = 1;
    } else {
      add_layer(step, NN_DEPTHWISE_LAYER);
    }
    step.has_weights = true;
  } else if (std::holds_alternative<Add>(op.attributes)) {
    p.residual_offset = static_cast<int>(offsets[op.inputs[1]]);
    if (cpu) {
      step.kernel = kernel("add");
    } else {
      add_layer(step, NN_ADD);
    }
  } else if (const auto* pool = std::get_if<MaxPool2d>(&op.attributes)) {
    set_window(p, pool->window, pool->kernel_h, pool->kernel_w);
    if (cpu) {
      step.kernel = kernel("max_pool");
    } else {
      add_layer(step, NN_MAX_POOL);
    }
  } else if (const auto* mean = std::get_if<AveragePool2d>(&op.attributes)) {
    set_window(p, mean->window, mean->kernel_h, mean->kernel_w);
    p.mode = mean->count_padding;
    step.kernel = kernel("average_pool");
  } else if (std::holds_alternative<Mul>(op.attributes)) {
    p.residual_offset = static_cast<int>(offsets[op.inputs[1]]);
    step.kernel = kernel("mul");
  } else if (std::holds_alternative<Concat>(op.attributes)) {
    step.kernel = kernel("concat");
    for (int index : op.inputs) {
      p.in_offset = static_cast<int>(offsets[index]);
      p.in_channels = graph_.tensors[index].shape[3];
      p.count = pixels * p.in_channels;
      steps_.push_back(step);
      p.pad_front += p.in_channels;
    }
    return;
  } else if (std::holds_alternative<Clamp>(op.attributes)) {
    p.slope = 1;
    step.kernel = kernel("leaky_relu");
  } else if (const auto* leaky = std::get_if<LeakyRelu>(&op.attributes)) {
    p.slope = leaky->slope;
    step.kernel = kernel("leaky_relu");
  } else if (const auto* sigmoid = std::get_if<HardSigmoid>(&op.attributes)) {
    p.slope = sigmoid->slope;
    p.offset = sigmoid->offset;
    p.mode = sigmoid->swish;
    step.kernel = kernel("hard_sigmoid");
  } else if (std::holds_alternative<Softmax>(op.attributes)) {
    p.count = pixels;
    step.kernel = kernel("softmax");
  } else if (std::holds_alternative<ArgMax>(op.attributes)) {
    p.count = pixels;
    step.kernel = kernel("arg_max");
  } else if (const auto* nearest = std::get_if<ResizeNearest>(&op.attributes)) {
    p.align_corners = nearest->align_corners;
    p.half_pixel_centers = nearest->half_pixel_centers;
    p.mode = static_cast<int>(nearest->rounding);
    step.kernel = kernel("resize_nearest");
  } else if (const auto* pad = std::get_if<Pad>(&op.attributes)) {
    p.pad_top = pad->height[0];
    p.pad_left = pad->width[0];
    p.pad_front = pad->channels[0];
    step.kernel = kernel("pad");
  } else if (const auto* resize = std::get_if<ResizeBilinear>(&op.attributes)) {
    p.align_corners = resize->align_corners;
    p.half_pixel_centers = resize->half_pixel_centers;
    if (cpu) {
      step.kernel = kernel("resize_bilinear");
      p.count = p.out_height;
      step.local = 1;
    } else {
      add_layer(step, NN_RESIZE);
    }
  } else if (std::holds_alternative<Logistic>(op.attributes)) {
    if (cpu) {
      step.kernel = kernel("logistic");
    } else {
      add_layer(step, NN_LOGISTIC);
    }
  } else {
    return;  // RESHAPE: shares its input's memory
  }
  steps_.push_back(step);
}

void Executor::set_input(std::span<const float> values) {
  if (int64_t(values.size()) != element_count(input_shape()))
    throw LogicError(format("nn::Executor: input of %zu values for shape ", values.size()) + to_string(input_shape()));
  arena_.write(values, static_cast<size_t>(offsets_[graph_.inputs[0]]));
}

void Executor::set_input_u8(std::span<const uint8_t> bytes, float scale, float offset) {
  if (int64_t(bytes.size()) != element_count(input_shape()))
    throw LogicError(format("nn::Executor: input of %zu bytes for shape ", bytes.size()) + to_string(input_shape()));
  input_u8_.write(bytes);
  NnOp op{};
  op.out_offset = static_cast<int>(offsets_[graph_.inputs[0]]);
  op.count = static_cast<int>(bytes.size());
  op.low = offset;
  op.high = scale;
  kernels_[convert_u8_].launch(bytes.size(), kLocal, op, input_u8_, arena_);
}

// The step becomes one of run_layers; its op must be complete.
void Executor::add_layer(Step& step, int kind) {
  const NnOp& p = step.op;
  int slices = 1;
  if (kind == NN_POINTWISE || kind == NN_WINDOW) {
    const int pixels = p.out_height * p.out_width, lanes = (p.out_channels + 3) / 4;
    const int items = (kind == NN_POINTWISE ? (pixels + 3) / 4 : pixels) * lanes;
    while (slices < NN_MOST_SLICES && items * slices < kManyItems && p.in_channels >= 2 * slices * kFewTerms)
      slices *= 2;
  }
  step.layer = static_cast<int>(layers_.size());
  layers_.push_back({p, kind, slices});
}

// Those of steps_ from `first` on that are layers, together or one by one. Returns the step behind them.
size_t Executor::launch_layers(size_t first) {
  size_t end = first;
  while (end < steps_.size() && steps_[end].layer >= 0) ++end;
  const int first_layer = steps_[first].layer;
  const int n = static_cast<int>(end - first);
  const int at_once = groups_.work() ? n : 1;
  for (int i = 0; i < n; i += at_once) {
    // Groups that need not wait for each other may be more than the device has room for, but not than have work.
    const NnLayer& layer = layers_[first_layer + i];
    const size_t most = std::max(1, (layer.op.count * layer.slices + NN_GROUP - 1) / NN_GROUP);
    const size_t n_groups = groups_.work() ? groups_.n() : std::min(most, kGroupsAlone * groups_.n());
    kernels_[run_layers_].launch(n_groups * NN_GROUP, NN_GROUP, first_layer + i, first_layer + i + at_once,
                                 groups_.arrived(), layers_on_device_, weights_, arena_, groups_.state());
    groups_.launched(at_once - 1);
  }
  return end;
}

void Executor::run() {
  for (size_t i = 0; i < steps_.size();) {
    const Step& step = steps_[i];
    if (step.layer >= 0) {
      i = launch_layers(i);
      continue;
    }
    ocl::Kernel& kernel = kernels_[step.kernel];
    if (step.has_weights) {
      kernel.launch(step.op.count, step.local, step.op, weights_, arena_);
    } else {
      kernel.launch(step.op.count, step.local, step.op, arena_);
    }
    ++i;
  }
  groups_.read_later();
}

void Executor::read_output(size_t i, std::span<float> values) {
  if (int64_t(values.size()) != element_count(output_shape(i)))
    throw LogicError(format("nn::Executor: %zu values for output of shape ", values.size()) +
                     to_string(output_shape(i)));
  const auto read = [&] { arena_.read(values, static_cast<size_t>(offsets_[graph_.outputs[i]])); };
  read();
  if (!gave_up()) return;
  run();
  read();
}

}  // namespace livecap::nn
