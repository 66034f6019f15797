#include "image/ffmpeg_source.h"

extern "C" {
#include <libavcodec/avcodec.h>
#include <libavformat/avformat.h>
}

#include <algorithm>
#include <chrono>
#include <deque>
#include <filesystem>
#include <map>
#include <optional>
#include <string_view>
#include <thread>

#include "base/log.h"
#include "base/text.h"
#include "image/av_devices.h"
#include "image/picture_converter.h"
#include "livecap/error.h"

namespace livecap {
namespace {

// A demuxer that fails this often in a row has no more to give.
constexpr int kMaxReadErrors = 100;
constexpr double kDefaultFps = 30;

std::string error_text(int code) {
  char text[AV_ERROR_MAX_STRING_SIZE] = {};
  av_strerror(code, text, sizeof(text));
  return text;
}

struct FormatCloser {
  void operator()(AVFormatContext* format) const { avformat_close_input(&format); }
};
struct CodecFree {
  void operator()(AVCodecContext* codec) const { avcodec_free_context(&codec); }
};
struct PacketFree {
  void operator()(AVPacket* packet) const { av_packet_free(&packet); }
};
struct FrameFree {
  void operator()(AVFrame* frame) const { av_frame_free(&frame); }
};

// Every packet with a time stamp promises one frame at that time. Decoders put out frames in the order of time stamps,
// so a promise that is older than the frame just put out was broken: it becomes a damaged frame.
class FfmpegSource : public FrameSource {
 public:
  FfmpegSource(const std::string& name, const std::string& url, const AVInputFormat* input_format);
  VideoInfo info() const override { return info_; }
  bool read(Frame& out) override;
  int64_t damaged_frames() const override { return damaged_; }
  bool truncated() const override { return truncated_; }

 private:
  struct Promise {
    bool corrupt = false;  // the demuxer gave only a part of the packet
    bool failed = false;   // the decoder refused it
  };
  struct Pending {
    std::optional<int64_t> pts;
    bool damaged = false;
    std::unique_ptr<AVFrame, FrameFree> picture;  // as decoded; none: repeat the last good one
  };

  void open_decoder();
  void read_size_and_rate();
  bool pump();  // one packet, or the end; false when nothing more can come
  void decode(AVPacket* packet);
  void drain();
  void accept(const AVFrame& frame);
  void break_promises(int64_t before_pts, bool all_count);
  void lose_frame(std::optional<int64_t> pts) { pending_.push_back({pts, true, {}}); }
  void finish();
  bool ended_early() const;

  std::string name_;
  std::unique_ptr<AVFormatContext, FormatCloser> format_;
  std::unique_ptr<AVCodecContext, CodecFree> codec_;
  std::unique_ptr<AVPacket, PacketFree> packet_{av_packet_alloc()};
  std::unique_ptr<AVFrame, FrameFree> frame_{av_frame_alloc()};
  AVStream* stream_ = nullptr;
  PictureConverter converter_;
  PixelTurn turn_;
  VideoInfo info_;
  int stored_width_ = 0;
  int stored_height_ = 0;

  std::map<int64_t, Promise> promises_;
  std::deque<Pending> pending_;
  std::unique_ptr<AVFrame, FrameFree> last_good_;
  std::optional<int64_t> first_pts_;
  int64_t last_pts_ = 0;
  int64_t packets_ = 0;
  int64_t delivered_ = 0;
  int64_t damaged_ = 0;
  int read_errors_ = 0;
  bool hidden_frames_ = false;  // the codec has packets that show nothing
  bool at_end_ = false;
  bool truncated_ = false;
};

FfmpegSource::FfmpegSource(const std::string& name, const std::string& url, const AVInputFormat* input_format)
    : name_(name) {
  av_log_set_level(AV_LOG_QUIET);
  AVFormatContext* format = nullptr;
  int status = avformat_open_input(&format, url.c_str(), input_format, nullptr);
  if (status < 0) {
    throw IoError(name_ +
                  (input_format ? ": cannot be opened as a camera: "
                                : ": not a readable video (truncated, or no video at all): ") +
                  error_text(status));
  }
  format_.reset(format);
  // FFmpeg takes any text for ANSI art.
  if (std::string_view(format->iformat->name) == "tty") throw IoError(name_ + ": not a video file");
  status = avformat_find_stream_info(format, nullptr);
  if (status < 0) throw IoError(name_ + ": no video in it: " + error_text(status));
  open_decoder();
  read_size_and_rate();
  while (!last_good_ && pump()) {
    for (const Pending& item : pending_) {
      if (item.picture) last_good_.reset(av_frame_clone(item.picture.get()));
      if (last_good_) break;
    }
  }
  if (!last_good_) throw IoError(name_ + ": not one frame can be decoded: the file is truncated or damaged");
}

void FfmpegSource::open_decoder() {
  const AVCodec* decoder = nullptr;
  const int index = av_find_best_stream(format_.get(), AVMEDIA_TYPE_VIDEO, -1, -1, &decoder, 0);
  if (index == AVERROR_STREAM_NOT_FOUND) throw IoError(name_ + ": holds no video stream");
  if (index < 0 || !decoder) throw IoError(name_ + ": this FFmpeg has no decoder for its video codec");
  stream_ = format_->streams[index];
  for (unsigned i = 0; i < format_->nb_streams; ++i) {
    if (static_cast<int>(i) != index) format_->streams[i]->discard = AVDISCARD_ALL;
  }
  codec_.reset(avcodec_alloc_context3(decoder));
  avcodec_parameters_to_context(codec_.get(), stream_->codecpar);
  codec_->pkt_timebase = stream_->time_base;
  codec_->flags |= AV_CODEC_FLAG_OUTPUT_CORRUPT;
  codec_->flags2 |= AV_CODEC_FLAG2_SHOW_ALL;
  codec_->thread_count = 1;  // an error then belongs to the packet just sent, and the other cores are taken anyway
  const int status = avcodec_open2(codec_.get(), decoder, nullptr);
  if (status < 0) throw IoError(name_ + format(": decoder %s: ", decoder->name) + error_text(status));
  const AVCodecID id = decoder->id;
  hidden_frames_ = id == AV_CODEC_ID_VP8 || id == AV_CODEC_ID_VP9 || id == AV_CODEC_ID_AV1;
}

void FfmpegSource::read_size_and_rate() {
  stored_width_ = stream_->codecpar->width;
  stored_height_ = stream_->codecpar->height;
  if (stored_width_ <= 0 || stored_height_ <= 0) throw IoError(name_ + ": the video stream has no picture size");
  turn_ = pixel_turn(
      reinterpret_cast<const int32_t*>(av_stream_get_side_data(stream_, AV_PKT_DATA_DISPLAYMATRIX, nullptr)));
  info_.width = turn_.swaps_sides() ? stored_height_ : stored_width_;
  info_.height = turn_.swaps_sides() ? stored_width_ : stored_height_;
  const AVRational rate = av_guess_frame_rate(format_.get(), stream_, nullptr);
  info_.fps = rate.num > 0 && rate.den > 0 ? av_q2d(rate) : kDefaultFps;
  if (stream_->nb_frames > 0) {
    info_.frame_count_hint = stream_->nb_frames;
  } else if (format_->duration > 0) {
    info_.frame_count_hint =
        static_cast<int64_t>(static_cast<double>(format_->duration) / AV_TIME_BASE * info_.fps + 0.5);
  }
}

bool FfmpegSource::read(Frame& out) {
  while (pending_.empty() && pump()) {
  }
  if (pending_.empty()) return false;
  Pending item = std::move(pending_.front());
  pending_.pop_front();
  if (item.pts && !first_pts_) first_pts_ = item.pts;
  out.index = delivered_++;
  out.pts_ms = item.pts ? 1000.0 * static_cast<double>(*item.pts - *first_pts_) * av_q2d(stream_->time_base)
                        : 1000.0 * static_cast<double>(out.index) / info_.fps;
  out.damaged = item.damaged;
  damaged_ += item.damaged;
  if (item.picture) last_good_ = std::move(item.picture);
  converter_.convert(*last_good_, stored_width_, stored_height_, turn_, out.image);
  return true;
}

bool FfmpegSource::pump() {
  if (at_end_) return false;
  const int status = av_read_frame(format_.get(), packet_.get());
  if (status == AVERROR(EAGAIN)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    return true;
  }
  if (status == AVERROR_EOF || (status < 0 && ++read_errors_ > kMaxReadErrors)) {
    finish();
    return !pending_.empty();
  }
  if (status < 0) return true;
  read_errors_ = 0;
  if (packet_->stream_index == stream_->index) decode(packet_.get());
  av_packet_unref(packet_.get());
  return true;
}

void FfmpegSource::decode(AVPacket* packet) {
  ++packets_;
  const bool shown = !(packet->flags & AV_PKT_FLAG_DISCARD);
  const bool has_pts = packet->pts != AV_NOPTS_VALUE;
  const int64_t pts = packet->pts;
  if (shown && has_pts) promises_[pts].corrupt = packet->flags & AV_PKT_FLAG_CORRUPT;
  // An empty packet would tell the decoder that the stream is over.
  const int status = packet->size == 0 ? AVERROR_INVALIDDATA : avcodec_send_packet(codec_.get(), packet);
  if (status < 0 && shown) {
    if (has_pts) {
      promises_[pts].failed = true;
    } else {
      lose_frame(std::nullopt);
    }
  }
  drain();
}

void FfmpegSource::drain() {
  for (;;) {
    const int status = avcodec_receive_frame(codec_.get(), frame_.get());
    if (status == AVERROR(EAGAIN) || status == AVERROR_EOF) return;
    if (status < 0) {
      if (packet_->pts == AV_NOPTS_VALUE) {
        if (packet_->size > 0) lose_frame(std::nullopt);
      } else if (auto promise = promises_.find(packet_->pts); promise != promises_.end()) {
        promise->second.failed = true;
      }
      if (packet_->size == 0) return;  // flushing: never loop on a decoder that keeps failing
      continue;
    }
    accept(*frame_);
    av_frame_unref(frame_.get());
  }
}

void FfmpegSource::accept(const AVFrame& frame) {
  bool damaged = (frame.flags & AV_FRAME_FLAG_CORRUPT) || frame.decode_error_flags != 0;
  std::optional<int64_t> pts;
  if (frame.best_effort_timestamp != AV_NOPTS_VALUE) {
    pts = frame.best_effort_timestamp;
    last_pts_ = std::max(last_pts_, *pts);
    const auto promise = promises_.find(*pts);
    const bool kept = promise != promises_.end();
    // When this frame's own time stamp is unknown the stream's times cannot be trusted: only reported errors count.
    break_promises(*pts, kept && !hidden_frames_);
    if (kept) {
      damaged |= promise->second.corrupt || promise->second.failed;
      promises_.erase(promise);
    }
  }
  pending_.push_back({pts, damaged, std::unique_ptr<AVFrame, FrameFree>(av_frame_clone(&frame))});
  if (!pending_.back().picture) throw IoError(name_ + ": out of memory");
}

void FfmpegSource::break_promises(int64_t before_pts, bool all_count) {
  while (!promises_.empty() && promises_.begin()->first < before_pts) {
    const auto& [pts, promise] = *promises_.begin();
    if (all_count || promise.failed || promise.corrupt) lose_frame(pts);
    promises_.erase(promises_.begin());
  }
}

void FfmpegSource::finish() {
  at_end_ = true;
  av_packet_unref(packet_.get());
  avcodec_send_packet(codec_.get(), nullptr);
  drain();
  break_promises(INT64_MAX, !hidden_frames_);
  truncated_ = ended_early();
  const int64_t damaged = damaged_ + std::count_if(pending_.begin(), pending_.end(), [](auto& p) { return p.damaged; });
  if (damaged > 0) log_warning(name_ + format(": %lld damaged frames", static_cast<long long>(damaged)));
  if (truncated_) {
    const auto frames = static_cast<long long>(delivered_ + static_cast<int64_t>(pending_.size()));
    const auto promised = static_cast<long long>(info_.frame_count_hint);
    log_warning(name_ + (promised < 0
                             ? format(": broke off after %lld frames", frames)
                             : format(": the file is truncated: %lld frames of about %lld", frames, promised)));
  }
}

bool FfmpegSource::ended_early() const {
  if (read_errors_ > 0) return true;
  // MP4 lists every sample; its frame count may include samples cut off by an edit list, the index does not.
  if (std::string_view(format_->iformat->name).find("mp4") != std::string_view::npos)
    return packets_ < avformat_index_get_entries_count(stream_);
  if (stream_->nb_frames > 0) return packets_ < stream_->nb_frames;
  // Others promise a duration; another stream may be the longest, so only a lone video is judged.
  if (format_->nb_streams != 1 || format_->duration <= 0 ||
      format_->duration_estimation_method == AVFMT_DURATION_FROM_BITRATE)
    return false;
  const double start = stream_->start_time != AV_NOPTS_VALUE ? static_cast<double>(stream_->start_time) : 0;
  const double seen_s = (static_cast<double>(last_pts_) - start) * av_q2d(stream_->time_base);
  const double promised_s = static_cast<double>(format_->duration) / AV_TIME_BASE;
  return promised_s - seen_s > 0.5 + 2 / info_.fps;
}

}  // namespace

std::unique_ptr<FrameSource> open_video_file(const std::string& path) {
  // The explicit protocol keeps names with a colon from being taken for another one.
  return std::make_unique<FfmpegSource>(path, "file:" + path, nullptr);
}

std::unique_ptr<FrameSource> open_webcam(int index) {
  register_av_devices(format("webcam:%d", index));
  const AVInputFormat* v4l2 = av_find_input_format("v4l2");
  if (!v4l2) throw ConfigError(format("webcam:%d: this FFmpeg has no video4linux2 input", index));
  const std::string device = format("/dev/video%d", index);
  if (!std::filesystem::exists(device))
    throw IoError(format("webcam:%d: there is no %s; connect a camera or give another number", index, device.c_str()));
  return std::make_unique<FfmpegSource>(format("webcam:%d (%s)", index, device.c_str()), device, v4l2);
}

}  // namespace livecap
