// Writes small ONNX models byte by byte (protobuf wire format, field numbers of onnx.proto): an independent counterpart
// of the reader that is tested.
#pragma once

#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

namespace livecap::test {

inline std::string wire_varint(uint64_t value) {
  std::string out;
  for (; value >= 128; value >>= 7) out += static_cast<char>(value | 128);
  return out + static_cast<char>(value);
}

inline std::string wire_integer(int field, int64_t value) {
  return wire_varint(uint64_t(field) << 3) + wire_varint(static_cast<uint64_t>(value));
}

inline std::string wire_bytes(int field, const std::string& bytes) {
  return wire_varint(uint64_t(field) << 3 | 2) + wire_varint(bytes.size()) + bytes;
}

inline std::string wire_float(int field, float value) {
  std::string raw(sizeof(value), '\0');
  std::memcpy(raw.data(), &value, sizeof(value));
  return wire_varint(uint64_t(field) << 3 | 5) + raw;
}

template <typename T>
std::string raw_bytes(const std::vector<T>& values) {
  std::string raw(values.size() * sizeof(T), '\0');
  if (!values.empty()) std::memcpy(raw.data(), values.data(), raw.size());
  return raw;
}

inline std::string onnx_tensor(const std::string& name, const std::vector<int64_t>& dims, int type,
                               const std::string& raw) {
  std::string out;
  for (int64_t n : dims) out += wire_integer(1, n);
  return out + wire_integer(2, type) + wire_bytes(8, name) + wire_bytes(9, raw);
}

// Attributes as bytes of AttributeProto.
inline std::string onnx_int(const std::string& name, int64_t value) {
  return wire_bytes(1, name) + wire_integer(3, value) + wire_integer(20, 2);
}
inline std::string onnx_float(const std::string& name, float value) {
  return wire_bytes(1, name) + wire_float(2, value) + wire_integer(20, 1);
}
inline std::string onnx_text(const std::string& name, const std::string& value) {
  return wire_bytes(1, name) + wire_bytes(4, value) + wire_integer(20, 3);
}
inline std::string onnx_ints(const std::string& name, const std::vector<int64_t>& values) {
  std::string out = wire_bytes(1, name);
  for (int64_t v : values) out += wire_integer(8, v);
  return out + wire_integer(20, 7);
}

class OnnxWriter {
 public:
  void floats(const std::string& name, const std::vector<int64_t>& dims, const std::vector<float>& values) {
    initializers_ += wire_bytes(5, onnx_tensor(name, dims, 1, raw_bytes(values)));
  }
  void integers(const std::string& name, const std::vector<int64_t>& values) {
    initializers_ += wire_bytes(5, onnx_tensor(name, {static_cast<int64_t>(values.size())}, 7, raw_bytes(values)));
  }
  void tensor(const std::string& proto) { initializers_ += wire_bytes(5, proto); }

  // The node's name is its output's.
  void node(const std::string& type, const std::vector<std::string>& inputs, const std::string& output,
            const std::vector<std::string>& attributes = {}) {
    std::string out;
    for (const std::string& name : inputs) out += wire_bytes(1, name);
    out += wire_bytes(2, output) + wire_bytes(3, output) + wire_bytes(4, type);
    for (const std::string& attribute : attributes) out += wire_bytes(5, attribute);
    nodes_ += wire_bytes(1, out);
  }

  // 0: an open size.
  std::string model(const std::vector<int64_t>& input, const std::vector<std::string>& outputs, int opset = 13) const {
    std::string graph = nodes_ + wire_bytes(2, "net") + initializers_ + wire_bytes(11, value_info("x", input));
    for (const std::string& name : outputs) graph += wire_bytes(12, value_info(name, {}));
    return wire_integer(1, 7) + wire_bytes(2, "test") + wire_bytes(7, graph) +
           wire_bytes(8, wire_bytes(1, "") + wire_integer(2, opset));
  }

 private:
  static std::string value_info(const std::string& name, const std::vector<int64_t>& dims) {
    std::string shape;
    for (int64_t n : dims) shape += wire_bytes(1, n > 0 ? wire_integer(1, n) : wire_bytes(2, "open"));
    const std::string type = wire_integer(1, 1) + wire_bytes(2, shape);
    return wire_bytes(1, name) + wire_bytes(2, wire_bytes(1, type));
  }

  std::string nodes_, initializers_;
};

}  // namespace livecap::test
