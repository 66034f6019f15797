// The parts of ONNX's ModelProto (onnx.proto, IR versions 3 and later) that the importer reads. Texts and raw data
// point into the file's bytes.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace livecap::nn {

using Dims = std::vector<int64_t>;

std::string to_string(const Dims& dims);  // "[1,3,256,256]"; -1, not known, is "?"

struct OnnxTensor {
  std::string_view name;
  Dims dims;
  int type = 0;                   // TensorProto.DataType
  std::string_view raw;           // raw_data
  std::vector<float> floats;      // float_data
  std::vector<int64_t> integers;  // int32_data, int64_data; the bits of halves
  std::vector<double> doubles;    // double_data
};

// Elements of the tensor, whatever its stored type. parse_onnx_model has checked that they are there.
std::vector<float> float_values(const OnnxTensor& tensor);
std::vector<double> double_values(const OnnxTensor& tensor);

struct OnnxAttribute {
  enum Type { kFloat = 1, kInt = 2, kString = 3, kTensor = 4, kGraph = 5, kFloats = 6, kInts = 7 };
  std::string_view name;
  int type = 0;
  float real = 0;
  int64_t integer = 0;
  std::string_view text;
  OnnxTensor tensor;
  std::vector<float> reals;
  std::vector<int64_t> integers;
};

struct OnnxNode {
  std::string_view name;
  std::string_view type;  // "Conv"
  std::string_view domain;
  std::vector<std::string_view> inputs;  // names of values; "" = an optional one that is not there
  std::vector<std::string_view> outputs;
  std::vector<OnnxAttribute> attributes;
};

struct OnnxValueInfo {
  std::string_view name;
  int type = 0;  // TensorProto.DataType; 0 = not stated
  bool has_shape = false;
  Dims dims;  // -1 = open
};

struct OnnxModel {
  int64_t opset = 0;  // of the standard operators
  std::vector<OnnxNode> nodes;
  std::vector<OnnxTensor> initializers;
  std::vector<OnnxValueInfo> inputs;
  std::vector<OnnxValueInfo> outputs;
};

// `bytes` must outlive the model. Throws IoError with one line naming `file`, the byte or the tensor, and what is
// wrong.
OnnxModel parse_onnx_model(const std::string& bytes, const std::string& file);

}  // namespace livecap::nn
