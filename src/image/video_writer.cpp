extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
#include <libavutil/opt.h>
#include <libswscale/swscale.h>
}

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "base/log.h"
#include "base/output_path.h"
#include "base/text.h"
#include "image/video.h"
#include "livecap/error.h"

namespace livecap {

struct VideoWriter::Encoder {
  std::string path;
  int width = 0;  // of the pictures given
  int height = 0;
  AVFormatContext* container = nullptr;
  AVCodecContext* codec = nullptr;
  AVStream* stream = nullptr;
  SwsContext* scaler = nullptr;
  AVFrame* picture = nullptr;  // RGB copy with room at the end of each row: see write()
  AVFrame* frame = nullptr;
  AVPacket* packet = nullptr;
  int64_t next_pts = 0;
  bool closed = false;

  std::string part_path() const { return path + ".part"; }
  void check(int status, const char* what) const {
    if (status >= 0) return;
    char text[AV_ERROR_MAX_STRING_SIZE] = {};
    av_strerror(status, text, sizeof(text));
    throw IoError(path + ": " + what + " failed: " + text);
  }
  void open(double fps);
  void allocate_pictures();
  void open_codec(double fps);
  void write(const ImageRgb& image);
  void encode(const AVFrame* next);  // nullptr: no more
  void close();
  ~Encoder();
};

void VideoWriter::Encoder::open(double fps) {
  av_log_set_level(AV_LOG_QUIET);
  check(avformat_alloc_output_context2(&container, nullptr, "mp4", part_path().c_str()), "setting up MP4 output");
  open_codec(fps);
  stream = avformat_new_stream(container, nullptr);
  if (!stream) throw IoError(path + ": out of memory");
  check(avcodec_parameters_from_context(stream->codecpar, codec), "setting up the stream");
  stream->time_base = codec->time_base;
  stream->avg_frame_rate = codec->framerate;
  packet = av_packet_alloc();
  allocate_pictures();
  // No scaling, only colour conversion, so bilinear is the cheapest that is exact.
  scaler = sws_getContext(width, height, AV_PIX_FMT_RGB24, width, height, AV_PIX_FMT_YUV420P,
                          SWS_BILINEAR | SWS_ACCURATE_RND, nullptr, nullptr, nullptr);
  if (!scaler) throw IoError(path + ": colour conversion to yuv420p is not available");
  const int* bt709 = sws_getCoefficients(SWS_CS_ITU709);
  sws_setColorspaceDetails(scaler, bt709, 1, bt709, 0, 0, 1 << 16, 1 << 16);
  check(avio_open(&container->pb, ("file:" + part_path()).c_str(), AVIO_FLAG_WRITE), "opening for writing");
  AVDictionary* options = nullptr;
  av_dict_set(&options, "movflags", "+faststart", 0);
  const int status = avformat_write_header(container, &options);
  av_dict_free(&options);
  check(status, "writing the header");
}

void VideoWriter::Encoder::allocate_pictures() {
  // The converter's vector loads reach past the end of a row.
  constexpr int kReachPx = 64;
  picture = av_frame_alloc();
  picture->format = AV_PIX_FMT_RGB24;
  picture->width = width + kReachPx;
  picture->height = height;
  check(av_frame_get_buffer(picture, 0), "allocating a picture");
  frame = av_frame_alloc();
  frame->format = codec->pix_fmt;
  frame->width = codec->width;
  frame->height = codec->height;
  check(av_frame_get_buffer(frame, 0), "allocating a picture");
}

void VideoWriter::Encoder::open_codec(double fps) {
  const AVCodec* encoder = avcodec_find_encoder_by_name("libx264");
  if (!encoder) encoder = avcodec_find_encoder(AV_CODEC_ID_H264);
  if (!encoder) throw ConfigError(path + ": this FFmpeg has no H.264 encoder (libx264)");
  codec = avcodec_alloc_context3(encoder);
  codec->width = (width + 1) / 2 * 2;
  codec->height = (height + 1) / 2 * 2;
  codec->pix_fmt = AV_PIX_FMT_YUV420P;
  codec->framerate = av_d2q(fps, 100000);
  codec->time_base = av_inv_q(codec->framerate);
  codec->colorspace = AVCOL_SPC_BT709;
  codec->color_primaries = AVCOL_PRI_BT709;
  codec->color_trc = AVCOL_TRC_BT709;
  codec->color_range = AVCOL_RANGE_MPEG;
  if (container->oformat->flags & AVFMT_GLOBALHEADER) codec->flags |= AV_CODEC_FLAG_GLOBAL_HEADER;
  codec->thread_count = 1;  // the same pictures give the same file, however busy the machine is
  codec->flags |= AV_CODEC_FLAG_BITEXACT;
  av_opt_set(codec->priv_data, "crf", "18", 0);
  av_opt_set(codec->priv_data, "preset", "veryfast", 0);
  // x264's macroblock tree reads memory that it did not write: the same pictures would give a file that depends on what
  // the process did before.
  av_opt_set(codec->priv_data, "mbtree", "0", 0);
  check(avcodec_open2(codec, encoder, nullptr), "opening the H.264 encoder");
}

void VideoWriter::Encoder::write(const ImageRgb& image) {
  if (image.width != width || image.height != height || image.pixels.size() != size_t(3) * width * height)
    throw LogicError(path +
                     format(": picture of %dx%d written to a %dx%d video", image.width, image.height, width, height));
  if (closed) throw LogicError(path + ": written to after close");
  check(av_frame_make_writable(frame), "allocating a picture");
  // Pictures of odd size are converted in their own size; 4:2:0 already rounds chroma up, luma is repeated below.
  // What the converter reads past a row is its last pixel repeated, so that the same pictures give the same file.
  for (int y = 0; y < height; ++y) {
    uint8_t* row = picture->data[0] + static_cast<ptrdiff_t>(y) * picture->linesize[0];
    std::copy_n(image.pixels.data() + static_cast<size_t>(3) * width * y, 3 * width, row);
    for (int i = 3 * width; i < picture->linesize[0]; ++i) row[i] = row[i - 3];
  }
  sws_scale(scaler, picture->data, picture->linesize, 0, height, frame->data, frame->linesize);
  uint8_t* luma = frame->data[0];
  const int stride = frame->linesize[0];
  if (codec->width > width) {
    for (int y = 0; y < height; ++y) luma[y * stride + width] = luma[y * stride + width - 1];
  }
  if (codec->height > height) std::copy_n(luma + (height - 1) * stride, codec->width, luma + height * stride);
  frame->pts = next_pts++;
  encode(frame);
}

void VideoWriter::Encoder::encode(const AVFrame* next) {
  check(avcodec_send_frame(codec, next), "encoding");
  for (;;) {
    const int status = avcodec_receive_packet(codec, packet);
    if (status == AVERROR(EAGAIN) || status == AVERROR_EOF) return;
    check(status, "encoding");
    av_packet_rescale_ts(packet, codec->time_base, stream->time_base);
    packet->stream_index = stream->index;
    packet->duration = av_rescale_q(1, codec->time_base, stream->time_base);
    check(av_interleaved_write_frame(container, packet), "writing");
  }
}

void VideoWriter::Encoder::close() {
  if (closed) return;
  closed = true;
  encode(nullptr);
  check(av_write_trailer(container), "writing the index");
  check(avio_closep(&container->pb), "closing");
  std::error_code error;
  std::filesystem::rename(part_path(), path, error);
  if (error) throw IoError(path + ": cannot rename the finished " + part_path() + ": " + error.message());
}

VideoWriter::Encoder::~Encoder() {
  if (!closed) log_debug(path + ": not closed, what was encoded stays in " + part_path());
  if (container && container->pb) avio_closep(&container->pb);
  av_packet_free(&packet);
  av_frame_free(&picture);
  av_frame_free(&frame);
  sws_freeContext(scaler);
  avcodec_free_context(&codec);
  avformat_free_context(container);
}

VideoWriter::VideoWriter(const std::string& path, int width, int height, double fps) {
  if (width <= 0 || height <= 0) throw ConfigError(path + format(": video size %dx%d is not positive", width, height));
  if (!(fps > 0) || !std::isfinite(fps)) throw ConfigError(path + format(": frame rate %g is not positive", fps));
  require_no_pipe(path);  // the index is written before the pictures when all are known
  encoder_ = std::make_unique<Encoder>();
  encoder_->path = link_target(path).string();
  encoder_->width = width;
  encoder_->height = height;
  encoder_->open(fps);
}

VideoWriter::~VideoWriter() = default;
void VideoWriter::write(const ImageRgb& image) {
  encoder_->write(image);
}
void VideoWriter::skip(int n) {
  encoder_->next_pts += n;
}
void VideoWriter::close() {
  encoder_->close();
}

}  // namespace livecap
