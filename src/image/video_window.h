// A window on the desktop that shows pictures, by FFmpeg's SDL output device, which comes with what reads webcams.
#pragma once

#include <memory>
#include <string>

#include "base/image_rgb.h"

namespace livecap {

// Where there is no desktop SDL would open a window that nobody sees: tells it which desktops count, unless the user
// has (SDL_VIDEODRIVER). It changes the environment, so it is for a program to call while it has one thread.
void choose_window_driver();

// Open, show and close it in one thread: it answers the desktop while it shows a picture.
class VideoWindow {
 public:
  // Throws ConfigError where there is no desktop to open it on, or when libavdevice is not installed or is of an FFmpeg
  // without SDL.
  VideoWindow(const std::string& title, int width, int height);
  ~VideoWindow();
  VideoWindow(const VideoWindow&) = delete;
  VideoWindow& operator=(const VideoWindow&) = delete;

  // image must have the size given at construction (LogicError). False once the user has closed the window (its
  // button, Escape or q), or, with a warning, once it can show nothing; it is gone then.
  [[nodiscard]] bool show(const ImageRgb& image);

 private:
  struct Device;
  std::unique_ptr<Device> device_;
};

}  // namespace livecap
