#include <charconv>
#include <filesystem>
#include <utility>

#include "base/text.h"
#include "image/ffmpeg_source.h"
#include "image/folder_source.h"
#include "image/video.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr std::string_view kWebcamPrefix = "webcam:";

std::unique_ptr<FrameSource> open_source(const std::string& source) {
  if (source.empty()) throw ConfigError("video: empty name, expected a file, a folder of pictures or webcam:N");
  if (is_webcam(source)) {
    const std::string_view number = std::string_view(source).substr(kWebcamPrefix.size());
    int index = -1;
    const auto [end, error] = std::from_chars(number.data(), number.data() + number.size(), index);
    if (error != std::errc() || end != number.data() + number.size() || index < 0)
      throw ConfigError("video \"" + source + "\": expected webcam:N with N = 0, 1, ...");
    return open_webcam(index);
  }
  std::error_code error;
  const auto status = std::filesystem::status(source, error);
  if (!std::filesystem::exists(status)) throw IoError(source + ": no such file or folder");
  if (std::filesystem::is_directory(status)) return std::make_unique<FolderSource>(source);
  if (std::filesystem::is_regular_file(status) && std::filesystem::file_size(source, error) == 0 && !error)
    throw IoError(source + ": empty file, expected a video");
  return open_video_file(source);
}

}  // namespace

bool is_webcam(const std::string& source) {
  return source.starts_with(kWebcamPrefix);
}

bool can_be_read_again(const std::string& source) {
  if (is_webcam(source)) return false;
  std::error_code error;
  const auto status = std::filesystem::status(source, error);
  return std::filesystem::is_directory(status) || std::filesystem::is_regular_file(status);
}

VideoReader::VideoReader(const std::string& source) : source_(open_source(source)), name_(source) {}
VideoReader::~VideoReader() = default;
VideoReader::VideoReader(VideoReader&&) noexcept = default;
VideoReader& VideoReader::operator=(VideoReader&&) noexcept = default;

bool VideoReader::read(Frame& out) {
  if (!ahead_) return source_->read(out);
  out = std::move(*ahead_);
  ahead_.reset();
  return true;
}

void VideoReader::start_at(int64_t first) {
  if (first <= 0) return;
  int64_t n_frames = 0;
  for (Frame frame; read(frame);) {
    n_frames = frame.index + 1;
    if (frame.index < first) continue;
    ahead_ = std::move(frame);
    return;
  }
  throw ConfigError(format("--first %lld: ", static_cast<long long>(first)) + name_ +
                    format(" has %lld frames, the first is 0", static_cast<long long>(n_frames)));
}

}  // namespace livecap
