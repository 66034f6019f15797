#include "image/png_file.h"

#include <spng.h>

#include <cstdlib>
#include <memory>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

using Context = std::unique_ptr<spng_ctx, decltype(&spng_ctx_free)>;

Context make_context(int flags) {
  Context context(spng_ctx_new(flags), spng_ctx_free);
  if (!context) throw IoError("PNG: out of memory");
  return context;
}

void check(int code) {
  if (code != SPNG_OK) throw IoError(spng_strerror(code));
}

// bytes: must outlive the context.
spng_ihdr read_header(const Context& context, std::string_view bytes) {
  check(spng_set_png_buffer(context.get(), bytes.data(), bytes.size()));
  spng_ihdr header;
  check(spng_get_ihdr(context.get(), &header));
  return header;
}

}  // namespace

bool is_png(std::string_view bytes) {
  return bytes.starts_with("\x89PNG\r\n\x1a\n");
}

std::pair<int, int> png_size(std::string_view bytes) {
  const Context context = make_context(0);
  const spng_ihdr header = read_header(context, bytes);
  return {header.width, header.height};
}

PackedPicture decode_png(std::string_view bytes) {
  const Context context = make_context(0);
  const spng_ihdr header = read_header(context, bytes);
  require_decodable(header.width, header.height);
  spng_trns transparent;
  const bool alpha = header.color_type == SPNG_COLOR_TYPE_GRAYSCALE_ALPHA ||
                     header.color_type == SPNG_COLOR_TYPE_TRUECOLOR_ALPHA ||
                     spng_get_trns(context.get(), &transparent) == SPNG_OK;
  const bool grey = !alpha && header.color_type == SPNG_COLOR_TYPE_GRAYSCALE && header.bit_depth <= 8;

  PackedPicture result{static_cast<int>(header.width), static_cast<int>(header.height), alpha ? 4 : grey ? 1 : 3, {}};
  result.pixels.resize(size_t(result.channels) * result.width * result.height);
  check(spng_decode_image(context.get(), result.pixels.data(), result.pixels.size(),
                          alpha  ? SPNG_FMT_RGBA8
                          : grey ? SPNG_FMT_G8
                                 : SPNG_FMT_RGB8,
                          SPNG_DECODE_TRNS));
  return result;
}

PackedPicture decode_png_numbers(std::string_view bytes) {
  const Context context = make_context(0);
  const spng_ihdr header = read_header(context, bytes);
  if ((header.color_type != SPNG_COLOR_TYPE_INDEXED && header.color_type != SPNG_COLOR_TYPE_GRAYSCALE) ||
      header.bit_depth > 8)
    return decode_png(bytes);
  require_decodable(header.width, header.height);
  size_t size = 0;
  check(spng_decoded_image_size(context.get(), SPNG_FMT_PNG, &size));
  std::vector<uint8_t> packed(size);
  check(spng_decode_image(context.get(), packed.data(), packed.size(), SPNG_FMT_PNG, 0));
  // Every row begins with a byte of its own, and the first pixel is in the highest bits.
  const size_t per_byte = 8 / header.bit_depth, row = size / header.height;
  PackedPicture result{static_cast<int>(header.width), static_cast<int>(header.height), 1, {}};
  result.pixels.reserve(size_t(header.width) * header.height);
  for (size_t y = 0; y < header.height; ++y)
    for (size_t x = 0; x < header.width; ++x) {
      const int shift = 8 - header.bit_depth * static_cast<int>(x % per_byte + 1);
      result.pixels.push_back(
          static_cast<uint8_t>(packed[y * row + x / per_byte] >> shift & ((1 << header.bit_depth) - 1)));
    }
  return result;
}

std::string encode_png(const uint8_t* pixels, int width, int height, int channels) {
  const Context context = make_context(SPNG_CTX_ENCODER);
  spng_ihdr header{};
  header.width = static_cast<uint32_t>(width);
  header.height = static_cast<uint32_t>(height);
  header.bit_depth = 8;
  header.color_type = channels == 1   ? SPNG_COLOR_TYPE_GRAYSCALE
                      : channels == 3 ? SPNG_COLOR_TYPE_TRUECOLOR
                                      : SPNG_COLOR_TYPE_TRUECOLOR_ALPHA;
  check(spng_set_option(context.get(), SPNG_ENCODE_TO_BUFFER, 1));
  check(spng_set_option(context.get(), SPNG_IMG_COMPRESSION_LEVEL, 1));  // a third of the time for a tenth more bytes
  check(spng_set_option(context.get(), SPNG_FILTER_CHOICE, SPNG_FILTER_CHOICE_SUB));
  check(spng_set_ihdr(context.get(), &header));
  check(
      spng_encode_image(context.get(), pixels, size_t(channels) * width * height, SPNG_FMT_PNG, SPNG_ENCODE_FINALIZE));
  size_t size = 0;
  int code = 0;
  const std::unique_ptr<void, decltype(&std::free)> file(spng_get_png_buffer(context.get(), &size, &code), std::free);
  check(code);
  return {static_cast<const char*>(file.get()), size};
}

}  // namespace livecap
