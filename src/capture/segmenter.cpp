#include "capture/segmenter.h"

#include <algorithm>

#include "capture/tracker_options.h"
#include "detect/blazepose.h"
#include "detect/crop.h"

namespace livecap {

Segmenter::Segmenter(ocl::DeviceContext& device, ocl::DeviceContext& gate_device, const BackgroundModel& background,
                     const Camera& camera, bool gated, int frames_under_way)
    : device_(device),
      width_(camera.width),
      height_(camera.height),
      foreground_(device, gate_device, background, camera.width, camera.height),
      distance_(device, camera.width, camera.height),
      frames_(device, gate_device, camera.width, camera.height, frames_under_way),
      gated_(gated || !background.trained()) {
  foreground_.prepare_crop_masks(detect::BlazePose::kCropSize);
}

void Segmenter::warm_up() {
  const PixelBox middle{width_ / 3, height_ / 4, 2 * width_ / 3, 3 * height_ / 4};
  constexpr int kSize = detect::BlazePose::kCropSize;
  ImageGray crop{kSize, kSize, std::vector<uint8_t>(size_t(kSize) * kSize, 0)};
  ImageGray mask{width_, height_, std::vector<uint8_t>(size_t(width_) * height_, 0)};
  for (int y = kSize / 4; y < 3 * kSize / 4; ++y) std::fill_n(&crop.pixels[y * kSize + kSize / 3], kSize / 3, 255);
  for (int y = middle.y0; y < middle.y1; ++y)
    std::fill_n(&mask.pixels[size_t(y) * width_ + middle.x0], middle.width(), 255);

  WorkItem item;
  item.image = {width_, height_, std::vector<uint8_t>(size_t(3) * width_ * height_, 128)};
  item.detections.person = true;
  item.detections.crop_mask = std::make_shared<const CropMask>(
      detect::place_mask(crop, detect::whole_image_crop(width_, height_), width_, height_));
  find_gate(item);
  segment(item);
  // A plate alone may have found nobody, or nothing else, and then there are no distances.
  item.frame->mask.write(mask.pixels);
  distance_.compute(item.frame->mask, middle, middle.width() * middle.height(), item.frame->signed_distance);
  device_.finish();
  missed_frames_ = kNobodyYet;
}

void Segmenter::find_gate(WorkItem& item) {
  Timer timer;
  const bool person = item.detections.person;
  missed_frames_ = person ? 0 : missed_frames_ + 1;
  if (person || (foreground_.has_background() && missed_frames_ <= kMaxMissedFrames)) {
    if (!item.frame) item.frame = frames_.take();
    item.gate = foreground_.find_gate(item.image, network_mask(item), crop_mask(item), *item.frame);
  } else {
    item.frame.reset();
  }
  item.report.stage_ms[static_cast<int>(CaptureStage::kSegment)] = timer.elapsed_ms();
}

void Segmenter::segment(WorkItem& item) {
  Timer timer;
  if (item.frame) {
    const ForegroundResult found =
        foreground_.segment(item.gate, network_mask(item), crop_mask(item) != nullptr, *item.frame, item.mask);
    item.silhouette.width = item.mask.width;
    item.silhouette.height = item.mask.height;
    item.silhouette.area_px = found.area_px;
    item.silhouette.box = found.box;
    if (found.area_px > 0) distance_.compute(item.frame->mask, found.box, found.area_px, item.frame->signed_distance);
    device_.finish();
  }
  item.report.stage_ms[static_cast<int>(CaptureStage::kSegment)] += timer.elapsed_ms();
}

}  // namespace livecap
