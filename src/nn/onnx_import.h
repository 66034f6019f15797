// ONNX models into nn::Graph: the operators of convolutional segmentation networks (docs/formats.md, "Networks"). ONNX
// images are [1,C,H,W], the graph's [1,H,W,C]; weights are turned, batch normalisations and constant factors are folded
// into the convolution before them, activations become part of the operator before them.
#pragma once

#include <filesystem>
#include <string>

#include "nn/graph.h"

namespace livecap::nn {

// height, width: of the input, used where the file leaves them open. Throws IoError with one line naming the file and,
// where it applies, byte, node and attribute: missing, truncated or garbage file, unsupported operator or attribute,
// inconsistent shapes, a size that is open and not given.
Graph load_onnx(const std::filesystem::path& path, int height = 0, int width = 0);

// The same from memory; `name` stands for the file in messages.
Graph parse_onnx(const std::string& bytes, const std::string& name, int height = 0, int width = 0);

}  // namespace livecap::nn
