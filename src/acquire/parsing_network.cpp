#include "acquire/parsing_network.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "actor/labels.h"
#include "base/text.h"
#include "livecap/error.h"
#include "nn/onnx_import.h"

namespace livecap::acquire {

namespace {

constexpr int kOpenSide = 512;
constexpr double kAround = 0.1;  // of the person's size, on each side

// The first output that can be labels.
int output_of(const nn::Graph& graph) {
  std::string shapes;
  for (const bool scores : {true, false}) {
    for (size_t i = 0; i < graph.outputs.size(); ++i) {
      const nn::Shape& shape = graph.tensors[graph.outputs[i]].shape;  // [1,h,w,channels]
      if (shape.size() == 4 && shape[3] == (scores ? kLabelCount : 1)) return static_cast<int>(i);
      if (scores && shape.size() == 4)
        shapes += format("%s[1,%d,%d,%d]", shapes.empty() ? "" : " ", shape[3], shape[1], shape[2]);
    }
  }
  throw IoError(graph.name + format(": output %s; one must be [1,%d,h,w], scores of the classes of LIP, or [1,h,w], "
                                    "their ids",
                                    shapes.c_str(), kLabelCount));
}

nn::Executor load(ocl::DeviceContext& device, const ParserOptions& options) {
  const nn::Graph graph = nn::load_onnx(options.network, kOpenSide, kOpenSide);
  const nn::Shape& input = graph.tensors[graph.inputs.front()].shape;
  if (input[3] != 3) throw IoError(graph.name + format(": input of %d channels, must be 3 (a picture)", input[3]));
  return nn::Executor(device, graph, {output_of(graph)});
}

}  // namespace

void ParserOptions::validate() const {
  for (double d : deviation)
    if (!(d > 0 && d < 1e6)) throw ConfigError(format("--parser-std %g; must be positive", d));
  for (double m : mean)
    if (!(std::abs(m) < 1e6)) throw ConfigError(format("--parser-mean %g; colours are 0..1", m));
}

ParsingNetwork::ParsingNetwork(ocl::DeviceContext& device, const ParserOptions& options)
    : options_(options), net_(load(device, options)), output_(nn::element_count(net_.output_shape(0))) {}

ParsingNetwork::Box ParsingNetwork::box_of(const ImageRgb& image, const ImageGray& mask) const {
  int left = mask.width, top = mask.height, right = -1, bottom = -1;
  for (int y = 0; y < mask.height; ++y)
    for (int x = 0; x < mask.width; ++x) {
      if (mask.pixels[static_cast<size_t>(y) * mask.width + x] <= 127) continue;
      left = std::min(left, x), right = std::max(right, x);
      top = std::min(top, y), bottom = std::max(bottom, y);
    }
  Box box{0, 0, static_cast<double>(image.width), static_cast<double>(image.height)};
  if (right >= 0) {
    const double around = kAround * std::max(right - left + 1, bottom - top + 1);
    box = {left - around, top - around, right - left + 1 + 2 * around, bottom - top + 1 + 2 * around};
  }
  const double aspect = static_cast<double>(net_.input_shape()[2]) / net_.input_shape()[1];
  const double width = std::max(box.width, aspect * box.height), height = width / aspect;
  return {box.x - (width - box.width) / 2, box.y - (height - box.height) / 2, width, height};
}

void ParsingNetwork::set_input(const ImageRgb& image, const Box& box) {
  const int height = net_.input_shape()[1], width = net_.input_shape()[2];
  const cv::Mat from(image.height, image.width, CV_8UC3, const_cast<uint8_t*>(image.pixels.data()));
  const double sx = box.width / width, sy = box.height / height;
  cv::Mat averaged = from, seen;
  if (const int factor = static_cast<int>(std::min(sx, sy)); factor > 1) cv::blur(from, averaged, {factor, factor});
  const cv::Matx23d map(sx, 0, box.x + 0.5 * sx - 0.5, 0, sy, box.y + 0.5 * sy - 0.5);
  const auto& mean = options_.mean;
  // Beside the picture the network sees the mean colour.
  cv::warpAffine(averaged, seen, map, {width, height}, cv::INTER_LINEAR | cv::WARP_INVERSE_MAP, cv::BORDER_CONSTANT,
                 {255 * mean[0], 255 * mean[1], 255 * mean[2]});
  std::vector<float> values(static_cast<size_t>(3) * width * height);
  for (size_t i = 0; i < values.size(); ++i) {
    const size_t c = i % 3;
    const double value = (seen.data[i] / 255.0 - mean[c]) / options_.deviation[c];
    values[options_.bgr ? i - c + 2 - c : i] = static_cast<float>(value);
  }
  net_.set_input(values);
}

ImageGray ParsingNetwork::labels(const ImageRgb& image, const ImageGray& mask) {
  const Box box = box_of(image, mask);
  set_input(image, box);
  net_.run();
  net_.read_output(0, output_);
  const nn::Shape& shape = net_.output_shape(0);
  const int rows = shape[1], columns = shape[2], n = shape[3];
  ImageGray result{image.width, image.height, std::vector<uint8_t>(static_cast<size_t>(image.width) * image.height)};
  for (int y = 0; y < image.height; ++y) {
    const double v = (y + 0.5 - box.y) * rows / box.height;  // the network's pixel j covers j..j+1
    if (!(v >= 0 && v < rows)) continue;
    for (int x = 0; x < image.width; ++x) {
      const double u = (x + 0.5 - box.x) * columns / box.width;
      if (!(u >= 0 && u < columns)) continue;
      uint8_t& label = result.pixels[static_cast<size_t>(y) * image.width + x];
      const auto at = [&](int j, int i) {
        return &output_[(static_cast<size_t>(std::clamp(j, 0, rows - 1)) * columns + std::clamp(i, 0, columns - 1)) *
                        n];
      };
      if (n == 1) {
        const float id = *at(static_cast<int>(v), static_cast<int>(u));
        label = id >= 0 && id < 255 ? static_cast<uint8_t>(std::lround(id)) : 255;
        continue;
      }
      // Scores between the network's pixels, so that borders are as smooth as they are.
      const int i = static_cast<int>(std::floor(u - 0.5)), j = static_cast<int>(std::floor(v - 0.5));
      const float fu = static_cast<float>(u - 0.5 - i), fv = static_cast<float>(v - 0.5 - j);
      const float *p00 = at(j, i), *p01 = at(j, i + 1), *p10 = at(j + 1, i), *p11 = at(j + 1, i + 1);
      float best = -INFINITY;
      for (int c = 0; c < n; ++c) {
        const float score = (1 - fv) * ((1 - fu) * p00[c] + fu * p01[c]) + fv * ((1 - fu) * p10[c] + fu * p11[c]);
        if (score > best) best = score, label = static_cast<uint8_t>(c);
      }
    }
  }
  return result;
}

}  // namespace livecap::acquire
