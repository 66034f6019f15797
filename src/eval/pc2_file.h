// Random access to the samples of a PC2 file.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <vector>

namespace livecap {

class Pc2File {
 public:
  // Throws IoError naming the file when the header is not that of a PC2 file.
  explicit Pc2File(const std::filesystem::path& path);

  int n_points() const { return n_points_; }
  // Complete samples in the file: fewer than the header says when the writer was stopped.
  int64_t n_samples() const { return n_samples_; }
  // [3*n_points] as stored. Throws IoError.
  std::vector<float> read(int64_t sample);

 private:
  std::filesystem::path path_;
  std::ifstream in_;
  int32_t n_points_ = 0;
  int64_t n_samples_ = 0;
};

}  // namespace livecap
