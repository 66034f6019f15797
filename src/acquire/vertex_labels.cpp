#include "acquire/vertex_labels.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstring>
#include <iterator>
#include <sstream>
#include <string_view>

#include "actor/labels.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap::acquire {

namespace {

constexpr std::string_view kNpyMagic("\x93NUMPY", 6);

template <typename T>
std::vector<double> numbers(std::string_view bytes) {
  std::vector<double> values;
  for (size_t at = 0; at + sizeof(T) <= bytes.size(); at += sizeof(T)) {
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    values.push_back(static_cast<double>(value));
  }
  return values;
}

struct NpyType {
  std::string_view name;  // as in the header
  std::vector<double> (*read)(std::string_view bytes);
};
constexpr NpyType kTypes[] = {{"'|u1'", numbers<uint8_t>},  {"'|i1'", numbers<int8_t>},   {"'<u2'", numbers<uint16_t>},
                              {"'<i2'", numbers<int16_t>},  {"'<u4'", numbers<uint32_t>}, {"'<i4'", numbers<int32_t>},
                              {"'<u8'", numbers<uint64_t>}, {"'<i8'", numbers<int64_t>},  {"'<f4'", numbers<float>},
                              {"'<f8'", numbers<double>}};

// The text behind "'key':" in the header of an .npy, up to the next of `ends`.
std::string header_value(const std::string& header, const std::string& key, const char* ends) {
  const size_t begin = header.find("'" + key + "':");
  if (begin == std::string::npos) return {};
  const size_t first = header.find_first_not_of(' ', begin + key.size() + 3);
  const size_t last = header.find_first_of(ends, first == std::string::npos ? header.size() : first + 1);
  return first == std::string::npos || last == std::string::npos ? std::string() : header.substr(first, last - first);
}

std::vector<double> read_npy(const std::string& bytes, const std::filesystem::path& path) {
  const auto fail = [&](const std::string& what) -> IoError {
    return IoError(path.string() + ": " + what + "; one whole number per vertex was expected, as numpy.save writes it");
  };
  const size_t start = bytes.size() > 6 && bytes[6] > 1 ? 12 : 10;  // version 2 counts the header with four bytes
  if (bytes.size() < start) throw fail("the file ends in its header");
  size_t length = 0;
  for (size_t i = 8; i < start; ++i) length |= static_cast<size_t>(static_cast<uint8_t>(bytes[i])) << (8 * (i - 8));
  if (bytes.size() - start < length) throw fail("the file ends in its header");
  const std::string header = bytes.substr(start, length);
  const std::string shape = header_value(header, "shape", ")");
  const size_t comma = shape.find(',');
  if (comma == std::string::npos || shape.find_first_not_of(" ,", comma) != std::string::npos)
    throw fail("its shape is " + shape + ")");
  size_t count = 0;
  if (std::from_chars(shape.data() + 1, shape.data() + comma, count).ec != std::errc()) throw fail("it has no shape");

  const std::string type = header_value(header, "descr", ",");
  const std::string_view data = std::string_view(bytes).substr(start + length);
  const auto known = std::find_if(std::begin(kTypes), std::end(kTypes), [&](const auto& t) { return t.name == type; });
  if (known == std::end(kTypes)) throw fail("its type " + type + " is not known");
  std::vector<double> values = known->read(data);
  if (values.size() != count) throw fail(format("it has %zu values where its header says %zu", values.size(), count));
  return values;
}

std::vector<double> read_text(const std::string& bytes, const std::filesystem::path& path) {
  std::vector<double> values;
  std::istringstream in(bytes);
  int number = 0;
  for (std::string line; std::getline(in, line);) {
    ++number;
    line.erase(line.find_last_not_of(" \t\r") + 1);
    if (line.empty()) continue;
    double value = 0;
    const auto [end, error] = std::from_chars(line.data(), line.data() + line.size(), value);
    if (error != std::errc() || end != line.data() + line.size())
      throw IoError(path.string() + format(":%d: is neither an .npy nor text with one LIP id a line", number));
    values.push_back(value);
  }
  return values;
}

}  // namespace

std::vector<uint8_t> read_vertex_labels(const std::filesystem::path& path, size_t n_vertices,
                                        const std::filesystem::path& mesh) {
  const std::string bytes = read_file(path);
  const std::vector<double> values = bytes.rfind(kNpyMagic, 0) == 0 ? read_npy(bytes, path) : read_text(bytes, path);
  if (values.size() != n_vertices)
    throw IoError(path.string() + format(": has %zu labels, ", values.size()) + mesh.string() +
                  format(" has %zu vertices", n_vertices));
  std::vector<uint8_t> labels;
  for (double value : values) {
    if (!(value >= 0 && value < kLabelCount) || value != std::floor(value))
      throw IoError(path.string() + format(": the label of vertex %zu is %g, must be a LIP id, 0..%d", labels.size(),
                                           value, kLabelCount - 1));
    labels.push_back(static_cast<uint8_t>(value));
  }
  return labels;
}

}  // namespace livecap::acquire
