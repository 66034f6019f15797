#include "export/pc2.h"

#include <bit>
#include <cstring>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

static_assert(std::endian::native == std::endian::little, "PC2 is written as the machine has it");

constexpr char kMagic[12] = {'P', 'O', 'I', 'N', 'T', 'C', 'A', 'C', 'H', 'E', '2', '\0'};
constexpr std::streamoff kHeaderBytes = 32;
constexpr std::streamoff kSampleCountOffset = 28;

template <typename T>
void put(std::ostream& out, T value) {
  out.write(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

Pc2Writer::Pc2Writer(const std::filesystem::path& path, int n_points, float start, float sample_rate)
    : path_(path), n_points_(n_points) {
  if (n_points < 1) throw LogicError(format("Pc2Writer: %d points", n_points));
  file_.open(path, std::ios::binary | std::ios::in | std::ios::out | std::ios::trunc);
  if (!file_) throw IoError(path.string() + ": cannot be written");
  file_.write(kMagic, sizeof kMagic);
  put<int32_t>(file_, 1);
  put<int32_t>(file_, n_points);
  put<float>(file_, start);
  put<float>(file_, sample_rate);
  put<int32_t>(file_, 0);
  file_.flush();
  if (!file_) throw IoError(path.string() + ": cannot be written");
}

void Pc2Writer::append(std::span<const float> xyz) {
  if (xyz.size() != size_t{3} * n_points_)
    throw LogicError(format("Pc2Writer: %zu numbers for %d points", xyz.size(), n_points_));
  const std::streamoff sample_bytes = static_cast<std::streamoff>(xyz.size_bytes());
  file_.seekp(kHeaderBytes + sample_bytes * n_samples_);
  file_.write(reinterpret_cast<const char*>(xyz.data()), sample_bytes);
  file_.flush();
  if (!file_) throw IoError(path_.string() + format(": sample %d cannot be written, is the disk full?", n_samples_));
  ++n_samples_;
  file_.seekp(kSampleCountOffset);
  put<int32_t>(file_, n_samples_);
  file_.flush();
  if (!file_) throw IoError(path_.string() + ": header cannot be updated");
}

Pc2Reader::Pc2Reader(const std::filesystem::path& path) : path_(path) {
  require_no_pipe(path);  // opening one waits for who writes to it
  file_.open(path, std::ios::binary);
  if (!file_) throw IoError(path.string() + ": cannot be read");
  char header[kHeaderBytes];
  if (!file_.read(header, sizeof header) || std::memcmp(header, kMagic, sizeof kMagic) != 0)
    throw IoError(path.string() + ": not a PC2 point cache");
  int32_t version = 0;
  std::memcpy(&version, header + 12, 4);
  std::memcpy(&n_points_, header + 16, 4);
  std::memcpy(&start_, header + 20, 4);
  std::memcpy(&sample_rate_, header + 24, 4);
  std::memcpy(&n_samples_, header + 28, 4);
  if (version != 1) throw IoError(path.string() + format(": PC2 version %d, only 1 is supported", version));
  if (n_points_ < 1 || n_samples_ < 0)
    throw IoError(path.string() + format(": %d points and %d samples make no sense", n_points_, n_samples_));
  const uintmax_t size = std::filesystem::file_size(path), sample_bytes = 12 * static_cast<uintmax_t>(n_points_);
  const uintmax_t there = (size - kHeaderBytes) / sample_bytes;  // a product could overflow
  if (there < static_cast<uintmax_t>(n_samples_))
    throw IoError(path.string() + format(": truncated: the header says %d samples of %d points (%ju bytes each), %ju "
                                         "are there",
                                         n_samples_, n_points_, sample_bytes, there));
}

void Pc2Reader::read(int sample, std::span<float> xyz) {
  if (sample < 0 || sample >= n_samples_ || xyz.size() != size_t{3} * n_points_)
    throw LogicError(format("Pc2Reader: sample %d of %d into %zu numbers", sample, n_samples_, xyz.size()));
  const auto bytes = static_cast<std::streamoff>(xyz.size_bytes());
  file_.clear();
  file_.seekg(kHeaderBytes + bytes * sample);
  if (!file_.read(reinterpret_cast<char*>(xyz.data()), bytes))
    throw IoError(path_.string() + format(": sample %d cannot be read", sample));
}

Pc2 read_pc2(const std::filesystem::path& path) {
  Pc2Reader reader(path);
  Pc2 cache{reader.n_points(), reader.n_samples(), reader.start(), reader.sample_rate(), {}};
  const size_t size = size_t{3} * cache.n_points;
  cache.samples.resize(size * cache.n_samples);
  for (int i = 0; i < cache.n_samples; ++i) reader.read(i, {cache.samples.data() + size * i, size});
  return cache;
}

}  // namespace livecap
