#include "image/folder_source.h"

#include <algorithm>

#include "base/log.h"
#include "base/text.h"
#include "image/image_io.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr double kFolderFps = 30;

bool is_picture(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  return extension == ".png" || extension == ".jpg" || extension == ".jpeg";
}

}  // namespace

FolderSource::FolderSource(const std::filesystem::path& folder) {
  std::error_code error;
  for (const auto& entry : std::filesystem::directory_iterator(folder, error)) {
    if (entry.is_regular_file() && is_picture(entry.path())) files_.push_back(entry.path());
  }
  if (error) throw IoError(folder.string() + ": cannot be listed: " + error.message());
  if (files_.empty())
    throw IoError(folder.string() + ": holds no .png or .jpg picture, expected names like 000000.png");
  std::sort(files_.begin(), files_.end());
  last_ = read_image_rgb(files_.front());
  info_ = {last_.width, last_.height, kFolderFps, static_cast<int64_t>(files_.size())};
}

bool FolderSource::read(Frame& out) {
  if (next_ >= files_.size()) return false;
  out.index = static_cast<int64_t>(next_);
  out.pts_ms = 1000.0 * static_cast<double>(next_) / kFolderFps;
  out.damaged = false;
  const std::filesystem::path& file = files_[next_++];
  try {
    ImageRgb image = read_image_rgb(file);
    if (image.width != info_.width || image.height != info_.height)
      throw IoError(file.string() + format(": is %dx%d, the first picture is %dx%d", image.width, image.height,
                                           info_.width, info_.height));
    last_ = std::move(image);
  } catch (const IoError& e) {
    log_warning(std::string(e.what()) + " (the last good picture is repeated)");
    out.damaged = true;
    ++damaged_;
  }
  out.image = last_;
  return true;
}

}  // namespace livecap
