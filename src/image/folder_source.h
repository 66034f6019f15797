// A folder of pictures as a stream of frames.
#pragma once

#include <filesystem>
#include <vector>

#include "image/video.h"

namespace livecap {

// Pictures in the order of their names, 30 fps. A picture that cannot be read or has another size than the first is a
// damaged frame, never a missing one.
class FolderSource : public FrameSource {
 public:
  // Throws IoError when the folder holds no picture or the first one cannot be read.
  explicit FolderSource(const std::filesystem::path& folder);
  VideoInfo info() const override { return info_; }
  bool read(Frame& out) override;
  int64_t damaged_frames() const override { return damaged_; }
  bool truncated() const override { return false; }

 private:
  std::vector<std::filesystem::path> files_;
  VideoInfo info_;
  ImageRgb last_;
  size_t next_ = 0;
  int64_t damaged_ = 0;
};

}  // namespace livecap
