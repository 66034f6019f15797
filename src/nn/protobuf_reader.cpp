#include "nn/protobuf_reader.h"

#include <cstring>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap::nn {

void WireReader::fail(const std::string& what) const {
  const std::string field = field_ > 0 ? format("field %d of ", field_) : "";
  throw IoError(*file_ + format(": byte %zu: ", field_offset_) + field + message_ + ": " + what);
}

uint64_t WireReader::take_varint() {
  uint64_t value = 0;
  for (int shift = 0; shift < 70; shift += 7) {
    if (rest_.empty()) fail("ends within a number: the file is truncated or damaged");
    const uint8_t byte = static_cast<uint8_t>(rest_.front());
    rest_.remove_prefix(1);
    ++offset_;
    if (shift < 64) value |= uint64_t(byte & 0x7f) << shift;
    if (byte < 0x80) return value;
  }
  fail("a number of more than 10 bytes: the file is damaged");
}

std::string_view WireReader::take(uint64_t n) {
  if (n > rest_.size())
    fail(format("states %llu bytes, %zu are left: the file is truncated or damaged", static_cast<unsigned long long>(n),
                rest_.size()));
  const std::string_view taken = rest_.substr(0, n);
  rest_.remove_prefix(n);
  offset_ += n;
  return taken;
}

bool WireReader::next() {
  if (rest_.empty()) return false;
  field_ = 0;
  field_offset_ = offset_;
  const uint64_t tag = take_varint();
  if (tag >> 3 == 0 || tag >> 3 >= (1u << 29)) fail("has no valid number: not an ONNX file, or damaged");
  field_ = static_cast<int>(tag >> 3);
  type_ = static_cast<WireType>(tag & 7);
  bytes_ = {};
  switch (type_) {
    case WireType::kVarint:
      integer_ = take_varint();
      break;
    case WireType::kFixed64:
      bytes_ = take(8);
      break;
    case WireType::kFixed32:
      bytes_ = take(4);
      break;
    case WireType::kBytes:
      bytes_ = take(take_varint());
      break;
    default:
      fail(format("wire type %d, must be 0, 1, 2 or 5: not an ONNX file, or damaged", static_cast<int>(tag & 7)));
  }
  return true;
}

void WireReader::expect(WireType type, const char* what) const {
  if (type_ != type)
    fail(format("wire type %d, must be %d (%s)", static_cast<int>(type_), static_cast<int>(type), what));
}

int64_t WireReader::integer() const {
  expect(WireType::kVarint, "an integer");
  return static_cast<int64_t>(integer_);
}

float WireReader::real() const {
  expect(WireType::kFixed32, "a float");
  float value;
  std::memcpy(&value, bytes_.data(), sizeof(value));
  return value;
}

std::string_view WireReader::bytes() const {
  expect(WireType::kBytes, "bytes");
  return bytes_;
}

WireReader WireReader::nested(const char* message) const {
  expect(WireType::kBytes, "a message");
  return WireReader(*file_, message, bytes_, offset_ - bytes_.size());
}

void WireReader::append_to(std::vector<int64_t>& out) const {
  if (type_ == WireType::kVarint) {
    out.push_back(static_cast<int64_t>(integer_));
    return;
  }
  expect(WireType::kBytes, "packed integers");
  WireReader packed = *this;
  packed.rest_ = bytes_;
  packed.offset_ = offset_ - bytes_.size();
  while (!packed.rest_.empty()) out.push_back(static_cast<int64_t>(packed.take_varint()));
}

template <typename T>
void WireReader::append_fixed(WireType type, std::vector<T>& out) const {
  if (type_ != type) expect(WireType::kBytes, "packed numbers");
  if (bytes_.size() % sizeof(T) != 0)
    fail(format("%zu bytes of packed numbers, must be a multiple of %zu", bytes_.size(), sizeof(T)));
  const size_t n = out.size();
  out.resize(n + bytes_.size() / sizeof(T));
  if (!bytes_.empty()) std::memcpy(&out[n], bytes_.data(), bytes_.size());
}

void WireReader::append_to(std::vector<float>& out) const {
  append_fixed(WireType::kFixed32, out);
}

void WireReader::append_to(std::vector<double>& out) const {
  append_fixed(WireType::kFixed64, out);
}

}  // namespace livecap::nn
