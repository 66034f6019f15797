#include "nn/onnx_model.h"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>

#include "base/text.h"
#include "livecap/error.h"
#include "nn/graph.h"
#include "nn/half.h"
#include "nn/protobuf_reader.h"

namespace livecap::nn {
namespace {

static_assert(std::endian::native == std::endian::little);  // raw data are little endian

enum DataType { kFloat32 = 1, kUint8 = 2, kInt8 = 3, kInt32 = 6, kInt64 = 7, kBool = 9, kFloat16 = 10, kDouble = 11 };

constexpr int64_t kOldestOpset = 7;

size_t element_bytes(int type) {
  switch (type) {
    case kFloat32:
    case kInt32:
      return 4;
    case kInt64:
    case kDouble:
      return 8;
    case kFloat16:
      return 2;
    case kUint8:
    case kInt8:
    case kBool:
      return 1;
    default:
      return 0;
  }
}

int64_t product(const Dims& dims) {
  int64_t count = 1;
  for (int64_t n : dims) {
    if (n < 0 || n > kMaxElements) return -1;
    count *= n;
    if (count > kMaxElements) return -1;
  }
  return count;
}

void check_tensor(const WireReader& at, const OnnxTensor& tensor, bool external) {
  const auto fail = [&](const std::string& what) { at.fail("tensor \"" + printable(tensor.name) + "\": " + what); };
  if (external) fail("its data are in another file; save the model with its weights inside");
  const size_t size = element_bytes(tensor.type);
  if (size == 0)
    fail(format("data type %d is not supported (float, float16, double, int32, int64, int8, uint8 and bool are)",
                tensor.type));
  const int64_t count = product(tensor.dims);
  if (count < 0) fail("shape " + to_string(tensor.dims) + " must have sizes >= 0 and at most 2^28 elements");
  size_t got = tensor.integers.size();
  if (!tensor.raw.empty()) {
    if (tensor.raw.size() % size != 0) fail(format("%zu bytes of elements of %zu", tensor.raw.size(), size));
    got = tensor.raw.size() / size;
  } else if (tensor.type == kFloat32) {
    got = tensor.floats.size();
  } else if (tensor.type == kDouble) {
    got = tensor.doubles.size();
  }
  if (got != static_cast<size_t>(count))
    fail(format("holds %zu values, shape ", got) + to_string(tensor.dims) + " needs " + std::to_string(count));
}

OnnxTensor parse_tensor(WireReader reader) {
  OnnxTensor tensor;
  bool external = false;
  const WireReader begin = reader;
  while (reader.next()) {
    switch (reader.field()) {
      case 1:
        reader.append_to(tensor.dims);
        break;
      case 2:
        tensor.type = static_cast<int>(reader.integer());
        break;
      case 4:
        reader.append_to(tensor.floats);
        break;
      case 5:
      case 7:
        reader.append_to(tensor.integers);
        break;
      case 8:
        tensor.name = reader.bytes();
        break;
      case 9:
        tensor.raw = reader.bytes();
        break;
      case 10:
        reader.append_to(tensor.doubles);
        break;
      case 13:
        external = true;
        break;
      case 14:
        external = external || reader.integer() == 1;
        break;
    }
  }
  check_tensor(begin, tensor, external);
  return tensor;
}

OnnxAttribute parse_attribute(WireReader reader) {
  OnnxAttribute attribute;
  while (reader.next()) {
    switch (reader.field()) {
      case 1:
        attribute.name = reader.bytes();
        break;
      case 2:
        attribute.real = reader.real();
        break;
      case 3:
        attribute.integer = reader.integer();
        break;
      case 4:
        attribute.text = reader.bytes();
        break;
      case 5:
        attribute.tensor = parse_tensor(reader.nested("TensorProto"));
        break;
      case 7:
        reader.append_to(attribute.reals);
        break;
      case 8:
        reader.append_to(attribute.integers);
        break;
      case 20:
        attribute.type = static_cast<int>(reader.integer());
        break;
    }
  }
  return attribute;
}

OnnxNode parse_node(WireReader reader) {
  OnnxNode node;
  while (reader.next()) {
    switch (reader.field()) {
      case 1:
        node.inputs.push_back(reader.bytes());
        break;
      case 2:
        node.outputs.push_back(reader.bytes());
        break;
      case 3:
        node.name = reader.bytes();
        break;
      case 4:
        node.type = reader.bytes();
        break;
      case 5:
        node.attributes.push_back(parse_attribute(reader.nested("AttributeProto")));
        break;
      case 7:
        node.domain = reader.bytes();
        break;
    }
  }
  return node;
}

int64_t parse_dimension(WireReader reader) {
  int64_t value = -1;
  while (reader.next()) {
    if (reader.field() == 1) value = reader.integer();
  }
  return value >= 1 ? value : -1;  // some exporters write 0 for an open size
}

OnnxValueInfo parse_value_info(WireReader reader) {
  OnnxValueInfo info;
  while (reader.next()) {
    if (reader.field() == 1) info.name = reader.bytes();
    if (reader.field() != 2) continue;
    WireReader type = reader.nested("TypeProto");
    while (type.next()) {
      if (type.field() != 1) continue;
      WireReader tensor = type.nested("TypeProto.Tensor");
      while (tensor.next()) {
        if (tensor.field() == 1) info.type = static_cast<int>(tensor.integer());
        if (tensor.field() != 2) continue;
        info.has_shape = true;
        WireReader shape = tensor.nested("TensorShapeProto");
        while (shape.next()) {
          if (shape.field() == 1) info.dims.push_back(parse_dimension(shape.nested("TensorShapeProto.Dimension")));
        }
      }
    }
  }
  return info;
}

void parse_graph(WireReader reader, OnnxModel& model) {
  while (reader.next()) {
    switch (reader.field()) {
      case 1:
        model.nodes.push_back(parse_node(reader.nested("NodeProto")));
        break;
      case 5:
        model.initializers.push_back(parse_tensor(reader.nested("TensorProto")));
        break;
      case 11:
        model.inputs.push_back(parse_value_info(reader.nested("ValueInfoProto")));
        break;
      case 12:
        model.outputs.push_back(parse_value_info(reader.nested("ValueInfoProto")));
        break;
      case 15:
        reader.fail("sparse weights are not supported; save the model with dense ones");
    }
  }
}

int64_t parse_opset(WireReader reader) {
  std::string_view domain;
  int64_t version = 0;
  while (reader.next()) {
    if (reader.field() == 1) domain = reader.bytes();
    if (reader.field() == 2) version = reader.integer();
  }
  return domain.empty() || domain == "ai.onnx" ? version : 0;
}

template <typename T, typename Out>
void read_raw(std::string_view raw, std::vector<Out>& out) {
  for (size_t i = 0; i < out.size(); ++i) {
    T value;
    std::memcpy(&value, raw.data() + i * sizeof(T), sizeof(T));
    out[i] = static_cast<Out>(value);
  }
}

template <typename Out>
std::vector<Out> values_of(const OnnxTensor& tensor) {
  if (tensor.raw.empty()) {
    if (tensor.type == kFloat32) return {tensor.floats.begin(), tensor.floats.end()};
    if (tensor.type == kDouble) return {tensor.doubles.begin(), tensor.doubles.end()};
    std::vector<Out> out;
    for (int64_t value : tensor.integers)
      out.push_back(tensor.type == kFloat16 ? Out(float_from_half(static_cast<uint16_t>(value)))
                                            : static_cast<Out>(value));
    return out;
  }
  std::vector<Out> out(tensor.raw.size() / element_bytes(tensor.type));
  switch (tensor.type) {
    case kFloat32:
      read_raw<float>(tensor.raw, out);
      break;
    case kDouble:
      read_raw<double>(tensor.raw, out);
      break;
    case kInt32:
      read_raw<int32_t>(tensor.raw, out);
      break;
    case kInt64:
      read_raw<int64_t>(tensor.raw, out);
      break;
    case kInt8:
      read_raw<int8_t>(tensor.raw, out);
      break;
    case kFloat16:
      for (size_t i = 0; i < out.size(); ++i) {
        uint16_t half;
        std::memcpy(&half, tensor.raw.data() + 2 * i, 2);
        out[i] = Out(float_from_half(half));
      }
      break;
    default:
      read_raw<uint8_t>(tensor.raw, out);
  }
  return out;
}

}  // namespace

std::string to_string(const Dims& dims) {
  std::string text = "[";
  for (size_t i = 0; i < dims.size(); ++i)
    text.append(i ? "," : "").append(dims[i] == -1 ? "?" : std::to_string(dims[i]));
  return text + "]";
}

std::vector<float> float_values(const OnnxTensor& tensor) {
  return values_of<float>(tensor);
}

std::vector<double> double_values(const OnnxTensor& tensor) {
  return values_of<double>(tensor);
}

OnnxModel parse_onnx_model(const std::string& bytes, const std::string& file) {
  OnnxModel model;
  bool has_graph = false;
  WireReader reader(file, "ModelProto", bytes);
  while (reader.next()) {
    switch (reader.field()) {
      case 7:
        if (has_graph) reader.fail("a second graph, must be one");
        has_graph = true;
        parse_graph(reader.nested("GraphProto"), model);
        break;
      case 8:
        model.opset = std::max(model.opset, parse_opset(reader.nested("OperatorSetIdProto")));
        break;
    }
  }
  if (!has_graph)
    throw IoError(file + format(": no graph (field 7 of ModelProto) in %zu bytes: not an ONNX model, or truncated",
                                bytes.size()));
  if (model.opset < kOldestOpset)
    throw IoError(file + format(": operator set %lld (opset_import, field 8 of ModelProto), must be %lld or later",
                                static_cast<long long>(model.opset), static_cast<long long>(kOldestOpset)));
  return model;
}

}  // namespace livecap::nn
