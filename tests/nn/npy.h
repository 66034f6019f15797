// Reads .npy files of little-endian float16 or float32 values in C order.
#pragma once

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "base/text.h"
#include "nn/half.h"

namespace livecap::test {

inline std::vector<float> load_npy(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  if (bytes.size() < 10 || bytes.compare(0, 6, "\x93NUMPY") != 0)
    throw std::runtime_error(path.string() + ": not an .npy file");
  const size_t start = 10 + static_cast<uint8_t>(bytes[8]) + 256 * static_cast<uint8_t>(bytes[9]);
  const std::string header = bytes.substr(10, start - 10);
  const bool half = header.find("'<f2'") != std::string::npos;
  if (!half && header.find("'<f4'") == std::string::npos)
    throw std::runtime_error(path.string() + ": neither <f2 nor <f4: " + header);
  if (header.find("'fortran_order': False") == std::string::npos)
    throw std::runtime_error(path.string() + ": not in C order");
  std::vector<float> values((bytes.size() - start) / (half ? 2 : 4));
  for (size_t i = 0; i < values.size(); ++i) {
    if (half) {
      uint16_t bits;
      std::memcpy(&bits, &bytes[start + 2 * i], 2);
      values[i] = nn::float_from_half(bits);
    } else {
      std::memcpy(&values[i], &bytes[start + 4 * i], 4);
    }
  }
  return values;
}

}  // namespace livecap::test
