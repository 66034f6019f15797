// PC2 point caches: one sample of all vertices per frame, float32. Blender, Maya and Houdini read them.
//
// Layout, little endian: "POINTCACHE2\0", int32 version 1, int32 n_points, float32 start frame, float32 sample rate
// (frames per sample), int32 n_samples, then n_samples * n_points * 3 float32.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <vector>

namespace livecap {

// The file is valid after every append: the samples are on disk before the header counts them.
class Pc2Writer {
 public:
  // Throws IoError when the file cannot be created, LogicError when n_points < 1.
  Pc2Writer(const std::filesystem::path& path, int n_points, float start = 0, float sample_rate = 1);

  // xyz: [3*n_points] metres, glTF frame. Throws LogicError for another size, IoError when the disk is full.
  void append(std::span<const float> xyz);

  int n_samples() const { return n_samples_; }

 private:
  std::filesystem::path path_;
  std::fstream file_;
  int n_points_ = 0;
  int n_samples_ = 0;
};

// Random access to the samples of a file.
class Pc2Reader {
 public:
  // Throws IoError when this is no PC2 file or is shorter than its header says.
  explicit Pc2Reader(const std::filesystem::path& path);

  // xyz: [3*n_points]. Throws LogicError for a wrong index or size, IoError when reading fails.
  void read(int sample, std::span<float> xyz);

  int n_points() const { return n_points_; }
  int n_samples() const { return n_samples_; }
  float start() const { return start_; }
  float sample_rate() const { return sample_rate_; }

 private:
  std::filesystem::path path_;
  std::ifstream file_;
  int32_t n_points_ = 0;
  int32_t n_samples_ = 0;
  float start_ = 0;
  float sample_rate_ = 1;
};

struct Pc2 {
  int n_points = 0;
  int n_samples = 0;
  float start = 0;
  float sample_rate = 1;
  std::vector<float> samples;  // [n_samples * 3*n_points]
  std::span<const float> sample(int i) const {
    return {samples.data() + size_t{3} * n_points * i, size_t{3} * n_points};
  }
};

// The whole file. Throws IoError.
Pc2 read_pc2(const std::filesystem::path& path);

}  // namespace livecap
