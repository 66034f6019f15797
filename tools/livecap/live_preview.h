// What is captured, drawn over the camera's pictures in a window while it happens.
#pragma once

#include <atomic>
#include <deque>
#include <future>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "actor/actor.h"
#include "base/image_rgb.h"
#include "capture/channel.h"
#include "image/undistort.h"
#include "livecap/live.h"

namespace livecap::tools {

// A thread of its own draws and shows; while it does, newer results replace each other.
class LivePreview {
 public:
  // camera: the pictures'. Opens the window; throws ConfigError (see VideoWindow).
  LivePreview(const LiveActor& actor, const Camera& camera, const std::string& title);
  ~LivePreview();
  LivePreview(const LivePreview&) = delete;
  LivePreview& operator=(const LivePreview&) = delete;

  // A picture that is about to be pushed, kept until its result comes.
  void expect(int64_t index, const ImageRgb& image);
  // Its result, from any thread.
  void show(const LiveResult& result);
  // Whether the user has closed the window.
  bool closed() const { return closed_; }

 private:
  struct Shown {
    ImageRgb image;
    std::vector<float> vertices_mm;  // camera frame; empty: nobody is tracked
  };
  ImageRgb drawn(Shown shown) const;
  void run(const std::string& title, std::promise<void> opened);

  Actor actor_;
  Undistorter undistorter_;
  Camera camera_;  // without distortion
  std::mutex mutex_;
  std::deque<std::pair<int64_t, ImageRgb>> expected_;  // by index
  Channel<Shown> to_show_;
  std::atomic<bool> closed_ = false;
  std::thread thread_;
};

}  // namespace livecap::tools
