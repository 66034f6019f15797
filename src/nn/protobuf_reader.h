// Reading of protobuf messages (developers.google.com/protocol-buffers/docs/encoding): fields one after another, every
// length checked against the bytes that are there. Nothing is copied.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace livecap::nn {

// One message. Use:
//   while (reader.next())
//     switch (reader.field()) { case 1: name = reader.bytes(); break; ... }
// All functions throw IoError with one line: file, byte offset, message and field, what is wrong.
class WireReader {
 public:
  // `file` and `message` (its type, for errors) must outlive the reader; `offset`: of the bytes in the file.
  WireReader(const std::string& file, const char* message, std::string_view bytes, size_t offset = 0)
      : file_(&file), message_(message), rest_(bytes), offset_(offset), field_offset_(offset) {}

  // Goes to the next field; false at the end.
  bool next();
  int field() const { return field_; }

  int64_t integer() const;         // a varint
  float real() const;              // a float
  std::string_view bytes() const;  // a string or bytes
  WireReader nested(const char* message) const;
  // Appends one element of a repeated field, or all of them when they are packed.
  void append_to(std::vector<int64_t>& out) const;
  void append_to(std::vector<float>& out) const;
  void append_to(std::vector<double>& out) const;

  size_t offset() const { return field_offset_; }  // of the current field in the file
  [[noreturn]] void fail(const std::string& what) const;

 private:
  enum class WireType { kVarint = 0, kFixed64 = 1, kBytes = 2, kFixed32 = 5 };

  uint64_t take_varint();
  std::string_view take(uint64_t n);
  void expect(WireType type, const char* what) const;
  template <typename T>
  void append_fixed(WireType type, std::vector<T>& out) const;

  const std::string* file_;
  const char* message_;
  std::string_view rest_;  // behind the current field
  size_t offset_;          // of rest_ in the file
  int field_ = 0;
  WireType type_ = WireType::kVarint;
  uint64_t integer_ = 0;
  std::string_view bytes_;  // of a field that is no varint
  size_t field_offset_;
};

}  // namespace livecap::nn
