// Known-answer tests of the network kernels: small layers whose results are simple enough to state.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "base/text.h"
#include "livecap/error.h"
#include "nn/executor.h"

namespace livecap::nn {
namespace {

constexpr int kHeight = 6;
constexpr int kWidth = 13;
constexpr int kChannels = 24;

// x[y][x][c] = (7 y + 3 x + c) / 8, exact in float.
float input_value(int y, int x, int c) {
  return 0.125f * static_cast<float>(7 * y + 3 * x + c);
}

// Of either sign, and largest in a channel that differs from pixel to pixel.
float signed_value(int y, int x, int c) {
  return 0.5f * static_cast<float>((5 * y + 3 * x + 7 * c) % kChannels) - 6;
}

Graph one_op(Attributes attributes, Shape weights, Shape output, int channels = kChannels) {
  Graph graph;
  graph.name = "self test";
  graph.tensors.push_back({"x", {1, kHeight, kWidth, channels}, false, {}});
  Op op{std::move(attributes), {0}, 0, Activation::kNone, -1};
  if (!weights.empty()) {
    // All weights 1, all biases 0.5: the result is the window's sum plus one half.
    const int n_out = output[3];
    graph.tensors.push_back({"w", weights, true, std::vector<float>(element_count(weights), 1.0f)});
    graph.tensors.push_back({"b", {n_out}, true, std::vector<float>(n_out, 0.5f)});
    op.inputs = {0, 1, 2};
  } else if (std::holds_alternative<Add>(op.attributes) || std::holds_alternative<Mul>(op.attributes) ||
             std::holds_alternative<Concat>(op.attributes)) {
    op.inputs = {0, 0};
  }
  op.output = static_cast<int>(graph.tensors.size());
  graph.tensors.push_back({"y", std::move(output), false, {}});
  graph.ops.push_back(std::move(op));
  graph.inputs = {0};
  graph.outputs = {graph.ops[0].output};
  return graph;
}

std::vector<float> image_of(float (*value)(int y, int x, int c), int channels = kChannels) {
  std::vector<float> image;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < channels; ++c) image.push_back(value(y, x, c));
    }
  }
  return image;
}

// expected(y, x, c) for every element of the output; set_input(Executor&).
template <typename Expected, typename SetInput>
ocl::SelfTestResult test_with_input(ocl::DeviceContext& device, const char* kernel, const Graph& graph,
                                    Expected&& expected, SetInput&& set_input) {
  ocl::SelfTestResult result{kernel, false, ""};
  try {
    Executor net(device, graph, {0});
    set_input(net);
    net.run();
    const Shape shape = net.output_shape(0);
    std::vector<float> output(element_count(shape));
    net.read_output(0, output);
    size_t i = 0;
    for (int y = 0; y < shape[1]; ++y) {
      for (int x = 0; x < shape[2]; ++x) {
        for (int c = 0; c < shape[3]; ++c, ++i) {
          const double want = expected(y, x, c);
          if (std::abs(output[i] - want) <= 1e-5 * (1 + std::abs(want))) continue;
          result.detail = format("row %d column %d channel %d: %g instead of %g", y, x, c, double(output[i]), want);
          return result;
        }
      }
    }
    result.ok = true;
  } catch (const Error& e) {
    result.detail = e.what();
  }
  return result;
}

template <typename Expected>
ocl::SelfTestResult test_op(ocl::DeviceContext& device, const char* kernel, const Graph& graph, Expected&& expected,
                            float (*value)(int y, int x, int c) = input_value) {
  return test_with_input(device, kernel, graph, expected,
                         [&](Executor& net) { net.set_input(image_of(value, net.input_shape()[3])); });
}

// Sum of one channel over a window that is cut off at the image's border.
double window_sum(int y, int x, int c, int reach) {
  double sum = 0;
  for (int dy = -reach; dy <= reach; ++dy) {
    for (int dx = -reach; dx <= reach; ++dx) {
      if (y + dy >= 0 && y + dy < kHeight && x + dx >= 0 && x + dx < kWidth) sum += input_value(y + dy, x + dx, c);
    }
  }
  return sum;
}

Window same(int reach) {
  return {1, 1, 1, 1, reach, reach, reach, reach};
}

}  // namespace

std::vector<ocl::SelfTestResult> nn_self_test(ocl::DeviceContext& device) {
  const Shape image = {1, kHeight, kWidth, kChannels};
  std::vector<ocl::SelfTestResult> results;
  const auto channel_sum = [](int y, int x, int reach) {
    double sum = 0.5;
    for (int c = 0; c < kChannels; ++c) sum += window_sum(y, x, c, reach);
    return sum;
  };
  results.push_back(test_op(device, "nn/conv_pointwise",
                            one_op(Conv2d{}, {21, 1, 1, kChannels}, {1, kHeight, kWidth, 21}),
                            [&](int y, int x, int) { return channel_sum(y, x, 0); }));
  results.push_back(test_op(device, "nn/conv_window",
                            one_op(Conv2d{same(1)}, {21, 3, 3, kChannels}, {1, kHeight, kWidth, 21}),
                            [&](int y, int x, int) { return channel_sum(y, x, 1); }));
  results.push_back(test_op(device, "nn/conv_narrow",
                            one_op(Conv2d{same(1)}, {1, 3, 3, kChannels}, {1, kHeight, kWidth, 1}),
                            [&](int y, int x, int) { return channel_sum(y, x, 1); }));
  results.push_back(test_op(
      device, "nn/conv_window (1x2)",
      one_op(Conv2d{{1, 1, 1, 1, 0, 0, 0, 1}}, {21, 1, 2, kChannels}, {1, kHeight, kWidth, 21}),
      [&](int y, int x, int) { return channel_sum(y, x, 0) + (x + 1 < kWidth ? channel_sum(y, x + 1, 0) - 0.5 : 0); }));
  results.push_back(test_op(device, "nn/depthwise_3x3", one_op(DepthwiseConv2d{same(1)}, {1, 3, 3, kChannels}, image),
                            [&](int y, int x, int c) { return 0.5 + window_sum(y, x, c, 1); }));
  results.push_back(test_op(device, "nn/depthwise_5x5", one_op(DepthwiseConv2d{same(2)}, {1, 5, 5, kChannels}, image),
                            [&](int y, int x, int c) { return 0.5 + window_sum(y, x, c, 2); }));
  results.push_back(test_op(device, "nn/depthwise_3x3_pairs",
                            one_op(DepthwiseConv2d{same(1)}, {1, 3, 3, 8}, {1, kHeight, kWidth, 8}, 8),
                            [&](int y, int x, int c) { return 0.5 + window_sum(y, x, c, 1); }));
  for (const int reach : {1, 2}) {
    Window every_second = same(reach);
    every_second.stride_h = every_second.stride_w = 2;
    results.push_back(test_op(
        device, reach == 1 ? "nn/depthwise_3x3_stride_2" : "nn/depthwise_5x5_stride_2",
        one_op(DepthwiseConv2d{every_second}, {1, 2 * reach + 1, 2 * reach + 1, kChannels}, {1, 3, 7, kChannels}),
        [&](int y, int x, int c) { return 0.5 + window_sum(2 * y, 2 * x, c, reach); }));
  }
  results.push_back(test_op(device, "nn/depthwise_any", one_op(DepthwiseConv2d{same(3)}, {1, 7, 7, kChannels}, image),
                            [&](int y, int x, int c) { return 0.5 + window_sum(y, x, c, 3); }));
  results.push_back(test_op(device, "nn/add", one_op(Add{}, {}, image),
                            [](int y, int x, int c) { return 2.0 * input_value(y, x, c); }));
  results.push_back(test_op(device, "nn/logistic", one_op(Logistic{}, {}, image),
                            [](int y, int x, int c) { return 1 / (1 + std::exp(-double(input_value(y, x, c)))); }));
  results.push_back(
      test_op(device, "nn/max_pool", one_op(MaxPool2d{{2, 2, 1, 1, 0, 0, 0, 1}, 2, 2}, {}, {1, 3, 7, kChannels}),
              [](int y, int x, int c) { return input_value(2 * y + 1, std::min(2 * x + 1, kWidth - 1), c); }));
  results.push_back(
      test_op(device, "nn/pad", one_op(Pad{{1, 0}, {0, 2}, {1, 1}}, {}, {1, kHeight + 1, kWidth + 2, kChannels + 2}),
              [](int y, int x, int c) {
                return y == 0 || x >= kWidth || c == 0 || c > kChannels ? 0.0 : input_value(y - 1, x, c - 1);
              }));
  results.push_back(test_op(device, "nn/mul", one_op(Mul{}, {}, image),
                            [](int y, int x, int c) { return double(input_value(y, x, c)) * input_value(y, x, c); }));
  results.push_back(test_op(device, "nn/concat", one_op(Concat{}, {}, {1, kHeight, kWidth, 2 * kChannels}),
                            [](int y, int x, int c) { return input_value(y, x, c % kChannels); }));
  results.push_back(test_op(
      device, "nn/leaky_relu", one_op(LeakyRelu{0.25f}, {}, image),
      [](int y, int x, int c) {
        const double v = signed_value(y, x, c);
        return v > 0 ? v : 0.25 * v;
      },
      signed_value));
  results.push_back(test_op(
      device, "nn/hard_sigmoid", one_op(HardSigmoid{0.25f, 0.5f, true}, {}, image),
      [](int y, int x, int c) {
        const double v = signed_value(y, x, c);
        return v * std::clamp(0.25 * v + 0.5, 0.0, 1.0);
      },
      signed_value));
  results.push_back(test_op(device, "nn/average_pool",
                            one_op(AveragePool2d{{}, kHeight, kWidth}, {}, {1, 1, 1, kChannels}),
                            [](int, int, int c) { return 0.125 * (7 * 2.5 + 3 * 6 + c); }));
  results.push_back(test_op(device, "nn/softmax", one_op(Softmax{}, {}, image), [](int, int, int c) {
    return std::exp(0.125 * c) * std::expm1(0.125) / std::expm1(0.125 * kChannels);
  }));
  results.push_back(test_op(
      device, "nn/arg_max", one_op(ArgMax{}, {}, {1, kHeight, kWidth, 1}),
      [](int y, int x, int) {
        int best = 0;
        for (int c = 1; c < kChannels; ++c)
          if (signed_value(y, x, c) > signed_value(y, x, best)) best = c;
        return best;
      },
      signed_value));
  results.push_back(test_with_input(
      device, "nn/convert_u8", one_op(Add{}, {}, image),
      [](int y, int x, int c) { return 2 * (0.5 * (8 * input_value(y, x, c)) - 3); },
      [](Executor& net) {
        std::vector<uint8_t> bytes;
        for (const float value : image_of(input_value)) bytes.push_back(static_cast<uint8_t>(8 * value));
        net.set_input_u8(bytes, 0.5f, -3);
      }));
  results.push_back(test_op(device, "nn/resize_nearest",
                            one_op(ResizeNearest{3 * kHeight, 2 * kWidth}, {}, {1, 3 * kHeight, 2 * kWidth, kChannels}),
                            [](int y, int x, int c) { return input_value(y / 3, x / 2, c); }));
  results.push_back(test_op(device, "nn/resize_bilinear",
                            one_op(ResizeBilinear{2 * kHeight - 1, 2 * kWidth - 1, true, false}, {},
                                   {1, 2 * kHeight - 1, 2 * kWidth - 1, kChannels}),
                            [](int y, int x, int c) { return 0.125 * (3.5 * y + 1.5 * x + c); }));
  return results;
}

}  // namespace livecap::nn
