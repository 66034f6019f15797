// The three pose networks on recorded input and outputs of an independent runner, and layer by layer on their real
// weights.
#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "nn/executor.h"
#include "nn/models.h"
#include "nn/npy.h"
#include "nn/reference.h"
#include "nn/tflite_import.h"
#include "support/data_dir.h"
#include "support/kernel_bodies.h"
#include "support/relative_error.h"
#include "support/test_device.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

class PoseNetwork : public testing::TestWithParam<const char*> {};
INSTANTIATE_TEST_SUITE_P(Models, PoseNetwork, testing::Values("lite", "full", "heavy"),
                         [](const auto& info) { return std::string(info.param); });

std::vector<float> load_crop(const std::filesystem::path& path) {
  cv::Mat bgr = cv::imread(path.string());
  std::vector<float> input;
  for (int y = 0; y < bgr.rows; ++y) {
    for (int x = 0; x < bgr.cols; ++x) {
      for (int c = 2; c >= 0; --c) input.push_back(bgr.at<cv::Vec3b>(y, x)[c] / 255.0f);
    }
  }
  return input;
}

TEST_P(PoseNetwork, GivesTheRecordedOutputs) {
  LIVECAP_MODEL_OR_SKIP(model, GetParam());
  LIVECAP_DATA_OR_SKIP(data, "network");
  const std::vector<float> input = load_crop(data / "crop.png");
  const nn::Graph graph = nn::load_tflite(model);
  test::on_every_device_and_body([&](ocl::DeviceContext& device) {
    nn::Executor net(device, graph, {0, 1, 2, 3, 4});
    net.set_input(input);
    net.run();
    const char* names[] = {"landmarks", "score", "mask", "heatmap", "world"};
    for (int i = 0; i < 5; ++i) {
      const auto expected = test::load_npy(data / (std::string(GetParam()) + "_" + names[i] + ".npy"));
      std::vector<float> output(nn::element_count(net.output_shape(i)));
      ASSERT_EQ(output.size(), expected.size()) << names[i];
      net.read_output(i, output);
      EXPECT_LT(test::relative_error(output, expected), test::kNetworkRelative) << names[i];
    }
  });
}

// Outputs that are not requested change nothing, and bytes are the same input as floats.
TEST_P(PoseNetwork, PrunedAndByteInputAgree) {
  LIVECAP_MODEL_OR_SKIP(model, GetParam());
  const nn::Graph graph = nn::load_tflite(model);
  test::on_every_device([&](ocl::DeviceContext& device) {
    nn::Executor whole(device, graph, {0, 1, 2, 3, 4});
    nn::Executor pruned(device, graph, {4});
    EXPECT_LT(pruned.step_count(), whole.step_count());
    std::vector<uint8_t> bytes(256 * 256 * 3);
    for (size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<uint8_t>((i * 7919 + i / 768 * 31) >> 3);
    std::vector<float> input(bytes.size());
    for (size_t i = 0; i < bytes.size(); ++i) input[i] = bytes[i] / 255.0f;
    whole.set_input(input);
    whole.run();
    pruned.set_input_u8(bytes, 1 / 255.0f, 0);
    pruned.run();
    std::vector<float> a(117), b(117);
    whole.read_output(4, a);
    pruned.read_output(0, b);
    EXPECT_LT(test::relative_error(b, a), test::kLayerRelative);
  });
}

// Every operator of the model: what the device computes from its own inputs against the naive reference.
TEST_P(PoseNetwork, EveryLayerAgreesWithTheReference) {
  LIVECAP_MODEL_OR_SKIP(model, GetParam());
  nn::Graph graph = nn::load_tflite(model);
  graph.outputs.clear();
  std::vector<int> all;
  for (const nn::Op& op : graph.ops) {
    all.push_back(static_cast<int>(graph.outputs.size()));
    graph.outputs.push_back(op.output);
  }
  std::vector<float> input(256 * 256 * 3);
  for (size_t i = 0; i < input.size(); ++i)
    input[i] =
        0.5f + 0.5f * std::sin(0.013f * static_cast<float>(i % 768) + 0.0007f * static_cast<float>(i / 768 * i / 768));
  test::on_every_device([&](ocl::DeviceContext& device) {
    nn::Executor net(device, graph, all, false);
    net.set_input(input);
    net.run();
    std::vector<std::vector<float>> values(graph.tensors.size());
    values[graph.inputs[0]] = input;
    for (size_t i = 0; i < graph.ops.size(); ++i) {
      values[graph.ops[i].output].resize(nn::element_count(net.output_shape(i)));
      net.read_output(i, values[graph.ops[i].output]);
    }
    for (size_t i = 0; i < graph.ops.size(); ++i) {
      const std::vector<float> expected = nn::reference_op(graph, graph.ops[i], values);
      double worst = 0, largest = 1e-3;
      for (size_t k = 0; k < expected.size(); ++k) {
        const double difference = std::abs(double(expected[k]) - values[graph.ops[i].output][k]);
        worst = difference <= worst ? worst : difference;
        largest = std::max<double>(largest, std::abs(expected[k]));
      }
      EXPECT_LT(worst / largest, test::kLayerRelative) << "operator " << i << " " << nn::op_name(graph.ops[i]);
    }
  });
}

}  // namespace
}  // namespace livecap
