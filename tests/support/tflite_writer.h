// Small networks in TensorFlow Lite's bytes, written with the tables that FlatBuffers made of the importer's schema.
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "tflite_subset_generated.h"

namespace livecap::test {

// Tensors, operators and buffers in the order in which they are added. Buffer 0 is the empty one.
class TfliteWriter {
 public:
  TfliteWriter() { buffer({}); }

  uint32_t buffer(const std::vector<uint8_t>& data) {
    buffers_.push_back(nn::tflite::CreateBuffer(builder_, data.empty() ? 0 : builder_.CreateVector(data)));
    return static_cast<uint32_t>(buffers_.size()) - 1;
  }
  template <typename T>
  uint32_t buffer_of(const std::vector<T>& values) {
    std::vector<uint8_t> data(values.size() * sizeof(T));
    std::memcpy(data.data(), values.data(), data.size());
    return buffer(data);
  }
  int tensor(const std::vector<int>& shape, uint32_t buffer = 0,
             nn::tflite::TensorType type = nn::tflite::TensorType_FLOAT32) {
    const std::string name = "t" + std::to_string(tensors_.size());
    tensors_.push_back(
        nn::tflite::CreateTensor(builder_, builder_.CreateVector(shape), type, buffer, builder_.CreateString(name)));
    return static_cast<int>(tensors_.size()) - 1;
  }
  int floats(const std::vector<int>& shape, const std::vector<float>& values) {
    return tensor(shape, buffer_of(values));
  }
  int integers(const std::vector<int>& shape, const std::vector<int>& values) {
    return tensor(shape, buffer_of(values), nn::tflite::TensorType_INT32);
  }
  // `code`: of the builtin operator. Returns the output.
  int op(int code, const std::vector<int>& inputs, const std::vector<int>& shape,
         nn::tflite::BuiltinOptions options_type = nn::tflite::BuiltinOptions_NONE,
         flatbuffers::Offset<void> options = 0) {
    const int output = tensor(shape);
    codes_.push_back(nn::tflite::CreateOperatorCode(builder_, static_cast<int8_t>(code), 0, 1, code));
    operators_.push_back(
        nn::tflite::CreateOperator(builder_, static_cast<uint32_t>(codes_.size()) - 1, builder_.CreateVector(inputs),
                                   builder_.CreateVector(std::vector<int>{output}), options_type, options));
    return output;
  }
  std::string model(const std::vector<int>& inputs, const std::vector<int>& outputs) {
    const auto graph =
        nn::tflite::CreateSubGraph(builder_, builder_.CreateVector(tensors_), builder_.CreateVector(inputs),
                                   builder_.CreateVector(outputs), builder_.CreateVector(operators_));
    const std::vector<flatbuffers::Offset<nn::tflite::SubGraph>> graphs = {graph};
    builder_.Finish(nn::tflite::CreateModel(builder_, 3, builder_.CreateVector(codes_), builder_.CreateVector(graphs),
                                            0, builder_.CreateVector(buffers_)),
                    nn::tflite::ModelIdentifier());
    return {reinterpret_cast<const char*>(builder_.GetBufferPointer()), builder_.GetSize()};
  }
  flatbuffers::FlatBufferBuilder& builder() { return builder_; }

 private:
  flatbuffers::FlatBufferBuilder builder_;
  std::vector<flatbuffers::Offset<nn::tflite::Buffer>> buffers_;
  std::vector<flatbuffers::Offset<nn::tflite::Tensor>> tensors_;
  std::vector<flatbuffers::Offset<nn::tflite::OperatorCode>> codes_;
  std::vector<flatbuffers::Offset<nn::tflite::Operator>> operators_;
};

// The importer's operators on an image of 4 x 4.
inline std::string small_tflite() {
  using namespace nn::tflite;
  TfliteWriter net;
  auto& b = net.builder();
  const int x = net.tensor({1, 4, 4, 2});
  const uint32_t halves = net.buffer_of(std::vector<uint16_t>(2 * 3 * 3 * 2, 0x3800));
  const int weights = net.op(6, {net.tensor({2, 3, 3, 2}, halves, TensorType_FLOAT16)}, {2, 3, 3, 2});
  const int conv = net.op(3, {x, weights, net.floats({2}, {0.5f, -1})}, {1, 4, 4, 2}, BuiltinOptions_Conv2DOptions,
                          CreateConv2DOptions(b, Padding_SAME, 1, 1, Activation_RELU6).Union());
  const int deep = net.op(4, {conv, net.floats({1, 1, 1, 2}, {2, 3}), net.floats({2}, {0, 1})}, {1, 4, 4, 2},
                          BuiltinOptions_DepthwiseConv2DOptions,
                          CreateDepthwiseConv2DOptions(b, Padding_VALID, 1, 1, 1, Activation_NONE).Union());
  const int sum =
      net.op(0, {deep, x}, {1, 4, 4, 2}, BuiltinOptions_AddOptions, CreateAddOptions(b, Activation_RELU).Union());
  const int pooled = net.op(17, {sum}, {1, 2, 2, 2}, BuiltinOptions_Pool2DOptions,
                            CreatePool2DOptions(b, Padding_VALID, 2, 2, 2, 2).Union());
  const int padded = net.op(34, {pooled, net.integers({4, 2}, {0, 0, 0, 1, 1, 0, 0, 0})}, {1, 3, 3, 2});
  const int sized = net.op(23, {padded, net.integers({2}, {5, 5})}, {1, 5, 5, 2}, BuiltinOptions_ResizeBilinearOptions,
                           CreateResizeBilinearOptions(b, false, true).Union());
  const int flat = net.op(22, {sized}, {1, 50});
  return net.model({x}, {net.op(14, {flat}, {1, 50}), pooled});
}

}  // namespace livecap::test
