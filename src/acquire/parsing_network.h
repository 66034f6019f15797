// Label images from a human parsing network of the user's, in ONNX: what clothes and body parts a picture shows (paper,
// "Actor Model Acquisition": Gong et al.'s network, trained on Look into Person).
#pragma once

#include <array>
#include <filesystem>

#include "base/image_rgb.h"
#include "nn/executor.h"
#include "ocl/context.h"

namespace livecap::acquire {

struct ParserOptions {
  std::filesystem::path network;  // .onnx; empty: none
  // Of red, green and blue in 0..1: the network sees (value - mean) / deviation. ImageNet's.
  std::array<double, 3> mean = {0.485, 0.456, 0.406};
  std::array<double, 3> deviation = {0.229, 0.224, 0.225};
  bool bgr = false;  // the network's first channel is blue

  void validate() const;  // throws ConfigError
};

class ParsingNetwork {
 public:
  // The network's input is [1,3,height,width] (512 x 512 where the file leaves it open), one of its outputs
  // [1,20,h,w], scores of the LIP classes, or [1,h,w], their ids. Throws IoError.
  ParsingNetwork(ocl::DeviceContext& device, const ParserOptions& options);

  // LIP ids, of the picture's size. The network sees the person of the mask and a tenth of their size around them, in
  // its input's aspect ratio; 0 outside of that. An empty mask: the whole picture.
  ImageGray labels(const ImageRgb& image, const ImageGray& mask);

 private:
  // Part of a picture, in its pixels; may reach beyond it.
  struct Box {
    double x, y, width, height;
  };
  Box box_of(const ImageRgb& image, const ImageGray& mask) const;
  void set_input(const ImageRgb& image, const Box& box);

  ParserOptions options_;
  nn::Executor net_;
  std::vector<float> output_;
};

}  // namespace livecap::acquire
