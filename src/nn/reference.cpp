#include "nn/reference.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "livecap/error.h"

namespace livecap::nn {
namespace {

using Values = std::vector<std::vector<float>>;

struct Image {
  const Shape& shape;
  const std::vector<float>& values;
  bool has(int y, int x) const { return y >= 0 && y < shape[1] && x >= 0 && x < shape[2]; }
  double at(int y, int x, int c) const { return values[(size_t(y) * shape[2] + x) * shape[3] + c]; }
};

const std::vector<float>& values_of(const Graph& graph, const Values& values, int index) {
  return graph.tensors[index].is_constant ? graph.tensors[index].values : values[index];
}

double bias_of(const Graph& graph, const Op& op, int channel) {
  return op.inputs[2] >= 0 ? graph.tensors[op.inputs[2]].values[channel] : 0.0;
}

// Calls value(y, x, c) for every element of the output.
template <typename Value>
std::vector<float> for_each_element(const Shape& shape, Value&& value) {
  std::vector<float> out;
  out.reserve(size_t(shape[1]) * shape[2] * shape[3]);
  for (int y = 0; y < shape[1]; ++y) {
    for (int x = 0; x < shape[2]; ++x) {
      for (int c = 0; c < shape[3]; ++c) out.push_back(static_cast<float>(value(y, x, c)));
    }
  }
  return out;
}

std::vector<float> run(const Graph& graph, const Op& op, const Conv2d& conv, const Values& values) {
  const Image x{graph.tensors[op.inputs[0]].shape, values_of(graph, values, op.inputs[0])};
  const Tensor& weights = graph.tensors[op.inputs[1]];
  const int kh = weights.shape[1], kw = weights.shape[2], channels = weights.shape[3];
  const Window& w = conv.window;
  return for_each_element(graph.tensors[op.output].shape, [&](int oy, int ox, int n) {
    double sum = bias_of(graph, op, n);
    for (int ky = 0; ky < kh; ++ky) {
      for (int kx = 0; kx < kw; ++kx) {
        const int iy = oy * w.stride_h - w.pad_top + ky * w.dilation_h;
        const int ix = ox * w.stride_w - w.pad_left + kx * w.dilation_w;
        if (!x.has(iy, ix)) continue;
        const float* tap = &weights.values[((size_t(n) * kh + ky) * kw + kx) * channels];
        for (int k = 0; k < channels; ++k) sum += x.at(iy, ix, k) * tap[k];
      }
    }
    return sum;
  });
}

std::vector<float> run(const Graph& graph, const Op& op, const DepthwiseConv2d& conv, const Values& values) {
  const Image x{graph.tensors[op.inputs[0]].shape, values_of(graph, values, op.inputs[0])};
  const Tensor& weights = graph.tensors[op.inputs[1]];
  const int kh = weights.shape[1], kw = weights.shape[2], channels = weights.shape[3];
  const Window& w = conv.window;
  return for_each_element(graph.tensors[op.output].shape, [&](int oy, int ox, int c) {
    double sum = bias_of(graph, op, c);
    for (int ky = 0; ky < kh; ++ky) {
      for (int kx = 0; kx < kw; ++kx) {
        const int iy = oy * w.stride_h - w.pad_top + ky * w.dilation_h;
        const int ix = ox * w.stride_w - w.pad_left + kx * w.dilation_w;
        if (x.has(iy, ix)) sum += x.at(iy, ix, c) * weights.values[(size_t(ky) * kw + kx) * channels + c];
      }
    }
    return sum;
  });
}

std::vector<float> run(const Graph& graph, const Op& op, const Add&, const Values& values) {
  std::vector<float> out = values_of(graph, values, op.inputs[0]);
  const auto& other = values_of(graph, values, op.inputs[1]);
  for (size_t i = 0; i < out.size(); ++i) out[i] += other[i];
  return out;
}

std::vector<float> run(const Graph& graph, const Op& op, const MaxPool2d& pool, const Values& values) {
  const Image x{graph.tensors[op.inputs[0]].shape, values_of(graph, values, op.inputs[0])};
  const Window& w = pool.window;
  return for_each_element(graph.tensors[op.output].shape, [&](int oy, int ox, int c) {
    double best = -std::numeric_limits<double>::infinity();
    for (int ky = 0; ky < pool.kernel_h; ++ky) {
      for (int kx = 0; kx < pool.kernel_w; ++kx) {
        const int iy = oy * w.stride_h - w.pad_top + ky;
        const int ix = ox * w.stride_w - w.pad_left + kx;
        if (x.has(iy, ix)) best = std::max(best, x.at(iy, ix, c));
      }
    }
    return best;
  });
}

std::vector<float> run(const Graph& graph, const Op& op, const AveragePool2d& pool, const Values& values) {
  const Image x{graph.tensors[op.inputs[0]].shape, values_of(graph, values, op.inputs[0])};
  const Window& w = pool.window;
  return for_each_element(graph.tensors[op.output].shape, [&](int oy, int ox, int c) {
    double sum = 0;
    int n = 0;
    for (int ky = 0; ky < pool.kernel_h; ++ky) {
      for (int kx = 0; kx < pool.kernel_w; ++kx) {
        const int iy = oy * w.stride_h - w.pad_top + ky;
        const int ix = ox * w.stride_w - w.pad_left + kx;
        if (x.has(iy, ix)) sum += x.at(iy, ix, c);
        n += pool.count_padding || x.has(iy, ix);
      }
    }
    return sum / n;
  });
}

std::vector<float> run(const Graph& graph, const Op& op, const Pad& pad, const Values& values) {
  const Image x{graph.tensors[op.inputs[0]].shape, values_of(graph, values, op.inputs[0])};
  return for_each_element(graph.tensors[op.output].shape, [&](int oy, int ox, int oc) {
    const int iy = oy - pad.height[0], ix = ox - pad.width[0], c = oc - pad.channels[0];
    return x.has(iy, ix) && c >= 0 && c < x.shape[3] ? x.at(iy, ix, c) : 0.0;
  });
}

template <typename Resize>
double source_coordinate(const Resize& resize, int i, int in_size, int out_size) {
  if (resize.align_corners && out_size > 1) {
    const double scale = double(in_size - 1) / (out_size - 1);
    return resize.half_pixel_centers ? (i + 0.5) * scale - 0.5 : i * scale;
  }
  const double scale = double(in_size) / out_size;
  return resize.half_pixel_centers ? (i + 0.5) * scale - 0.5 : i * scale;
}

std::vector<float> run(const Graph& graph, const Op& op, const ResizeBilinear& resize, const Values& values) {
  const Image image{graph.tensors[op.inputs[0]].shape, values_of(graph, values, op.inputs[0])};
  const int height = image.shape[1], width = image.shape[2];
  return for_each_element(graph.tensors[op.output].shape, [&](int oy, int ox, int c) {
    const double y = source_coordinate(resize, oy, height, resize.height);
    const double x = source_coordinate(resize, ox, width, resize.width);
    const double fy = y - std::floor(y), fx = x - std::floor(x);
    double sum = 0;
    for (int dy = 0; dy < 2; ++dy) {
      for (int dx = 0; dx < 2; ++dx) {
        const int iy = std::clamp(static_cast<int>(std::floor(y)) + dy, 0, height - 1);
        const int ix = std::clamp(static_cast<int>(std::floor(x)) + dx, 0, width - 1);
        sum += (dy ? fy : 1 - fy) * (dx ? fx : 1 - fx) * image.at(iy, ix, c);
      }
    }
    return sum;
  });
}

int nearest_index(ResizeNearest::Rounding rounding, double at, int size) {
  constexpr double kTiny = 1e-9;  // positions are fractions of whole numbers, computed here with rounding
  double index = 0;
  switch (rounding) {
    case ResizeNearest::Rounding::kFloor:
      index = std::floor(at + kTiny);
      break;
    case ResizeNearest::Rounding::kCeil:
      index = std::ceil(at - kTiny);
      break;
    case ResizeNearest::Rounding::kNearestFloor:
      index = std::ceil(at - 0.5 - kTiny);
      break;
    case ResizeNearest::Rounding::kNearestCeil:
      index = std::floor(at + 0.5 + kTiny);
      break;
  }
  return std::clamp(static_cast<int>(index), 0, size - 1);
}

std::vector<float> run(const Graph& graph, const Op& op, const ResizeNearest& resize, const Values& values) {
  const Image x{graph.tensors[op.inputs[0]].shape, values_of(graph, values, op.inputs[0])};
  return for_each_element(graph.tensors[op.output].shape, [&](int oy, int ox, int c) {
    const double y = source_coordinate(resize, oy, x.shape[1], resize.height);
    return x.at(nearest_index(resize.rounding, y, x.shape[1]),
                nearest_index(resize.rounding, source_coordinate(resize, ox, x.shape[2], resize.width), x.shape[2]), c);
  });
}

std::vector<float> run(const Graph& graph, const Op& op, const Mul&, const Values& values) {
  std::vector<float> out = values_of(graph, values, op.inputs[0]);
  const auto& other = values_of(graph, values, op.inputs[1]);
  for (size_t i = 0; i < out.size(); ++i) out[i] *= other[i];
  return out;
}

std::vector<float> run(const Graph& graph, const Op& op, const Concat&, const Values& values) {
  return for_each_element(graph.tensors[op.output].shape, [&](int y, int x, int c) {
    size_t i = 0;
    while (c >= graph.tensors[op.inputs[i]].shape[3]) c -= graph.tensors[op.inputs[i++]].shape[3];
    return Image{graph.tensors[op.inputs[i]].shape, values_of(graph, values, op.inputs[i])}.at(y, x, c);
  });
}

std::vector<float> run(const Graph& graph, const Op& op, const Clamp&, const Values& values) {
  return values_of(graph, values, op.inputs[0]);
}

std::vector<float> run(const Graph& graph, const Op& op, const LeakyRelu& leaky, const Values& values) {
  std::vector<float> out = values_of(graph, values, op.inputs[0]);
  for (float& v : out) v = v > 0 ? v : leaky.slope * v;
  return out;
}

std::vector<float> run(const Graph& graph, const Op& op, const HardSigmoid& sigmoid, const Values& values) {
  std::vector<float> out = values_of(graph, values, op.inputs[0]);
  for (float& v : out) {
    const double gate = std::clamp(double(sigmoid.slope) * v + sigmoid.offset, 0.0, 1.0);
    v = static_cast<float>(sigmoid.swish ? v * gate : gate);
  }
  return out;
}

std::vector<float> run(const Graph& graph, const Op& op, const Softmax&, const Values& values) {
  const Image x{graph.tensors[op.inputs[0]].shape, values_of(graph, values, op.inputs[0])};
  return for_each_element(x.shape, [&](int oy, int ox, int c) {
    double sum = 0;  // of exp relative to this channel: no overflow that the result does not survive
    for (int k = 0; k < x.shape[3]; ++k) sum += std::exp(x.at(oy, ox, k) - x.at(oy, ox, c));
    return 1 / sum;
  });
}

std::vector<float> run(const Graph& graph, const Op& op, const ArgMax&, const Values& values) {
  const Image x{graph.tensors[op.inputs[0]].shape, values_of(graph, values, op.inputs[0])};
  return for_each_element(graph.tensors[op.output].shape, [&](int oy, int ox, int) {
    int best = 0;
    for (int c = 1; c < x.shape[3]; ++c) best = x.at(oy, ox, c) > x.at(oy, ox, best) ? c : best;
    return best;
  });
}

std::vector<float> run(const Graph& graph, const Op& op, const Reshape&, const Values& values) {
  return values_of(graph, values, op.inputs[0]);
}

std::vector<float> run(const Graph& graph, const Op& op, const Logistic&, const Values& values) {
  std::vector<float> out = values_of(graph, values, op.inputs[0]);
  for (float& v : out) v = static_cast<float>(1 / (1 + std::exp(-double(v))));
  return out;
}

}  // namespace

std::vector<float> reference_op(const Graph& graph, const Op& op, const Values& values) {
  std::vector<float> out =
      std::visit([&](const auto& attributes) { return run(graph, op, attributes, values); }, op.attributes);
  if (op.residual >= 0) {
    const auto& residual = values_of(graph, values, op.residual);
    for (size_t i = 0; i < out.size(); ++i) out[i] += residual[i];
  }
  const ClampRange range = clamp_range(op.activation);
  for (float& v : out) v = std::clamp(v, range.low, range.high);
  return out;
}

Values reference_run(const Graph& graph, const std::vector<float>& input) {
  if (graph.inputs.size() != 1 || int64_t(input.size()) != element_count(graph.tensors[graph.inputs[0]].shape))
    throw LogicError("nn::reference_run: the graph must have one input of the given size");
  Values values(graph.tensors.size());
  values[graph.inputs[0]] = input;
  for (const Op& op : graph.ops) values[op.output] = reference_op(graph, op, values);
  return values;
}

}  // namespace livecap::nn
