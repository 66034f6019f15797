// TensorFlow Lite models into nn::Graph. The file is verified as a flatbuffer before anything is read from it, then
// every index, shape and buffer size is checked; fp16 weights behind DEQUANTIZE become float32 constants.
#pragma once

#include <filesystem>
#include <string>

#include "nn/graph.h"

namespace livecap::nn {

// Throws IoError with one line naming the file and, where it applies, the operator: missing, truncated or garbage file,
// unsupported operator, type or option, inconsistent shapes.
Graph load_tflite(const std::filesystem::path& path);

// The same from memory; `name` stands for the file in messages.
Graph parse_tflite(const std::string& bytes, const std::string& name);

}  // namespace livecap::nn
