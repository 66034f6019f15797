#include <charconv>
#include <filesystem>

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

VideoReader::VideoReader(const std::string& source) : source_(open_source(source)) {}
VideoReader::~VideoReader() = default;
VideoReader::VideoReader(VideoReader&&) noexcept = default;
VideoReader& VideoReader::operator=(VideoReader&&) noexcept = default;

}  // namespace livecap
