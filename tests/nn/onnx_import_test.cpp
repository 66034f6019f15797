// ONNX networks: the device, the naive reference and OpenCV's importer on the same bytes.
#include "nn/onnx_import.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/dnn.hpp>

#include "livecap/error.h"
#include "nn/executor.h"
#include "nn/onnx_nets.h"
#include "nn/reference.h"
#include "support/kernel_bodies.h"
#include "support/relative_error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using test::Net;
using test::onnx_float;
using test::onnx_int;
using test::onnx_ints;
using test::onnx_text;

// Between [1,C,H,W] and [1,H,W,C].
std::vector<float> channels_last(const float* values, int channels, int pixels) {
  std::vector<float> out(size_t(channels) * pixels);
  for (int c = 0; c < channels; ++c) {
    for (int i = 0; i < pixels; ++i) out[size_t(i) * channels + c] = values[size_t(c) * pixels + i];
  }
  return out;
}

// One picture through all three; `opencv` false where OpenCV 4.6 does not have the operator.
void expect_agreement(const std::string& bytes, const std::vector<int>& input_dims, const std::string& what,
                      bool opencv = true) {
  SCOPED_TRACE(what);
  const nn::Graph graph = nn::parse_onnx(bytes, "net.onnx", input_dims[2], input_dims[3]);
  const int channels = input_dims[1], pixels = input_dims[2] * input_dims[3];
  std::mt19937 rng(11);
  const std::vector<float> planes = test::random_values(size_t(channels) * pixels, rng, -2, 2);
  const std::vector<float> input = channels_last(planes.data(), channels, pixels);
  const std::vector<float> expected = nn::reference_run(graph, input)[graph.outputs[0]];
  double largest = 0;
  for (float v : expected) largest = std::max<double>(largest, std::abs(v));
  EXPECT_GT(largest, 1e-2) << "a net of zeros tests nothing";
  test::on_every_device_and_body([&](ocl::DeviceContext& device) {
    nn::Executor net(device, graph, {0});
    std::vector<float> output(nn::element_count(net.output_shape(0)));
    net.set_input(input);
    net.run();
    net.read_output(0, output);
    EXPECT_LT(test::relative_error(output, expected), test::kNetworkRelative) << "device against reference";
  });
  if (!opencv) return;
  cv::dnn::Net net = cv::dnn::readNetFromONNX(bytes.data(), bytes.size());
  net.setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
  cv::Mat blob(input_dims, CV_32F);
  std::copy(planes.begin(), planes.end(), blob.ptr<float>());
  net.setInput(blob);
  const cv::Mat result = net.forward();
  const nn::Shape shape = graph.tensors[graph.outputs[0]].shape;
  ASSERT_EQ(int64_t(result.total()), nn::element_count(shape));
  EXPECT_LT(test::relative_error(expected, channels_last(result.ptr<float>(), shape[3], shape[1] * shape[2])),
            test::kNetworkRelative)
      << "reference against OpenCV";
}

TEST(OnnxImport, MobileNetBlock) {
  expect_agreement(test::mobile_net_block(), {1, 3, 22, 17}, "depthwise, pointwise, residual");
}

TEST(OnnxImport, ResNetBlock) {
  expect_agreement(test::res_net_block(), {1, 3, 33, 26}, "max pooling, residual with a stride");
}

TEST(OnnxImport, AsppHead) {
  expect_agreement(test::aspp_head(false), {1, 6, 13, 11}, "dilations, global pooling, concat, resize");
}

TEST(OnnxImport, ArgMaxIsTheLargestLogit) {
  const std::string logits = test::aspp_head(false), labels = test::aspp_head(true);
  expect_agreement(labels, {1, 6, 13, 11}, "aspp with argmax", false);
  const nn::Graph a = nn::parse_onnx(logits, "net.onnx"), b = nn::parse_onnx(labels, "net.onnx");
  std::mt19937 rng(12);
  const auto input = test::random_values(6 * 13 * 11, rng);
  const auto scores = nn::reference_run(a, input)[a.outputs[0]], ids = nn::reference_run(b, input)[b.outputs[0]];
  ASSERT_EQ(scores.size(), ids.size() * 20);
  for (size_t i = 0; i < ids.size(); ++i)
    EXPECT_EQ(ids[i], std::max_element(&scores[20 * i], &scores[20 * i] + 20) - &scores[20 * i]);
}

// One operator each behind a convolution, with odd sizes.
TEST(OnnxImport, PoolingAndPadding) {
  struct Case {
    const char* type;
    std::vector<std::string> attributes;
  };
  const Case cases[] = {
      {"MaxPool", {onnx_ints("kernel_shape", {2, 3}), onnx_ints("strides", {2, 1})}},
      {"MaxPool",
       {onnx_ints("kernel_shape", {3, 3}), onnx_ints("strides", {2, 2}), onnx_ints("pads", {0, 0, 0, 0}),
        onnx_int("ceil_mode", 1)}},
      {"AveragePool", {onnx_ints("kernel_shape", {4, 3}), onnx_ints("strides", {3, 2})}},
      {"AveragePool",
       {onnx_ints("kernel_shape", {3, 3}), onnx_ints("pads", {1, 1, 1, 1}), onnx_int("count_include_pad", 1)}},
      {"AveragePool", {onnx_ints("kernel_shape", {3, 3}), onnx_ints("pads", {1, 1, 1, 1})}},
      {"MaxPool",
       {onnx_ints("kernel_shape", {3, 3}), onnx_ints("strides", {2, 2}), onnx_text("auto_pad", "SAME_UPPER")}},
      {"GlobalMaxPool", {}},
      {"ReduceMean", {onnx_ints("axes", {2, 3}), onnx_int("keepdims", 0)}},
  };
  for (const Case& c : cases) {
    Net net(4);
    net.op(c.type, {net.conv("x", 3, 9, 3)}, c.attributes);
    // OpenCV 4.6 goes by the exporter's name instead of count_include_pad; AveragesCountPadding has it by hand.
    const bool counts = c.attributes.size() == 3 && c.attributes[2] == onnx_int("count_include_pad", 1);
    expect_agreement(net.model({1, 3, 14, 19}, {net.last}), {1, 3, 14, 19}, c.type, !counts);
  }
}

TEST(OnnxImport, AveragesCountPadding) {
  for (int counted : {0, 1}) {
    Net net(14);
    net.op(
        "AveragePool", {"x"},
        {onnx_ints("kernel_shape", {1, 3}), onnx_ints("pads", {0, 1, 0, 1}), onnx_int("count_include_pad", counted)});
    const nn::Graph graph = nn::parse_onnx(net.model({1, 1, 1, 3}, {net.last}), "net.onnx");
    const std::vector<float> expected = counted ? std::vector<float>{5, 9, 7} : std::vector<float>{7.5f, 9, 10.5f};
    EXPECT_EQ(nn::reference_run(graph, {6, 9, 12})[graph.outputs[0]], expected) << counted;
  }
}

TEST(OnnxImport, ConvolutionPaddingAndGroups) {
  const std::vector<std::vector<std::string>> attributes = {
      {onnx_ints("strides", {2, 2}), onnx_text("auto_pad", "SAME_UPPER")},
      {onnx_ints("strides", {2, 1}), onnx_text("auto_pad", "SAME_LOWER")},
      {onnx_text("auto_pad", "VALID")},
      {onnx_ints("pads", {0, 1, 2, 0}), onnx_ints("dilations", {1, 2})},
  };
  for (int group : {1, 2, 6}) {
    for (size_t i = 0; i < attributes.size(); ++i) {
      // OpenCV 4.6 pads SAME_LOWER like SAME_UPPER; the standard does not.
      Net net(5);
      std::vector<std::string> all = attributes[i];
      all.push_back(onnx_int("group", group));
      all.push_back(onnx_ints("kernel_shape", {4, 3}));
      net.op("Conv", {"x", net.random({12, 6 / group, 4, 3}), net.random({12})}, all);
      expect_agreement(net.model({1, 6, 13, 10}, {net.last}), {1, 6, 13, 10},
                       "group " + std::to_string(group) + " case " + std::to_string(i), i != 1);
    }
  }
}

TEST(OnnxImport, TransposedConvolution) {
  struct Case {
    std::vector<int64_t> kernel, strides, pads, more;
  };
  for (const Case& c : {Case{{2, 2}, {2, 2}, {0, 0, 0, 0}, {0, 0}}, Case{{4, 4}, {2, 2}, {1, 1, 1, 1}, {0, 0}},
                        Case{{3, 3}, {2, 2}, {1, 1, 1, 1}, {1, 1}}, Case{{3, 3}, {1, 1}, {0, 0, 0, 0}, {0, 0}},
                        Case{{5, 3}, {3, 1}, {2, 0, 2, 0}, {1, 0}}, Case{{3, 4}, {1, 2}, {1, 1, 1, 1}, {0, 0}}}) {
    Net net(9);
    net.op("ConvTranspose", {"x", net.random({5, 7, c.kernel[0], c.kernel[1]}), net.random({7})},
           {onnx_ints("kernel_shape", c.kernel), onnx_ints("strides", c.strides), onnx_ints("pads", c.pads),
            onnx_ints("output_padding", c.more)});
    expect_agreement(net.model({1, 5, 6, 9}, {net.last}), {1, 5, 6, 9},
                     "kernel " + std::to_string(c.kernel[0]) + " stride " + std::to_string(c.strides[0]));
  }
}

TEST(OnnxImport, TransposedConvolutionRefusesWhatItCannot) {
  const auto failure = [](const std::vector<std::string>& attributes) -> std::string {
    Net net(9);
    net.op("ConvTranspose", {"x", net.random({6, 4, 2, 2})}, attributes);
    try {
      nn::parse_onnx(net.model({1, 6, 5, 5}, {net.last}), "net.onnx");
    } catch (const IoError& error) {
      return error.what();
    }
    return "no error";
  };
  for (const auto& [attribute, name] : {std::pair{onnx_int("group", 2), "group"},
                                        {onnx_ints("dilations", {2, 2}), "dilations"},
                                        {onnx_ints("strides", {3, 3}), "strides"},
                                        {onnx_ints("output_padding", {1, 0}), "output_padding"},
                                        {onnx_ints("pads", {2, 0, 0, 0}), "pads"},
                                        {onnx_ints("output_shape", {9, 9}), "output_shape"},
                                        {onnx_text("auto_pad", "SAME_UPPER"), "auto_pad"}}) {
    const std::string said = failure({attribute});
    EXPECT_NE(said.find("ConvTranspose"), std::string::npos) << said;
    EXPECT_NE(said.find(std::string("\"") + name + "\""), std::string::npos) << said;
  }
}

// By hand: every pixel scatters the kernel, two pixels on; the pads are cut off, the output padding is not.
TEST(OnnxImport, TransposedConvolutionScatters) {
  Net net(9);
  net.op("ConvTranspose", {"x", net.numbers({1, 1, 3, 1}, {1, 10, 100})},
         {onnx_ints("strides", {2, 1}), onnx_ints("pads", {1, 0, 0, 0}), onnx_ints("output_padding", {1, 0})});
  const nn::Graph graph = nn::parse_onnx(net.model({1, 1, 2, 1}, {net.last}), "net.onnx");
  // 1, 10, 100 + 2, 20, 200, 0 without the first.
  EXPECT_EQ(nn::reference_run(graph, {1, 2})[graph.outputs[0]], (std::vector<float>{10, 102, 20, 200, 0}));
}

// With SAME_LOWER the odd pixel of padding comes first: output y sees rows 2 y - 1 .. 2 y + 1 of 4 at stride 2.
TEST(OnnxImport, SameLowerPadsTheBeginning) {
  Net net(6);
  net.op("Conv", {"x", net.numbers({1, 1, 3, 1}, {1, 10, 100})},
         {onnx_ints("strides", {2, 1}), onnx_text("auto_pad", "SAME_LOWER")});
  const nn::Graph graph = nn::parse_onnx(net.model({1, 1, 4, 1}, {net.last}), "net.onnx");
  EXPECT_EQ(nn::reference_run(graph, {1, 2, 3, 4})[graph.outputs[0]], (std::vector<float>{210, 432}));
}

TEST(OnnxImport, Activations) {
  struct Case {
    const char* type;
    std::vector<std::string> attributes;
    bool opencv;
  };
  const Case cases[] = {
      {"Relu", {}, true},
      {"LeakyRelu", {onnx_float("alpha", 0.1f)}, true},
      {"Sigmoid", {}, true},
      {"HardSwish", {}, false},
      {"HardSigmoid", {onnx_float("alpha", 0.3f), onnx_float("beta", 0.4f)}, false},
      {"Softmax", {onnx_int("axis", 1)}, true},
  };
  for (const Case& c : cases) {
    Net net(7);
    const std::string x = net.conv("x", 3, 7, 3);
    const std::string y = net.op(c.type, {x}, c.attributes);
    net.op("Add", {x, y});  // x is read twice: the activation may not reach it
    expect_agreement(net.model({1, 3, 9, 10}, {net.last}), {1, 3, 9, 10}, c.type, c.opencv);
  }
}

// x * relu6(x + 3) / 6, the gate of a squeeze-and-excite block, and an input that is normalised in the network.
TEST(OnnxImport, ArithmeticWithConstantsAndGates) {
  Net net(8);
  const std::string normalized = net.op("Div", {net.op("Sub", {"x", net.numbers({1, 3, 1, 1}, {0.4f, 0.5f, 0.6f})}),
                                                net.numbers({1, 3, 1, 1}, {0.2f, 0.3f, 0.4f})});
  const std::string x = net.conv(normalized, 3, 12, 3);
  const std::string gate = net.op("Div", {net.relu6(net.op("Add", {x, net.numbers({1}, {3})})), net.numbers({1}, {6})});
  const std::string swish = net.op("Mul", {x, gate});
  const std::string squeezed = net.relu(net.conv(net.op("GlobalAveragePool", {swish}), 12, 4, 1, 1, 1, 1, true));
  const std::string excited = net.op("Sigmoid", {net.conv(squeezed, 4, 12, 1, 1, 1, 1, true)});
  net.conv(net.op("Mul", {swish, excited}), 12, 5, 1);
  expect_agreement(net.model({1, 3, 12, 9}, {net.last}), {1, 3, 12, 9}, "squeeze and excite");
}

TEST(OnnxImport, Resizes) {
  struct Case {
    const char* mode;
    const char* where;
    const char* rounding;
    std::vector<int64_t> size;
    bool opencv;  // which is right for these
  };
  const Case cases[] = {
      {"linear", "half_pixel", "", {14, 33}, true},
      {"linear", "half_pixel", "", {5, 7}, true},
      {"linear", "pytorch_half_pixel", "", {20, 9}, true},
      {"linear", "align_corners", "", {19, 12}, true},
      {"nearest", "asymmetric", "floor", {21, 22}, true},
      {"nearest", "asymmetric", "floor", {5, 30}, false},
      {"nearest", "half_pixel", "round_prefer_floor", {14, 5}, false},
      {"nearest", "half_pixel", "round_prefer_ceil", {3, 30}, false},
      {"nearest", "asymmetric", "ceil", {10, 9}, false},
      {"nearest", "align_corners", "round_prefer_floor", {13, 6}, false},
      {"linear", "asymmetric", "", {14, 22}, true},
  };
  for (const Case& c : cases) {
    Net net(9);
    std::vector<std::string> attributes = {onnx_text("mode", c.mode),
                                           onnx_text("coordinate_transformation_mode", c.where)};
    if (*c.rounding) attributes.push_back(onnx_text("nearest_mode", c.rounding));
    net.op("Resize", {net.conv("x", 3, 5, 1), "", "", net.list({1, 5, c.size[0], c.size[1]})}, attributes);
    expect_agreement(net.model({1, 3, 7, 11}, {net.last}), {1, 3, 7, 11},
                     std::string(c.mode) + " " + c.where + " " + c.rounding, c.opencv);
  }
}

// Nearest positions by hand: 4 pixels to 6, (i + 0.5) * 2/3 - 0.5 = -1/6, 1/2, 7/6, 11/6, 5/2, 19/6.
TEST(OnnxImport, NearestRounding) {
  const std::pair<const char*, std::vector<float>> cases[] = {
      {"round_prefer_floor", {0, 0, 1, 2, 2, 3}},
      {"round_prefer_ceil", {0, 1, 1, 2, 3, 3}},
      {"floor", {0, 0, 1, 1, 2, 3}},
      {"ceil", {0, 1, 2, 2, 3, 3}},
  };
  for (const auto& [rounding, expected] : cases) {
    Net net(10);
    net.op("Resize", {"x", "", "", net.list({1, 1, 1, 6})}, {onnx_text("nearest_mode", rounding)});
    const nn::Graph graph = nn::parse_onnx(net.model({1, 1, 1, 4}, {net.last}), "net.onnx");
    EXPECT_EQ(nn::reference_run(graph, {0, 1, 2, 3})[graph.outputs[0]], expected) << rounding;
  }
}

// What exporters make of interpolate(x, size=y.shape[2:]) when sizes are open: nodes that compute sizes.
TEST(OnnxImport, ComputedSizesAndOpenInput) {
  Net net(11);
  const std::string small = net.conv("x", 3, 6, 3, 2);
  const std::string shape = net.op("Shape", {"x"});
  std::vector<std::string> parts;
  for (int axis : {2, 3}) {
    const std::string size = net.op("Gather", {shape, net.list({axis})}, {onnx_int("axis", 0)});
    parts.push_back(net.op("Cast", {size}, {onnx_int("to", 7)}));
  }
  const std::string to = net.op("Concat", parts, {onnx_int("axis", 0)});
  const std::string begin = net.op("Slice", {net.op("Shape", {small}), net.list({0}), net.list({2}), net.list({0})});
  net.op("Resize", {small, "", "", net.op("Concat", {begin, to}, {onnx_int("axis", 0)})},
         {onnx_text("mode", "linear"), onnx_text("coordinate_transformation_mode", "align_corners")});
  const std::string bytes = net.model({0, 3, 0, 0}, {net.last});
  for (const auto& [height, width] : {std::pair{17, 12}, {30, 41}}) {
    expect_agreement(bytes, {1, 3, height, width}, "open size", false);
    const nn::Graph graph = nn::parse_onnx(bytes, "net.onnx", height, width);
    EXPECT_EQ(graph.tensors[graph.outputs[0]].shape, (nn::Shape{1, height, width, 6}));
  }
}

// An image with its channels last (as TensorFlow's converter writes it), Clip's bounds as inputs, PADs of their own.
TEST(OnnxImport, ChannelsLastAndPads) {
  Net net(12), plain(12);
  for (Net* n : {&net, &plain}) {
    const bool last = n == &net;
    const std::string x =
        last ? n->op("Transpose", {"x"}, {onnx_ints("perm", {0, 3, 1, 2})}) : n->op("Identity", {"x"});
    const std::string padded = n->op("Pad", {x, n->list({0, 0, 1, 0, 0, 0, 2, 1})});
    const std::string y = n->op("Conv", {padded, n->random({8, 3, 3, 3})},
                                {onnx_ints("strides", {2, 2}), onnx_ints("kernel_shape", {3, 3})});
    const std::string low = n->numbers({}, {0}), high = n->numbers({}, {6});
    const std::string z = last ? n->op("Clip", {y, low, high}) : n->relu6(y);
    if (last) n->op("Transpose", {z}, {onnx_ints("perm", {0, 2, 3, 1})});
  }
  const nn::Graph a = nn::parse_onnx(net.model({1, 9, 8, 3}, {net.last}), "net.onnx");
  const std::string bytes = plain.model({1, 3, 9, 8}, {plain.last});
  const nn::Graph b = nn::parse_onnx(bytes, "net.onnx");
  std::mt19937 rng(13);
  const auto input = test::random_values(9 * 8 * 3, rng);
  EXPECT_EQ(nn::reference_run(a, input)[a.outputs[0]], nn::reference_run(b, input)[b.outputs[0]]);
  expect_agreement(bytes, {1, 3, 9, 8}, "pad");
}

}  // namespace
}  // namespace livecap
