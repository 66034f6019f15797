#include "image/jpeg_file.h"

#include <cstdio>  // before jpeglib.h, which wants FILE
// clang-format off
#include <jpeglib.h>
#include <jerror.h>
// clang-format on

#include <csetjmp>
#include <cstdlib>
#include <utility>

#include "livecap/error.h"

namespace livecap {
namespace {

// libjpeg calls back to end a call; no destructor may lie on the way.
struct Errors {
  jpeg_error_mgr manager;  // first: libjpeg knows the address of this
  std::jmp_buf escape;
  char message[JMSG_LENGTH_MAX];
};

[[noreturn]] void give_up(j_common_ptr info) {
  auto* errors = reinterpret_cast<Errors*>(info->err);
  errors->manager.format_message(info, errors->message);
  std::longjmp(errors->escape, 1);
}

// What says nothing of the picture: cameras leave bytes between segments, programs write odd versions.
bool is_harmless(int warning) {
  return warning == JWRN_EXTRANEOUS_DATA || warning == JWRN_ADOBE_XFORM || warning == JWRN_JFIF_MAJOR ||
         warning == JWRN_TOO_MUCH_DATA;
}

// To libjpeg damaged and missing data are warnings.
void on_message(j_common_ptr info, int level) {
  if (level < 0 && !is_harmless(info->err->msg_code)) give_up(info);
}

jpeg_error_mgr* prepared(Errors& errors) {
  jpeg_std_error(&errors.manager);
  errors.manager.error_exit = give_up;
  errors.manager.emit_message = on_message;
  return &errors.manager;
}

// `call` makes only calls of libjpeg and has nothing to destroy. Throws IoError when one of them fails.
template <typename Call>
void checked(Errors& errors, Call&& call) {
  if (setjmp(errors.escape) != 0) throw IoError(errors.message);
  call();
}

class Decoder {
 public:
  explicit Decoder(std::string_view bytes) {
    info_.err = prepared(errors_);
    checked(errors_, [&] { jpeg_create_decompress(&info_); });
    try {
      checked(errors_, [&] {
        jpeg_mem_src(&info_, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
        jpeg_read_header(&info_, TRUE);
      });
    } catch (...) {
      jpeg_destroy_decompress(&info_);
      throw;
    }
  }
  ~Decoder() { jpeg_destroy_decompress(&info_); }
  Decoder(const Decoder&) = delete;
  Decoder& operator=(const Decoder&) = delete;

  int width() const { return static_cast<int>(info_.image_width); }
  int height() const { return static_cast<int>(info_.image_height); }
  bool is_cmyk() const { return info_.jpeg_color_space == JCS_CMYK || info_.jpeg_color_space == JCS_YCCK; }

  // pixels: [channels*width*height], channels 1, 3, or 4 for CMYK.
  void decode(int channels, uint8_t* pixels) {
    info_.out_color_space = channels == 1 ? JCS_GRAYSCALE : channels == 3 ? JCS_RGB : JCS_CMYK;
    checked(errors_, [&] {
      jpeg_start_decompress(&info_);
      while (info_.output_scanline < info_.output_height) {
        JSAMPROW row = pixels + size_t(channels) * info_.image_width * info_.output_scanline;
        jpeg_read_scanlines(&info_, &row, 1);
      }
      jpeg_finish_decompress(&info_);
    });
  }

 private:
  Errors errors_{};
  jpeg_decompress_struct info_{};
};

// Of print shops; their programs store it inverted.
void rgb_from_inverted_cmyk(PackedPicture& picture) {
  const size_t n = size_t(picture.width) * picture.height;
  for (size_t i = 0; i < n; ++i)
    for (int c = 0; c < 3; ++c)
      picture.pixels[3 * i + c] = static_cast<uint8_t>(picture.pixels[4 * i + c] * picture.pixels[4 * i + 3] / 255);
  picture.pixels.resize(3 * n);
  picture.channels = 3;
}

// What libjpeg allocates and grows.
struct Bytes {
  unsigned char* data = nullptr;
  unsigned long size = 0;
  ~Bytes() { std::free(data); }
};

}  // namespace

bool is_jpeg(std::string_view bytes) {
  return bytes.starts_with("\xff\xd8\xff");
}

std::pair<int, int> jpeg_size(std::string_view bytes) {
  const Decoder decoder(bytes);
  return {decoder.width(), decoder.height()};
}

PackedPicture decode_jpeg(std::string_view bytes, int channels) {
  Decoder decoder(bytes);
  PackedPicture result{decoder.width(), decoder.height(), decoder.is_cmyk() ? 4 : channels, {}};
  require_decodable(result.width, result.height);
  result.pixels.resize(size_t(result.channels) * result.width * result.height);
  decoder.decode(result.channels, result.pixels.data());
  if (result.channels == 4) rgb_from_inverted_cmyk(result);
  return result;
}

std::string encode_jpeg(const uint8_t* rgb, int width, int height, int quality) {
  Errors errors;
  jpeg_compress_struct info{};
  Bytes file;
  info.err = prepared(errors);
  checked(errors, [&] { jpeg_create_compress(&info); });
  try {
    checked(errors, [&] {
      jpeg_mem_dest(&info, &file.data, &file.size);
      info.image_width = static_cast<JDIMENSION>(width);
      info.image_height = static_cast<JDIMENSION>(height);
      info.input_components = 3;
      info.in_color_space = JCS_RGB;
      jpeg_set_defaults(&info);
      jpeg_set_quality(&info, quality, TRUE);
      jpeg_start_compress(&info, TRUE);
      while (info.next_scanline < info.image_height) {
        auto row = const_cast<JSAMPROW>(rgb + size_t(3) * width * info.next_scanline);
        jpeg_write_scanlines(&info, &row, 1);
      }
      jpeg_finish_compress(&info);
    });
  } catch (...) {
    file.data = nullptr;  // it may be of a buffer that was too small and is gone
    jpeg_destroy_compress(&info);
    throw;
  }
  jpeg_destroy_compress(&info);
  return {reinterpret_cast<const char*>(file.data), file.size};
}

}  // namespace livecap
