#include "eval/pc2_file.h"

#include <algorithm>
#include <cstring>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr char kMagic[12] = {'P', 'O', 'I', 'N', 'T', 'C', 'A', 'C', 'H', 'E', '2', '\0'};

struct Header {
  char magic[12];
  int32_t version;
  int32_t n_points;
  float start;
  float rate;
  int32_t n_samples;
};
static_assert(sizeof(Header) == 32);

}  // namespace

Pc2File::Pc2File(const std::filesystem::path& path) : path_(path), in_(path, std::ios::binary) {
  if (!in_) throw IoError(path.string() + ": cannot be opened");
  Header header{};
  in_.read(reinterpret_cast<char*>(&header), sizeof(header));
  if (!in_ || std::memcmp(header.magic, kMagic, sizeof(kMagic)) != 0 || header.version != 1) {
    throw IoError(path.string() + ": is not a PC2 file (POINTCACHE2, version 1)");
  }
  if (header.n_points <= 0 || header.n_samples < 0) {
    throw IoError(path.string() +
                  format(": %d points and %d samples make no sense", header.n_points, header.n_samples));
  }
  n_points_ = header.n_points;
  const uint64_t bytes = std::filesystem::file_size(path) - sizeof(header);
  n_samples_ = std::min<int64_t>(header.n_samples, bytes / (sizeof(float) * 3 * n_points_));
}

std::vector<float> Pc2File::read(int64_t sample) {
  std::vector<float> positions(3 * static_cast<size_t>(n_points_));
  const std::streamsize bytes = static_cast<std::streamsize>(positions.size() * sizeof(float));
  if (sample < 0 || sample >= n_samples_) {
    throw IoError(path_.string() + format(": has no sample %lld", static_cast<long long>(sample)));
  }
  in_.clear();
  in_.seekg(static_cast<std::streamoff>(sizeof(Header)) + sample * bytes);
  in_.read(reinterpret_cast<char*>(positions.data()), bytes);
  if (!in_) throw IoError(path_.string() + format(": sample %lld cannot be read", static_cast<long long>(sample)));
  return positions;
}

}  // namespace livecap
