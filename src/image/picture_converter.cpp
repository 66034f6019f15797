#include "image/picture_converter.h"

extern "C" {
#include <libavutil/frame.h>
#include <libavutil/pixdesc.h>
#include <libswscale/swscale.h>
}

#include <algorithm>
#include <cstdlib>

#include "base/text.h"
#include "image/planar_yuv.h"
#include "livecap/error.h"

namespace livecap {
namespace {

// Untagged pictures: BT.709 from HD sizes on, BT.601 below, as players do.
constexpr int kHdShortSide = 720;

// As swscale numbers them.
int colour_matrix(const AVFrame& frame) {
  switch (frame.colorspace) {
    case AVCOL_SPC_BT709:
      return SWS_CS_ITU709;
    case AVCOL_SPC_SMPTE170M:
    case AVCOL_SPC_BT470BG:
      return SWS_CS_ITU601;
    case AVCOL_SPC_FCC:
      return SWS_CS_FCC;
    case AVCOL_SPC_SMPTE240M:
      return SWS_CS_SMPTE240M;
    case AVCOL_SPC_BT2020_NCL:
    case AVCOL_SPC_BT2020_CL:
      return SWS_CS_BT2020;
    default:
      return std::min(frame.width, frame.height) >= kHdShortSide ? SWS_CS_ITU709 : SWS_CS_ITU601;
  }
}

bool full_range(const AVFrame& frame) {
  switch (frame.format) {
    case AV_PIX_FMT_YUVJ420P:
    case AV_PIX_FMT_YUVJ422P:
    case AV_PIX_FMT_YUVJ444P:
    case AV_PIX_FMT_YUVJ440P:
      return true;
    default:
      return frame.color_range == AVCOL_RANGE_JPEG;
  }
}

// Luma's shares of the same matrices.
YuvCoding yuv_coding(const AVFrame& frame) {
  switch (colour_matrix(frame)) {
    case SWS_CS_ITU709:
      return {0.2126, 0.0722, full_range(frame)};
    case SWS_CS_FCC:
      return {0.30, 0.11, full_range(frame)};
    case SWS_CS_SMPTE240M:
      return {0.212, 0.087, full_range(frame)};
    case SWS_CS_BT2020:
      return {0.2627, 0.0593, full_range(frame)};
    default:
      return {0.299, 0.114, full_range(frame)};
  }
}

ImageRgb turned(const ImageRgb& in, const PixelTurn& turn) {
  const auto [xx, xy, yx, yy] = turn.m;
  ImageRgb out{turn.swaps_sides() ? in.height : in.width, turn.swaps_sides() ? in.width : in.height, {}};
  out.pixels.resize(in.pixels.size());
  const int x0 = (xx < 0 ? in.width - 1 : 0) + (xy < 0 ? in.height - 1 : 0);
  const int y0 = (yx < 0 ? in.width - 1 : 0) + (yy < 0 ? in.height - 1 : 0);
  const uint8_t* from = in.pixels.data();
  for (int y = 0; y < in.height; ++y) {
    for (int x = 0; x < in.width; ++x, from += 3) {
      const int to_x = x0 + xx * x + xy * y;
      const int to_y = y0 + yx * x + yy * y;
      std::copy_n(from, 3, out.pixels.data() + 3 * (size_t(to_y) * out.width + to_x));
    }
  }
  return out;
}

}  // namespace

PixelTurn pixel_turn(const int32_t* display_matrix) {
  if (!display_matrix) return {};
  auto sign = [](int32_t fixed) { return std::abs(fixed) < (1 << 15) ? 0 : fixed > 0 ? 1 : -1; };
  // FFmpeg multiplies row vectors from the left: x' = a x + c y, y' = b x + d y with (a, b) in the first row.
  PixelTurn turn{{sign(display_matrix[0]), sign(display_matrix[3]), sign(display_matrix[1]), sign(display_matrix[4])}};
  const auto [xx, xy, yx, yy] = turn.m;
  return std::abs(xx * yy - xy * yx) == 1 && xx * xy == 0 && yx * yy == 0 ? turn : PixelTurn{};
}

PictureConverter::~PictureConverter() {
  sws_freeContext(scaler_);
}

void PictureConverter::convert(const AVFrame& frame, int width, int height, const PixelTurn& turn, ImageRgb& out) {
  const bool planar_420 = frame.format == AV_PIX_FMT_YUV420P || frame.format == AV_PIX_FMT_YUVJ420P;
  if (planar_420 && frame.width == width && frame.height == height) {
    rgb_from_yuv420({width,
                     height,
                     {frame.data[0], frame.data[1], frame.data[2]},
                     {frame.linesize[0], frame.linesize[1], frame.linesize[2]}},
                    yuv_coding(frame), out);
  } else {
    convert_any(frame, width, height, out);
  }
  if (!turn.is_identity()) out = turned(out, turn);
}

void PictureConverter::convert_any(const AVFrame& frame, int width, int height, ImageRgb& out) {
  const auto format_in = static_cast<AVPixelFormat>(frame.format);
  const int flags = SWS_BILINEAR | SWS_ACCURATE_RND | SWS_FULL_CHR_H_INT | SWS_FULL_CHR_H_INP;
  scaler_ = sws_getCachedContext(scaler_, frame.width, frame.height, format_in, width, height, AV_PIX_FMT_RGB24, flags,
                                 nullptr, nullptr, nullptr);
  if (!scaler_) {
    const char* name = av_get_pix_fmt_name(format_in);
    throw IoError(format("pixel format %s cannot be converted to RGB", name ? name : "?"));
  }
  const int* matrix = sws_getCoefficients(colour_matrix(frame));
  constexpr int kOne = 1 << 16;
  sws_setColorspaceDetails(scaler_, matrix, full_range(frame), matrix, 1, 0, kOne, kOne);
  out.width = width;
  out.height = height;
  out.pixels.resize(size_t(3) * width * height);
  uint8_t* const planes[4] = {out.pixels.data(), nullptr, nullptr, nullptr};
  const int strides[4] = {3 * width, 0, 0, 0};
  if (sws_scale(scaler_, frame.data, frame.linesize, 0, frame.height, planes, strides) < 0)
    throw IoError("conversion of a decoded picture to RGB failed");
}

}  // namespace livecap
