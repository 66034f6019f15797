// Stanford PLY, ASCII or binary little endian, with vertex colours.
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <limits>
#include <sstream>
#include <type_traits>

#include "base/number_text.h"
#include "base/text.h"
#include "livecap/error.h"
#include "scan/scan_files.h"

namespace livecap {

namespace {

struct Property {
  std::string name;
  std::string type;        // of the value, or of a list's entries
  std::string count_type;  // empty: no list
};

struct Element {
  std::string name;
  size_t count = 0;
  std::vector<Property> properties;
};

constexpr const char* kChannels[] = {"red", "green", "blue"};

// Values one after the other, from text or from bytes.
class Values {
 public:
  Values(const std::filesystem::path& path, const std::string& bytes, size_t begin, bool ascii)
      : path_(path), bytes_(bytes), at_(begin), ascii_(ascii) {}

  double next(const std::string& type) {
    if (ascii_) {
      double value = 0;
      const char* from = bytes_.data() + at_;
      const char* end = read_number(from, bytes_.data() + bytes_.size(), value);
      if (end == from) fail();
      at_ += end - from;
      return value;
    }
    return with_type(type, [this](auto zero) { return take<decltype(zero)>(); });
  }

  // What a colour of this type has at full brightness.
  double full(const std::string& type) const {
    return with_type(type, [](auto zero) -> double {
      using T = decltype(zero);
      return std::is_floating_point_v<T> ? 1 : static_cast<double>(std::numeric_limits<T>::max());
    });
  }

 private:
  template <typename Use>
  double with_type(const std::string& type, const Use& use) const {
    if (type == "char" || type == "int8") return use(int8_t{});
    if (type == "uchar" || type == "uint8") return use(uint8_t{});
    if (type == "short" || type == "int16") return use(int16_t{});
    if (type == "ushort" || type == "uint16") return use(uint16_t{});
    if (type == "int" || type == "int32") return use(int32_t{});
    if (type == "uint" || type == "uint32") return use(uint32_t{});
    if (type == "float" || type == "float32") return use(float{});
    if (type == "double" || type == "float64") return use(double{});
    throw IoError(path_.string() + ": PLY type \"" + type + "\" is not known");
  }
  [[noreturn]] void fail() const { throw IoError(path_.string() + ": ends before all its elements"); }
  template <typename T>
  double take() {
    static_assert(std::endian::native == std::endian::little);
    if (at_ + sizeof(T) > bytes_.size()) fail();
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return static_cast<double>(value);
  }

  const std::filesystem::path& path_;
  const std::string& bytes_;
  size_t at_;
  bool ascii_;
};

}  // namespace

Scan read_ply(const std::filesystem::path& path, std::vector<std::string>&) {
  const std::string bytes = read_file(path);
  const auto fail = [&](const std::string& what) -> void { throw IoError(path.string() + ": " + what); };
  if (bytes.rfind("ply", 0) != 0) fail("is no PLY file");
  const size_t header_end = bytes.find("end_header");
  if (header_end == std::string::npos) fail("has no end_header");
  std::istringstream header(bytes.substr(0, header_end));
  std::string format_name;
  std::vector<Element> elements;
  for (std::string line; std::getline(header, line);) {
    std::istringstream fields(line);
    std::string key;
    fields >> key;
    if (key == "format") {
      fields >> format_name;
    } else if (key == "element") {
      Element element;
      if (!(fields >> element.name >> element.count)) fail("has a broken element line");
      elements.push_back(element);
    } else if (key == "property" && !elements.empty()) {
      Property property;
      fields >> property.type;
      if (property.type == "list") fields >> property.count_type >> property.type;
      fields >> property.name;
      elements.back().properties.push_back(property);
    }
  }
  if (format_name != "ascii" && format_name != "binary_little_endian")
    fail("is " + format_name + "; save it as ASCII or binary little endian");
  // Of such elements a few bytes could promise any number.
  for (const Element& element : elements)
    if (element.count > 0 && element.properties.empty()) fail("element \"" + element.name + "\" has no property");
  const size_t body = bytes.find('\n', header_end);
  if (body == std::string::npos) fail("has no data");
  Values values(path, bytes, body + 1, format_name == "ascii");
  Scan scan;
  bool colored = false;
  for (const Element& element : elements) {
    const bool is_vertex = element.name == "vertex";
    if (element.count > bytes.size()) fail("promises more elements than it has bytes");
    for (size_t i = 0; i < element.count; ++i) {
      Eigen::Vector3d p(0, 0, 0), c(0, 0, 0);
      for (const Property& property : element.properties) {
        if (!property.count_type.empty()) {
          const double n = values.next(property.count_type);
          if (!(n >= 0) || n != std::floor(n)) fail(format("%s %zu: a list of %g entries", element.name.c_str(), i, n));
          const bool is_face = element.name == "face" && property.name.find("ind") != std::string::npos;
          std::vector<int> corners;
          for (int k = 0; k < n; ++k) {
            const double corner = values.next(property.type);
            if (!is_face) continue;
            if (!(corner >= 0 && corner < static_cast<double>(scan.surface.vertices.size())) ||
                corner != std::floor(corner))
              fail(format("face %zu: there is no vertex %.15g", i, corner));
            corners.push_back(static_cast<int>(corner));
          }
          for (size_t k = 2; k < corners.size(); ++k)
            scan.surface.triangles.emplace_back(corners[0], corners[k - 1], corners[k]);
          continue;
        }
        const double value = values.next(property.type);
        if (!is_vertex) continue;  // faces may have colours of their own
        if (property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z')
          p[property.name[0] - 'x'] = value;
        const size_t channel = std::find(std::begin(kChannels), std::end(kChannels), property.name) - kChannels;
        if (channel == std::size(kChannels)) continue;
        c[channel] = value / values.full(property.type);
        colored = true;
      }
      if (is_vertex) {
        scan.surface.vertices.push_back(p);
        scan.colors.push_back(c);
      }
    }
  }
  if (!colored) scan.colors.clear();
  return scan;
}

}  // namespace livecap
