// The pose network by kernels/nn against OpenCV DNN on one thread: the same graph with all its outputs, built layer by
// layer (OpenCV 4.6 reads no .tflite). Both must give the same numbers.
//
//   bench_network [--device=SELECTOR] [Google Benchmark's options]
#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdio>
#include <numeric>
#include <opencv2/core.hpp>
#include <opencv2/dnn.hpp>
#include <random>
#include <stdexcept>
#include <string>

#include "base/text.h"
#include "detect/find_model.h"
#include "nn/executor.h"
#include "nn/tflite_import.h"
#include "ocl/context.h"
#include "race.h"

namespace livecap {
namespace {

// Layers with channels first. One output per tensor, named after its index.
class DnnBuilder {
 public:
  explicit DnnBuilder(const nn::Graph& graph) : graph_(graph), layer_(graph.tensors.size(), 0) {
    net_.setInputsNames({"x"});
    for (const nn::Op& op : graph.ops) {
      op_ = &op;
      int layer = std::visit([&](const auto& attributes) { return add(attributes); }, op.attributes);
      if (op.activation == nn::Activation::kRelu6) {
        cv::dnn::LayerParams params;
        layer = append("ReLU6", params, {layer});
      } else if (op.activation == nn::Activation::kRelu) {
        cv::dnn::LayerParams params;
        layer = append("ReLU", params, {layer});
      }
      layer_[op.output] = layer;
    }
  }

  cv::dnn::Net net() const { return net_; }
  std::vector<std::string> outputs() const {
    std::vector<std::string> names;
    for (int tensor : graph_.outputs) names.push_back("l" + std::to_string(layer_[tensor]));
    return names;
  }

 private:
  int append(const char* type, cv::dnn::LayerParams& params, const std::vector<int>& from) {
    params.type = type;
    const int id = net_.addLayer("l" + std::to_string(net_.getLayerNames().size() + 1), type, params);
    for (size_t i = 0; i < from.size(); ++i) net_.connect(from[i], 0, id, int(i));
    return id;
  }
  int input(int i) const { return layer_[op_->inputs[i]]; }

  int padded(int from, int top, int bottom, int left, int right) {
    if (top == 0 && bottom == 0 && left == 0 && right == 0) return from;
    cv::dnn::LayerParams params;
    const int pads[] = {0, 0, 0, 0, top, bottom, left, right};
    params.set("paddings", cv::dnn::DictValue::arrayInt(pads, 8));
    return append("Padding", params, {from});
  }

  // weights [Cout, KH, KW, Cin], of a depthwise convolution [1, KH, KW, C].
  int convolution(const nn::Window& w, bool depthwise) {
    const nn::Tensor& weights = graph_.tensors[op_->inputs[1]];
    const int out = depthwise ? weights.shape[3] : weights.shape[0], kh = weights.shape[1], kw = weights.shape[2];
    const int in = depthwise ? 1 : weights.shape[3];
    cv::dnn::LayerParams params;
    params.set("kernel_h", kh);
    params.set("kernel_w", kw);
    params.set("stride_h", w.stride_h);
    params.set("stride_w", w.stride_w);
    params.set("dilation_h", w.dilation_h);
    params.set("dilation_w", w.dilation_w);
    params.set("num_output", out);
    params.set("group", depthwise ? out : 1);
    const bool even = w.pad_top == w.pad_bottom && w.pad_left == w.pad_right;
    params.set("pad_h", even ? w.pad_top : 0);
    params.set("pad_w", even ? w.pad_left : 0);
    const int sizes[] = {out, in, kh, kw};
    cv::Mat blob(4, sizes, CV_32F), bias(1, out, CV_32F, cv::Scalar(0));
    for (int o = 0; o < out; ++o)
      for (int i = 0; i < in; ++i)
        for (int y = 0; y < kh; ++y)
          for (int x = 0; x < kw; ++x) {
            const int at[] = {o, i, y, x};
            blob.at<float>(at) = depthwise ? weights.values[(size_t(y) * kw + x) * out + o]
                                           : weights.values[((size_t(o) * kh + y) * kw + x) * in + i];
          }
    if (op_->inputs.size() > 2 && op_->inputs[2] >= 0)
      for (int o = 0; o < out; ++o) bias.at<float>(o) = graph_.tensors[op_->inputs[2]].values[o];
    params.blobs = {blob, bias};
    const int from = even ? input(0) : padded(input(0), w.pad_top, w.pad_bottom, w.pad_left, w.pad_right);
    return append("Convolution", params, {from});
  }

  int add(const nn::Conv2d& conv) { return convolution(conv.window, false); }
  int add(const nn::DepthwiseConv2d& conv) { return convolution(conv.window, true); }
  int add(const nn::Add&) {
    cv::dnn::LayerParams params;
    params.set("operation", "sum");
    return append("Eltwise", params, {input(0), input(1)});
  }
  int add(const nn::MaxPool2d& pool) {
    cv::dnn::LayerParams params;
    params.set("pool", "max");
    params.set("kernel_h", pool.kernel_h);
    params.set("kernel_w", pool.kernel_w);
    params.set("stride_h", pool.window.stride_h);
    params.set("stride_w", pool.window.stride_w);
    params.set("ceil_mode", false);
    return append("Pooling", params, {input(0)});
  }
  int add(const nn::Pad& pad) {
    cv::dnn::LayerParams params;
    const int pads[] = {0,           0, pad.channels[0], pad.channels[1], pad.height[0], pad.height[1], pad.width[0],
                        pad.width[1]};
    params.set("paddings", cv::dnn::DictValue::arrayInt(pads, 8));
    return append("Padding", params, {input(0)});
  }
  int add(const nn::ResizeBilinear& resize) {
    cv::dnn::LayerParams params;
    params.set("interpolation", "bilinear");
    params.set("height", resize.height);
    params.set("width", resize.width);
    params.set("align_corners", resize.align_corners);
    params.set("half_pixel_centers", resize.half_pixel_centers);
    return append("Resize", params, {input(0)});
  }
  int add(const nn::Reshape&) { return input(0); }  // the outputs', of one pixel
  int add(const nn::Logistic&) {
    cv::dnn::LayerParams params;
    return append("Sigmoid", params, {input(0)});
  }
  template <typename Other>
  int add(const Other&) {
    throw std::runtime_error(std::string("no peer for ") + nn::op_name(*op_));
  }

  const nn::Graph& graph_;
  const nn::Op* op_ = nullptr;
  std::vector<int> layer_;  // by tensor; 0 = the input
  cv::dnn::Net net_;
};

void add_contest(ocl::DeviceContext& device, const std::string& model) {
  const nn::Graph graph = nn::load_tflite(detect::find_model(model));
  std::vector<int> all(graph.outputs.size());
  std::iota(all.begin(), all.end(), 0);
  auto ours = std::make_shared<nn::Executor>(device, graph, all);
  const nn::Shape shape = ours->input_shape();
  std::mt19937 random(1);
  std::uniform_real_distribution<float> uniform(0, 1);
  std::vector<float> input(nn::element_count(shape));
  for (float& value : input) value = uniform(random);
  ours->set_input(input);
  const int sizes[] = {1, shape[3], shape[1], shape[2]};
  cv::Mat blob(4, sizes, CV_32F);
  for (int c = 0; c < shape[3]; ++c)
    for (int p = 0; p < shape[1] * shape[2]; ++p)
      blob.ptr<float>()[size_t(c) * shape[1] * shape[2] + p] = input[size_t(p) * shape[3] + c];
  const DnnBuilder builder(graph);
  auto net = std::make_shared<cv::dnn::Net>(builder.net());
  net->setPreferableBackend(cv::dnn::DNN_BACKEND_OPENCV);
  net->setInput(blob, "x");
  const std::vector<std::string> names = builder.outputs();
  std::vector<cv::Mat> results;
  net->forward(results, names);
  ours->run();
  for (size_t o = 0; o < names.size(); ++o) {
    const nn::Shape& s = ours->output_shape(o);
    std::vector<float> mine(nn::element_count(s));
    ours->read_output(o, mine);
    const size_t channels = s.size() == 4 ? s[3] : mine.size(), pixels = mine.size() / channels;
    double worst = 0, largest = 1;
    for (size_t i = 0; i < mine.size(); ++i) {
      const float theirs = results[o].ptr<float>()[(i % channels) * pixels + i / channels];
      worst = std::max(worst, std::abs(double(theirs) - mine[i]));
      largest = std::max(largest, std::abs(double(theirs)));
    }
    if (!(worst < 2e-3 * largest))
      throw std::runtime_error(
          format("%s: output %zu differs from OpenCV's by %g of %g", model.c_str(), o, worst, largest));
  }
  auto first = std::make_shared<std::vector<float>>(nn::element_count(ours->output_shape(0)));
  bench::register_contest({model + ", all outputs",
                           [ours, first] {
                             ours->run();
                             ours->read_output(0, *first);
                           },
                           "OpenCV DNN",
                           [net, names] {
                             std::vector<cv::Mat> outputs;
                             net->forward(outputs, names);
                           }});
}

int run(int argc, char** argv) {
  const std::string selector = bench::take_option(argc, argv, "device", "pocl");
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  cv::setNumThreads(1);
  ocl::DeviceContext device(ocl::select_device(selector));
  for (const char* model : {"lite", "full", "heavy"}) add_contest(device, model);
  benchmark::RunSpecifiedBenchmarks();
  return 0;
}

}  // namespace
}  // namespace livecap

int main(int argc, char** argv) {
  try {
    return livecap::run(argc, argv);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "bench_network: %s\n", error.what());
    return 1;
  }
}
