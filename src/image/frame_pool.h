// Device frames on their way through the pipeline: a frame that nobody holds any more is filled again.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

#include "image/device_frame.h"

namespace livecap {

class FramePool {
 public:
  // n: frames made at once; more are made when they are needed. Both devices must outlive all frames, see DeviceFrame.
  FramePool(ocl::DeviceContext& device, ocl::DeviceContext& picture_device, int width, int height, int n = 0)
      : device_(device),
        picture_device_(picture_device),
        width_(width),
        height_(height),
        free_(std::make_shared<Free>()) {
    for (int i = 0; i < n; ++i)
      free_->frames.push_back(std::make_unique<DeviceFrame>(device, picture_device, width, height));
  }

  // A frame with anything in it. May be let go by another thread, after the device has finished with it.
  std::shared_ptr<DeviceFrame> take() {
    std::unique_ptr<DeviceFrame> frame;
    {
      std::lock_guard lock(free_->mutex);
      if (!free_->frames.empty()) {
        frame = std::move(free_->frames.back());
        free_->frames.pop_back();
      }
    }
    if (!frame) frame = std::make_unique<DeviceFrame>(device_, picture_device_, width_, height_);
    frame->has_picture = false;
    return {frame.release(), [free = free_](DeviceFrame* used) {
              std::lock_guard lock(free->mutex);
              free->frames.emplace_back(used);
            }};
  }

 private:
  struct Free {
    std::mutex mutex;
    std::vector<std::unique_ptr<DeviceFrame>> frames;
  };
  ocl::DeviceContext& device_;
  ocl::DeviceContext& picture_device_;
  int width_, height_;
  std::shared_ptr<Free> free_;
};

}  // namespace livecap
