#include "capture/file_sha256.h"

#include <memory>
#include <new>

#include "base/text.h"

extern "C" {
#include <libavutil/mem.h>
#include <libavutil/sha.h>
}

namespace livecap {

std::string file_sha256(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  std::unique_ptr<AVSHA, decltype(&av_free)> sha(av_sha_alloc(), av_free);
  if (!sha) throw std::bad_alloc();
  av_sha_init(sha.get(), 256);
  av_sha_update(sha.get(), reinterpret_cast<const uint8_t*>(bytes.data()), bytes.size());
  uint8_t digest[32];
  av_sha_final(sha.get(), digest);
  std::string text;
  for (uint8_t byte : digest) text += format("%02x", byte);
  return text;
}

}  // namespace livecap
