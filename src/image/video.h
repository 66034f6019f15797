// Video in and out (paper, "Input Stream Processing"): files, folders of pictures and webcams in, H.264 out.
//
// Files are read with FFmpeg's libraries directly, because a reader that silently drops damaged frames would shift
// every later result: here every frame of the input gives one Frame, and damage is counted and marked.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "image/frame.h"

namespace livecap {

struct VideoInfo {
  int width = 0;                  // px, rotation metadata applied
  int height = 0;                 // px
  double fps = 0;                 // average rate; 30 for a folder of pictures
  int64_t frame_count_hint = -1;  // what the container promises; -1 when it does not say
};

// Whether a source is a camera: "webcam:N".
bool is_webcam(const std::string& source);
// Whether it begins anew when it is opened again: a file or a folder, no camera and no pipe.
bool can_be_read_again(const std::string& source);

// Where frames come from; the implementations are private to this room.
class FrameSource {
 public:
  virtual ~FrameSource() = default;
  virtual VideoInfo info() const = 0;
  virtual bool read(Frame& out) = 0;
  virtual int64_t damaged_frames() const = 0;
  virtual bool truncated() const = 0;
};

// Not thread-safe. Frames come in presentation order with indices 0, 1, 2, ...
class VideoReader {
 public:
  // source: a video file, a folder of .png/.jpg pictures (in the order of their names), or "webcam:N" (/dev/videoN).
  // Throws IoError naming the file and what is wrong with it (missing, empty, not a video, no decodable frame), and
  // ConfigError for a webcam when libavdevice is not installed.
  explicit VideoReader(const std::string& source);
  ~VideoReader();
  VideoReader(VideoReader&&) noexcept;
  VideoReader& operator=(VideoReader&&) noexcept;

  VideoInfo info() const { return source_->info(); }
  // The next frame, RGB, info().width x info().height. False at the end; `out` is then unchanged.
  bool read(Frame& out);
  // Reads past the frames before the one of index `first`, which read() then gives. Throws ConfigError, which says how
  // many frames the video has, when it ends before that one: only its end tells for sure.
  void start_at(int64_t first);
  // Frames delivered so far that were marked damaged.
  int64_t damaged_frames() const { return source_->damaged_frames(); }
  // Known once read() has returned false: the file ended before the number of frames or the duration it promises.
  bool truncated() const { return source_->truncated(); }

 private:
  std::unique_ptr<FrameSource> source_;
  std::string name_;
  std::optional<Frame> ahead_;  // read by start_at()
};

// H.264 in MP4 (libx264, CRF 18, yuv420p, BT.709, index at the front). Everything goes to `<path>.part`, which close()
// renames: a file called `path` is always complete. Odd sizes grow by one repeated column or row (4:2:0 needs even
// ones).
class VideoWriter {
 public:
  // Throws IoError when the file cannot be written, ConfigError for a size or rate that is not positive.
  VideoWriter(const std::string& path, int width, int height, double fps);
  // Without close() the `.part` file stays behind.
  ~VideoWriter();
  VideoWriter(const VideoWriter&) = delete;
  VideoWriter& operator=(const VideoWriter&) = delete;

  // image must have the size given at construction (LogicError). Throws IoError, e.g. when the disk is full.
  void write(const ImageRgb& image);
  // Leaves out n frames: the next picture is shown so much later.
  void skip(int n);
  // Flushes, finalises, renames. Throws IoError. Further calls do nothing.
  void close();

 private:
  struct Encoder;
  std::unique_ptr<Encoder> encoder_;
};

}  // namespace livecap
