#include "image/jpeg_file.h"

#include <turbojpeg.h>

#include <memory>

#include "livecap/error.h"

namespace livecap {
namespace {

struct Destroy {
  void operator()(void* handle) const { tjDestroy(handle); }
};
using Handle = std::unique_ptr<void, Destroy>;

[[noreturn]] void fail(const Handle& handle) {
  throw IoError(tjGetErrorStr2(handle.get()));
}

// Cameras leave bytes between segments, which libjpeg-turbo warns about and skips; that the file ends too early is a
// warning to it as well, and the rest of the picture is grey.
bool is_cut_off(const Handle& handle) {
  return std::string_view(tjGetErrorStr2(handle.get())).find("Premature end") != std::string_view::npos;
}

const unsigned char* unsigned_bytes(std::string_view bytes) {
  return reinterpret_cast<const unsigned char*>(bytes.data());
}

Handle make_decoder() {
  Handle handle(tjInitDecompress());
  if (!handle) throw IoError("JPEG: out of memory");
  return handle;
}

struct Header {
  int width, height, subsampling, colours;
};

Header read_header(const Handle& handle, std::string_view bytes) {
  Header header{};
  if (tjDecompressHeader3(handle.get(), unsigned_bytes(bytes), bytes.size(), &header.width, &header.height,
                          &header.subsampling, &header.colours) != 0 ||
      header.width <= 0 || header.height <= 0)  // of a file that ends before its size 2.1.5 says success
    fail(handle);
  return header;
}

// Of print shops; their programs store it inverted.
void rgb_from_inverted_cmyk(PackedPicture& picture) {
  const size_t n = size_t(picture.width) * picture.height;
  for (size_t i = 0; i < n; ++i)
    for (int c = 0; c < 3; ++c)
      picture.pixels[3 * i + c] = static_cast<uint8_t>(picture.pixels[4 * i + c] * picture.pixels[4 * i + 3] / 255);
  picture.pixels.resize(3 * n);
  picture.channels = 3;
}

}  // namespace

bool is_jpeg(std::string_view bytes) {
  return bytes.starts_with("\xff\xd8\xff");
}

std::pair<int, int> jpeg_size(std::string_view bytes) {
  const Header header = read_header(make_decoder(), bytes);
  return {header.width, header.height};
}

PackedPicture decode_jpeg(std::string_view bytes, int channels) {
  const Handle handle = make_decoder();
  const Header header = read_header(handle, bytes);
  const bool cmyk = header.colours == TJCS_CMYK || header.colours == TJCS_YCCK;
  PackedPicture result{header.width, header.height, cmyk ? 4 : channels, {}};
  result.pixels.resize(size_t(result.channels) * result.width * result.height);
  const int format = cmyk ? TJPF_CMYK : channels == 1 ? TJPF_GRAY : TJPF_RGB;
  if (tjDecompress2(handle.get(), unsigned_bytes(bytes), bytes.size(), result.pixels.data(), result.width, 0,
                    result.height, format, 0) != 0 &&
      (tjGetErrorCode(handle.get()) == TJERR_FATAL || is_cut_off(handle)))
    fail(handle);
  if (cmyk) rgb_from_inverted_cmyk(result);
  return result;
}

std::string encode_jpeg(const uint8_t* rgb, int width, int height, int quality) {
  const Handle handle(tjInitCompress());
  if (!handle) throw IoError("JPEG: out of memory");
  unsigned char* bytes = nullptr;
  unsigned long size = 0;
  const int code = tjCompress2(handle.get(), rgb, width, 0, height, TJPF_RGB, &bytes, &size, TJSAMP_420, quality,
                               TJFLAG_ACCURATEDCT);
  const std::unique_ptr<unsigned char, decltype(&tjFree)> file(bytes, tjFree);
  if (code != 0) fail(handle);
  return {reinterpret_cast<const char*>(bytes), size};
}

}  // namespace livecap
