// ONNX networks: the device, the naive reference and OpenCV's importer on the same bytes.
#include "nn/onnx_import.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/dnn.hpp>

#include "nn/executor.h"
#include "nn/onnx_nets.h"
#include "nn/reference.h"
#include "support/kernel_bodies.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using test::Net;
using test::onnx_float;
using test::onnx_int;
using test::onnx_ints;
using test::onnx_text;

double relative_error(const std::vector<float>& a, const std::vector<float>& b) {
  if (a.size() != b.size()) return NAN;
  double difference = 0, norm = 1e-12;
  for (size_t i = 0; i < b.size(); ++i) {
    difference += (double(a[i]) - b[i]) * (double(a[i]) - b[i]);
    norm += double(b[i]) * b[i];
  }
  return std::sqrt(difference / norm);
}

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
    EXPECT_LT(relative_error(output, expected), test::kNetworkRelative) << "device against reference";
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
  EXPECT_LT(relative_error(expected, channels_last(result.ptr<float>(), shape[3], shape[1] * shape[2])),
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

}  // namespace
}  // namespace livecap
