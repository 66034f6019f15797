#include "nn/tflite_import.h"

#include <cstring>
#include <map>
#include <optional>

#include "base/text.h"
#include "livecap/error.h"
#include "nn/half.h"
#include "tflite_subset_generated.h"

namespace livecap::nn {
namespace {

// Builtin operator codes of the format that are read.
enum Code {
  kAdd = 0,
  kConv2d = 3,
  kDepthwiseConv2d = 4,
  kDequantize = 6,
  kLogistic = 14,
  kMaxPool2d = 17,
  kReshape = 22,
  kResizeBilinear = 23,
  kCustom = 32,
  kPad = 34,
};

// Names for the message about an operator that is not supported.
const char* code_name(int code) {
  constexpr const char* kNames[] = {"ADD",
                                    "AVERAGE_POOL_2D",
                                    "CONCATENATION",
                                    "CONV_2D",
                                    "DEPTHWISE_CONV_2D",
                                    "DEPTH_TO_SPACE",
                                    "DEQUANTIZE",
                                    "EMBEDDING_LOOKUP",
                                    "FLOOR",
                                    "FULLY_CONNECTED",
                                    "HASHTABLE_LOOKUP",
                                    "L2_NORMALIZATION",
                                    "L2_POOL_2D",
                                    "LOCAL_RESPONSE_NORMALIZATION",
                                    "LOGISTIC",
                                    "LSH_PROJECTION",
                                    "LSTM",
                                    "MAX_POOL_2D",
                                    "MUL",
                                    "RELU",
                                    "RELU_N1_TO_1",
                                    "RELU6",
                                    "RESHAPE",
                                    "RESIZE_BILINEAR",
                                    "RNN",
                                    "SOFTMAX",
                                    "SPACE_TO_DEPTH",
                                    "SVDF",
                                    "TANH",
                                    "CONCAT_EMBEDDINGS",
                                    "SKIP_GRAM",
                                    "CALL",
                                    "CUSTOM",
                                    "EMBEDDING_LOOKUP_SPARSE",
                                    "PAD"};
  return code >= 0 && code < int(std::size(kNames)) ? kNames[code] : nullptr;
}

class Importer {
 public:
  Importer(const std::string& bytes, const std::string& name) : bytes_(bytes) { graph_.name = name; }

  Graph run() {
    const auto* data = reinterpret_cast<const uint8_t*>(bytes_.data());
    if (bytes_.size() < 8 || std::memcmp(data + 4, tflite::ModelIdentifier(), 4) != 0)
      fail("not a TensorFlow Lite model (bytes 4-7 must be \"TFL3\")");
    if (bytes_.size() >= FLATBUFFERS_MAX_BUFFER_SIZE) fail("larger than 2 GiB");
    flatbuffers::Verifier verifier(data, bytes_.size());
    if (!tflite::VerifyModelBuffer(verifier)) fail("truncated or damaged: the flatbuffer does not verify");
    model_ = tflite::GetModel(data);
    if (model_->version() != 3) fail(format("format version %u, only 3 is known", model_->version()));
    if (!model_->subgraphs() || model_->subgraphs()->size() != 1) fail("must hold exactly one subgraph");
    if (!model_->operator_codes() || !model_->buffers()) fail("operator codes or buffers are missing");
    subgraph_ = model_->subgraphs()->Get(0);
    if (!subgraph_->tensors() || !subgraph_->operators() || !subgraph_->inputs() || !subgraph_->outputs())
      fail("the subgraph lacks tensors, operators, inputs or outputs");
    read_tensors();
    for (const tflite::Operator* op : *subgraph_->operators()) read_operator(*op);
    for (int index : *subgraph_->inputs()) graph_.inputs.push_back(index);
    for (int index : *subgraph_->outputs()) graph_.outputs.push_back(index);
    validate(graph_);
    return std::move(graph_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const { throw IoError(graph_.name + ": " + what); }
  [[noreturn]] void fail_op(const std::string& what) const { fail("operator " + op_label_ + ": " + what); }

  static std::string printable(const flatbuffers::String* text) {
    return text ? nn::printable({text->c_str(), text->size()}) : std::string();
  }

  void read_tensors() {
    for (const tflite::Tensor* tensor : *subgraph_->tensors()) {
      Tensor out;
      out.name = printable(tensor->name());
      if (tensor->shape()) out.shape.assign(tensor->shape()->begin(), tensor->shape()->end());
      if (tensor->buffer() >= model_->buffers()->size())
        fail(format("tensor \"%s\": buffer %u of %u", out.name.c_str(), tensor->buffer(), model_->buffers()->size()));
      const int64_t count = element_count(out.shape);
      if (out.shape.size() > 4 || count > kMaxElements)
        fail(format("tensor \"%s\": shape %s must have at most 4 dimensions, all fixed and positive", out.name.c_str(),
                    to_string(out.shape).c_str()));
      const auto* data = model_->buffers()->Get(tensor->buffer())->data();
      if (data && data->size() > 0) {
        const int size = tensor->type() == tflite::TensorType_FLOAT16 ? 2
                         : tensor->type() == tflite::TensorType_FLOAT32 || tensor->type() == tflite::TensorType_INT32
                             ? 4
                             : 0;
        if (size > 0 && int64_t(data->size()) != count * size)
          fail(format("tensor \"%s\": %u bytes for shape %s of %d-byte elements", out.name.c_str(), data->size(),
                      to_string(out.shape).c_str(), size));
        if (tensor->type() == tflite::TensorType_FLOAT32) {
          out.is_constant = true;
          count_constant(count);
          out.values.resize(count);
          std::memcpy(out.values.data(), data->data(), data->size());
        }
      }
      graph_.tensors.push_back(std::move(out));
    }
  }

  void count_constant(int64_t count) {
    n_constants_ += count;
    if (n_constants_ > kMaxElements) fail("all constants together are more than 2^28 numbers");
  }

  const tflite::Tensor& source(int index) const {
    if (index < 0 || index >= int(graph_.tensors.size()))
      fail_op(format("tensor %d of %zu", index, graph_.tensors.size()));
    return *subgraph_->tensors()->Get(index);
  }

  const flatbuffers::Vector<uint8_t>* data_of(int index) const {
    return model_->buffers()->Get(source(index).buffer())->data();
  }

  // A constant int32 tensor.
  std::vector<int> integers(int index) const {
    const auto* data = data_of(index);
    if (source(index).type() != tflite::TensorType_INT32 || !data || data->size() == 0)
      fail_op("input \"" + graph_.tensors[index].name + "\" must be a constant int32 tensor");
    std::vector<int> values(data->size() / 4);
    std::memcpy(values.data(), data->data(), values.size() * 4);
    return values;
  }

  void read_operator(const tflite::Operator& op) {
    op_label_ = format("#%zu", n_read_++);
    if (op.opcode_index() >= model_->operator_codes()->size())
      fail_op(format("operator code %u of %u", op.opcode_index(), model_->operator_codes()->size()));
    const tflite::OperatorCode& opcode = *model_->operator_codes()->Get(op.opcode_index());
    const int code = std::max<int>(opcode.deprecated_builtin_code(), opcode.builtin_code());
    op_label_ =
        (code_name(code) ? std::string(code_name(code)) : format("with builtin code %d", code)) + " " + op_label_;
    if (code == kCustom) op_label_ += " \"" + printable(opcode.custom_code()) + "\"";

    Op out;
    if (op.inputs()) out.inputs.assign(op.inputs()->begin(), op.inputs()->end());
    if (!op.outputs() || op.outputs()->size() != 1) fail_op("must have exactly one output");
    out.output = op.outputs()->Get(0);
    source(out.output);
    for (int index : out.inputs) {
      if (index != -1) source(index);
    }
    const size_t n_inputs = out.inputs.size();
    if (n_inputs == 0 || out.inputs[0] < 0) fail_op("has no input");
    if (code != kDequantize) {
      if (source(out.output).type() != tflite::TensorType_FLOAT32 ||
          source(out.inputs[0]).type() != tflite::TensorType_FLOAT32)
        fail_op("only float32 activations are supported (quantised models are not)");
    }

    switch (code) {
      case kDequantize:
        dequantize(out.inputs[0], out.output);
        return;
      case kConv2d: {
        const auto* options = op.builtin_options_as_Conv2DOptions();
        if (!options || n_inputs < 2 || n_inputs > 3) fail_op("has no convolution options or not 2-3 inputs");
        const Shape kernel = kernel_shape(out.inputs[1]);
        out.attributes = Conv2d{window(out.inputs[0], options->padding(), kernel[1], kernel[2], options->stride_h(),
                                       options->stride_w(), options->dilation_h(), options->dilation_w())};
        out.activation = activation(options->activation());
        out.inputs.resize(3, -1);
        break;
      }
      case kDepthwiseConv2d: {
        const auto* options = op.builtin_options_as_DepthwiseConv2DOptions();
        if (!options || n_inputs < 2 || n_inputs > 3) fail_op("has no convolution options or not 2-3 inputs");
        const Shape kernel = kernel_shape(out.inputs[1]);
        out.attributes =
            DepthwiseConv2d{window(out.inputs[0], options->padding(), kernel[1], kernel[2], options->stride_h(),
                                   options->stride_w(), options->dilation_h(), options->dilation_w())};
        out.activation = activation(options->activation());
        out.inputs.resize(3, -1);
        break;
      }
      case kAdd: {
        const auto* options = op.builtin_options_as_AddOptions();
        if (n_inputs != 2) fail_op("must have 2 inputs");
        out.attributes = Add{};
        if (options) out.activation = activation(options->activation());
        break;
      }
      case kMaxPool2d: {
        const auto* options = op.builtin_options_as_Pool2DOptions();
        if (!options || n_inputs != 1) fail_op("has no pooling options or not 1 input");
        out.attributes = MaxPool2d{window(out.inputs[0], options->padding(), options->filter_height(),
                                          options->filter_width(), options->stride_h(), options->stride_w(), 1, 1),
                                   options->filter_height(), options->filter_width()};
        out.activation = activation(options->activation());
        break;
      }
      case kPad: {
        if (n_inputs != 2) fail_op("must have 2 inputs");
        const std::vector<int> amounts = integers(out.inputs[1]);
        if (amounts.size() != 8 || amounts[0] != 0 || amounts[1] != 0)
          fail_op("paddings must be [4,2] without batch padding");
        out.attributes = Pad{{amounts[2], amounts[3]}, {amounts[4], amounts[5]}, {amounts[6], amounts[7]}};
        out.inputs.resize(1);
        break;
      }
      case kResizeBilinear: {
        const auto* options = op.builtin_options_as_ResizeBilinearOptions();
        if (n_inputs != 2) fail_op("must have 2 inputs");
        const std::vector<int> size = integers(out.inputs[1]);
        if (size.size() != 2) fail_op("size must hold 2 numbers");
        out.attributes = ResizeBilinear{size[0], size[1], options && options->align_corners(),
                                        options && options->half_pixel_centers()};
        out.inputs.resize(1);
        break;
      }
      case kReshape:
        // The stated output shape is what the operator's own shape input resolves to.
        out.attributes = Reshape{graph_.tensors[out.output].shape};
        out.inputs.resize(1);
        break;
      case kLogistic:
        out.attributes = Logistic{};
        out.inputs.resize(1);
        break;
      default:
        fail_op(
            "is not supported (supported: CONV_2D, DEPTHWISE_CONV_2D, ADD, MAX_POOL_2D, PAD, RESIZE_BILINEAR, RESHAPE, "
            "LOGISTIC, DEQUANTIZE)");
    }
    graph_.ops.push_back(std::move(out));
  }

  void dequantize(int from, int to) {
    const auto* data = data_of(from);
    if (source(from).type() != tflite::TensorType_FLOAT16 || source(to).type() != tflite::TensorType_FLOAT32 || !data ||
        data->size() == 0)
      fail_op("only float16 constants can be dequantized");
    Tensor& out = graph_.tensors[to];
    if (out.is_constant || out.shape != graph_.tensors[from].shape)
      fail_op("output \"" + out.name + "\" does not match its input");
    out.is_constant = true;
    count_constant(data->size() / 2);
    out.values.resize(data->size() / 2);
    for (size_t i = 0; i < out.values.size(); ++i)
      out.values[i] = float_from_half(flatbuffers::ReadScalar<uint16_t>(data->data() + 2 * i));
  }

  Shape kernel_shape(int index) const {
    if (index < 0 || graph_.tensors[index].shape.size() != 4) fail_op("weights must have 4 dimensions");
    return graph_.tensors[index].shape;
  }

  Activation activation(tflite::Activation activation) const {
    switch (activation) {
      case tflite::Activation_NONE:
        return Activation::kNone;
      case tflite::Activation_RELU:
        return Activation::kRelu;
      case tflite::Activation_RELU6:
        return Activation::kRelu6;
      default:
        fail_op(
            format("fused activation %d is not supported (none, RELU and RELU6 are)", static_cast<int>(activation)));
    }
  }

  // TFLite's padding: SAME gives ceil(size / stride) outputs, the odd pixel goes to the end.
  Window window(int input, tflite::Padding padding, int kernel_h, int kernel_w, int stride_h, int stride_w,
                int dilation_h, int dilation_w) const {
    const Shape& x = graph_.tensors[input].shape;
    if (x.size() != 4) fail_op("input shape " + to_string(x) + " must be [1,height,width,channels]");
    if (padding != tflite::Padding_SAME && padding != tflite::Padding_VALID)
      fail_op(format("padding %d is unknown", static_cast<int>(padding)));
    for (int value : {kernel_h, kernel_w, stride_h, stride_w, dilation_h, dilation_w}) {
      if (value < 1 || value > 4096) fail_op(format("kernel, stride or dilation %d must be in 1..4096", value));
    }
    Window out{stride_h, stride_w, dilation_h, dilation_w, 0, 0, 0, 0};
    if (padding == tflite::Padding_SAME) {
      auto split = [](int64_t size, int64_t kernel, int64_t stride, int64_t dilation, int& before, int& after) {
        const int64_t outputs = (size + stride - 1) / stride;
        const int64_t total = std::max<int64_t>((outputs - 1) * stride + (kernel - 1) * dilation + 1 - size, 0);
        before = static_cast<int>(total / 2);
        after = static_cast<int>(total - total / 2);
      };
      split(x[1], kernel_h, stride_h, dilation_h, out.pad_top, out.pad_bottom);
      split(x[2], kernel_w, stride_w, dilation_w, out.pad_left, out.pad_right);
    }
    return out;
  }

  const std::string& bytes_;
  Graph graph_;
  const tflite::Model* model_ = nullptr;
  const tflite::SubGraph* subgraph_ = nullptr;
  std::string op_label_;
  size_t n_read_ = 0;
  int64_t n_constants_ = 0;
};

}  // namespace

Graph load_tflite(const std::filesystem::path& path) {
  return parse_tflite(read_file(path), path.string());
}

Graph parse_tflite(const std::string& bytes, const std::string& name) {
  return Importer(bytes, name).run();
}

}  // namespace livecap::nn
