// Every operator on small random layers of odd sizes: device against the plain-loop reference, fused and not.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>

#include "livecap/error.h"
#include "nn/executor.h"
#include "nn/optimize.h"
#include "nn/random_graph.h"
#include "nn/reference.h"
#include "support/kernel_bodies.h"
#include "support/launched_kernels.h"
#include "support/test_device.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using nn::Activation;
using test::add_conv;
using test::add_depthwise;
using test::add_op;
using test::input_graph;

nn::Window window(int stride, int dilation, int top, int left, int bottom, int right) {
  return {stride, stride, dilation, dilation, top, left, bottom, right};
}

// Largest difference relative to the largest value; NaN never passes.
void expect_close(const std::vector<float>& value, const std::vector<float>& expected, const std::string& what) {
  ASSERT_EQ(value.size(), expected.size()) << what;
  double largest = 1e-3;
  for (float v : expected) largest = std::max<double>(largest, std::abs(v));
  for (size_t i = 0; i < value.size(); ++i)
    ASSERT_TRUE(std::abs(double(value[i]) - expected[i]) <= test::kLayerRelative * largest)
        << what << " element " << i << ": " << value[i] << " instead of " << expected[i];
}

void expect_device_agrees(nn::Graph graph, const std::string& what) {
  graph.outputs = {graph.ops.back().output};
  nn::validate(graph);
  std::mt19937 rng(7);
  const auto input = test::random_values(nn::element_count(graph.tensors[graph.inputs[0]].shape), rng, -2, 2);
  const auto expected = nn::reference_run(graph, input)[graph.outputs[0]];
  test::on_every_device_and_body([&](ocl::DeviceContext& device) {
    for (bool fused : {false, true}) {
      nn::Executor net(device, graph, {0}, fused);
      std::vector<float> output(nn::element_count(net.output_shape(0)));
      for (int repeat = 0; repeat < 2; ++repeat) {
        net.set_input(input);
        net.run();
        net.read_output(0, output);
        expect_close(output, expected, what + (fused ? " fused" : " not fused"));
      }
    }
  });
}

TEST(Layers, Convolutions) {
  std::mt19937 rng(1);
  struct Case {
    int height, width, channels, n_out, kh, kw;
    nn::Window window;
    Activation activation;
  };
  const Case cases[] = {
      {1, 1, 1, 1, 1, 1, window(1, 1, 0, 0, 0, 0), Activation::kNone},
      {3, 21, 5, 17, 1, 1, window(1, 1, 0, 0, 0, 0), Activation::kRelu6},
      {8, 8, 48, 63, 1, 1, window(1, 1, 0, 0, 0, 0), Activation::kRelu},
      {13, 5, 24, 64, 1, 1, window(1, 1, 0, 0, 0, 0), Activation::kNone},
      {9, 7, 33, 65, 1, 1, window(1, 1, 0, 0, 0, 0), Activation::kNone},
      {7, 7, 33, 65, 1, 1, window(1, 1, 0, 0, 0, 0), Activation::kNone},
      {14, 14, 12, 24, 1, 1, window(1, 1, 0, 0, 0, 0), Activation::kRelu},
      {9, 7, 8, 24, 1, 1, window(2, 1, 0, 0, 0, 0), Activation::kNone},
      {19, 37, 3, 24, 3, 3, window(2, 1, 0, 1, 1, 0), Activation::kRelu6},
      {17, 29, 8, 1, 3, 3, window(1, 1, 1, 1, 1, 1), Activation::kNone},
      {11, 23, 5, 19, 3, 5, window(1, 2, 2, 4, 2, 4), Activation::kRelu},
      {2, 2, 40, 195, 2, 2, window(1, 1, 0, 0, 0, 0), Activation::kNone},
      {7, 19, 16, 3, 3, 5, window(2, 1, 1, 2, 1, 2), Activation::kRelu},
      {40, 9, 260, 150, 1, 1, window(1, 1, 0, 0, 0, 0), Activation::kNone},
  };
  for (const Case& c : cases) {
    nn::Graph graph = input_graph(c.height, c.width, c.channels);
    add_conv(graph, 0, c.n_out, c.kh, c.kw, c.window, c.activation, rng, c.n_out != 17);
    expect_device_agrees(graph, "CONV_2D " + nn::to_string(graph.tensors[0].shape) + " to " + std::to_string(c.n_out));
  }
}

// Every number of channels at every width; the six kernels and strides are dealt round, so that each meets every width
// and most numbers of channels. (All 168 take a minute to compile where a size is compiled in.)
TEST(Layers, DepthwiseConvolutions) {
  std::mt19937 rng(2);
  constexpr int kKernels[] = {2, 3, 5};
  int dealt = 0;
  for (const int width : {1, 2, 9, 22}) {
    for (const int channels : {1, 8, 15, 16, 17, 24, 65}) {
      const int kernel = kKernels[dealt % 3], stride = 1 + dealt / 3 % 2;
      const int before = (kernel - 1) / 2, after = kernel - 1 - before;
      nn::Graph graph = input_graph(7, width, channels);
      add_depthwise(graph, 0, kernel, kernel, window(stride, 1, before, before, after, after), Activation::kRelu6, rng);
      expect_device_agrees(graph, "DEPTHWISE_CONV_2D kernel " + std::to_string(kernel) + " stride " +
                                      std::to_string(stride) + " " + nn::to_string(graph.tensors[0].shape));
      ++dealt;
    }
  }
  nn::Graph graph = input_graph(12, 11, 20);
  add_depthwise(graph, 0, 3, 3, window(1, 2, 2, 2, 2, 2), Activation::kNone, rng);
  expect_device_agrees(graph, "DEPTHWISE_CONV_2D dilated");
}

TEST(Layers, OperatorsWithoutWeights) {
  for (int channels : {1, 16, 39}) {
    for (const nn::Attributes& attributes :
         {nn::Attributes(nn::MaxPool2d{window(2, 1, 0, 0, 1, 1), 2, 2}),
          nn::Attributes(nn::Pad{{1, 2}, {3, 0}, {2, 5}}), nn::Attributes(nn::ResizeBilinear{14, 22, false, true}),
          nn::Attributes(nn::ResizeBilinear{4, 31, true, false}),
          nn::Attributes(nn::ResizeBilinear{9, 5, false, false}), nn::Attributes(nn::Logistic{}),
          nn::Attributes(nn::AveragePool2d{window(2, 1, 1, 0, 1, 1), 3, 2, false}),
          nn::Attributes(nn::AveragePool2d{window(1, 1, 1, 1, 0, 1), 2, 3, true}),
          nn::Attributes(nn::ResizeNearest{13, 30, false, false, nn::ResizeNearest::Rounding::kFloor}),
          nn::Attributes(nn::ResizeNearest{4, 17, false, true, nn::ResizeNearest::Rounding::kNearestFloor}),
          nn::Attributes(nn::ResizeNearest{9, 5, true, false, nn::ResizeNearest::Rounding::kNearestCeil}),
          nn::Attributes(nn::ResizeNearest{14, 8, false, true, nn::ResizeNearest::Rounding::kCeil}),
          nn::Attributes(nn::Clamp{}), nn::Attributes(nn::LeakyRelu{0.2f}),
          nn::Attributes(nn::HardSigmoid{0.3f, 0.4f, false}), nn::Attributes(nn::HardSigmoid{}),
          nn::Attributes(nn::Softmax{}), nn::Attributes(nn::ArgMax{})}) {
      nn::Graph graph = input_graph(7, 11, channels);
      add_op(graph, {attributes, {0}, -1, Activation::kNone, -1});
      expect_device_agrees(graph, nn::op_name(graph.ops[0]));
    }
    nn::Graph graph = input_graph(3, 5, channels);
    const int y = add_op(graph, {nn::Logistic{}, {0}, -1, Activation::kNone, -1});
    const int z = add_op(graph, {nn::Add{}, {y, 0}, -1, Activation::kRelu, -1});
    const int product = add_op(graph, {nn::Mul{}, {z, y}, -1, Activation::kRelu6, -1});
    const int both = add_op(graph, {nn::Concat{}, {product, z, 0}, -1, Activation::kRelu, -1});
    add_op(graph, {nn::Reshape{{1, 45 * channels}}, {both}, -1, Activation::kNone, -1});
    expect_device_agrees(graph, "ADD, MUL, CONCATENATION and RESHAPE");
  }
}

// An inverted residual with padding, a skip connection across a resize and memory that is used again.
nn::Graph branched_graph() {
  std::mt19937 rng(3);
  nn::Graph graph = input_graph(13, 18, 5);
  const int a = add_conv(graph, 0, 21, 1, 1, {}, Activation::kRelu6, rng);
  const int padded = add_op(graph, {nn::Pad{{1, 1}, {1, 1}, {0, 0}}, {a}, -1, Activation::kNone, -1});
  const int b = add_depthwise(graph, padded, 3, 3, {}, Activation::kRelu6, rng);
  const int c = add_conv(graph, b, 21, 1, 1, {}, Activation::kNone, rng);
  const int sum = add_op(graph, {nn::Add{}, {a, c}, -1, Activation::kRelu, -1});
  const int pooled = add_op(graph, {nn::MaxPool2d{window(2, 1, 0, 0, 1, 0), 2, 2}, {sum}, -1, Activation::kNone, -1});
  const int d = add_conv(graph, pooled, 21, 3, 3, window(1, 1, 1, 1, 1, 1), Activation::kNone, rng);
  const int up = add_op(graph, {nn::ResizeBilinear{13, 18, false, true}, {d}, -1, Activation::kNone, -1});
  const int merged = add_op(graph, {nn::Add{}, {up, sum}, -1, Activation::kNone, -1});
  add_conv(graph, merged, 7, 1, 1, {}, Activation::kNone, rng);
  return graph;
}

TEST(Layers, BranchedNetworkWithSharedMemory) {
  expect_device_agrees(branched_graph(), "branched");
}

TEST(Layers, FusionRemovesPadsAndAdds) {
  nn::Graph graph = branched_graph();
  graph.outputs = {graph.ops.back().output};
  const nn::Graph fused = nn::fuse(graph);
  nn::validate(fused);
  EXPECT_EQ(fused.ops.size(), graph.ops.size() - 3);  // one PAD, two ADDs
  for (const nn::Op& op : fused.ops) {
    EXPECT_FALSE(std::holds_alternative<nn::Pad>(op.attributes));
    EXPECT_FALSE(std::holds_alternative<nn::Add>(op.attributes));
  }
}

TEST(Layers, PruningKeepsOnlyWhatIsNeeded) {
  nn::Graph graph = branched_graph();
  graph.outputs = {graph.ops.back().output};
  const nn::Graph pruned = nn::prune(graph, {graph.ops[0].output});
  EXPECT_EQ(pruned.ops.size(), 1u);
  nn::validate(pruned);
  EXPECT_THROW(nn::prune(graph, {1}), LogicError);  // a constant
}

TEST(Layers, WrongSizesAreRefused) {
  nn::Graph graph = branched_graph();
  graph.outputs = {graph.ops.back().output};
  test::on_every_device([&](ocl::DeviceContext& device) {
    EXPECT_THROW(nn::Executor(device, graph, {1}), LogicError);
    nn::Executor net(device, graph, {0});
    EXPECT_THROW(net.set_input(std::vector<float>(3)), LogicError);
    std::vector<float> output(3);
    EXPECT_THROW(net.read_output(0, output), LogicError);
  });
}

// A device that says it has more compute units than it runs work-groups at once: the first launch gives up, results are
// right all the same.
TEST(Layers, GroupsThatDoNotRunAtOnceAreNoticed) {
  nn::Graph graph = branched_graph();
  graph.outputs = {graph.ops.back().output};
  std::mt19937 rng(3);
  const auto input = test::random_values(nn::element_count(graph.tensors[graph.inputs[0]].shape), rng, -2, 2);
  const auto expected = nn::reference_run(graph, input)[graph.outputs[0]];
  ocl::DeviceInfo info = ocl::select_device("cpu");
  info.is_cpu = false;
  for (const uint32_t units : {1u, 5u}) {
    info.compute_units = units;
    ocl::DeviceContext device(info);
    nn::Executor net(device, graph, {0});
    EXPECT_EQ(net.together(), units == 1) << units;
    std::vector<float> output(expected.size());
    net.set_input(input);
    net.run();
    net.read_output(0, output);
    expect_close(output, expected, "units " + std::to_string(units));
  }
}

TEST(Layers, SelfTestPasses) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    const auto results = nn::nn_self_test(device);
    EXPECT_GE(results.size(), 10u);
    for (const auto& result : results) EXPECT_TRUE(result.ok) << result.kernel << ": " << result.detail;
    std::set<std::string> layers;  // of a GPU
    if (!device.is_cpu()) layers = {"add", "logistic", "max_pool"};
    test::expect_every_kernel_launched(device.info(), "nn/nn.cl", nn::nn_self_test, layers);
    if (!device.is_cpu()) test::expect_every_kernel_launched(device.info(), "nn/layers.cl", nn::nn_self_test);
  });
}

}  // namespace
}  // namespace livecap
