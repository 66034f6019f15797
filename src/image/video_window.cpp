#include "image/video_window.h"

extern "C" {
#include <libavformat/avformat.h>
}

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <utility>
#include <vector>

#include "base/log.h"
#include "base/text.h"
#include "image/av_devices.h"
#include "livecap/error.h"

namespace livecap {

struct VideoWindow::Device {
  int width = 0, height = 0;
  AVFormatContext* muxer = nullptr;
  AVPacket* packet = av_packet_alloc();
  int64_t next_pts = 0;
  bool open = false;

  int write(const ImageRgb& image);  // what FFmpeg says of it
  void close() {
    if (std::exchange(open, false)) av_write_trailer(muxer);
  }
  ~Device() {
    close();
    av_packet_free(&packet);
    avformat_free_context(muxer);
  }
};

int VideoWindow::Device::write(const ImageRgb& image) {
  if (const int status = av_new_packet(packet, static_cast<int>(image.pixels.size())); status < 0) return status;
  std::copy(image.pixels.begin(), image.pixels.end(), packet->data);
  packet->pts = packet->dts = next_pts++;
  const int status = av_write_frame(muxer, packet);
  av_packet_unref(packet);
  return status;
}

void choose_window_driver() {
#ifdef __linux__
  setenv("SDL_VIDEODRIVER", std::getenv("WAYLAND_DISPLAY") ? "wayland,x11" : "x11", 0);
#endif
}

VideoWindow::VideoWindow(const std::string& title, int width, int height) : device_(std::make_unique<Device>()) {
  av_log_set_level(AV_LOG_QUIET);
  register_av_devices("no window");
  device_->width = width;
  device_->height = height;
  if (avformat_alloc_output_context2(&device_->muxer, nullptr, "sdl2", title.c_str()) < 0 &&
      avformat_alloc_output_context2(&device_->muxer, nullptr, "sdl", title.c_str()) < 0)
    throw ConfigError("no window: this FFmpeg has no SDL output device");
  AVStream* stream = avformat_new_stream(device_->muxer, nullptr);
  if (!stream || !device_->packet) throw ConfigError("no window: out of memory");
  stream->codecpar->codec_type = AVMEDIA_TYPE_VIDEO;
  stream->codecpar->codec_id = AV_CODEC_ID_RAWVIDEO;
  stream->codecpar->format = AV_PIX_FMT_RGB24;
  stream->codecpar->width = width;
  stream->codecpar->height = height;
  device_->open = avformat_write_header(device_->muxer, nullptr) >= 0;
  // FFmpeg 5.1 says only when it is given a picture that SDL found no desktop.
  if (!device_->open || device_->write({width, height, std::vector<uint8_t>(size_t(3) * width * height)}) < 0)
    throw ConfigError("no window can be opened: there is no desktop (is DISPLAY or WAYLAND_DISPLAY set?)");
}

bool VideoWindow::show(const ImageRgb& image) {
  if (image.width != device_->width || image.height != device_->height ||
      image.pixels.size() != size_t(3) * image.width * image.height)
    throw LogicError(format("picture of %dx%d shown in a window of %dx%d", image.width, image.height, device_->width,
                            device_->height));
  if (!device_->open) return false;
  const int status = device_->write(image);
  if (status >= 0) return true;
  if (status != AVERROR(EIO)) {  // that one says that the user has closed it
    char why[AV_ERROR_MAX_STRING_SIZE] = {};
    av_strerror(status, why, sizeof why);
    log_warning(std::string("the window shows no more pictures: ") + why);
  }
  device_->close();
  return false;
}

VideoWindow::~VideoWindow() = default;

}  // namespace livecap
