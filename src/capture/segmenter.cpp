#include "capture/segmenter.h"

#include <algorithm>

#include "capture/tracker_options.h"
#include "detect/blazepose.h"
#include "detect/crop.h"

namespace livecap {
namespace {

constexpr float kSeen = 0.5f;  // confidence
constexpr int kLeastSeen = 4;
// Of the box around the keypoints that are seen: with less foreground in it nobody is there. People had 0.25 and more,
// things in an empty room 0.07 and less.
constexpr double kLeastForeground = 0.1;

// The part of that box that is in the picture, px^2; 0 with too few keypoints to tell.
double area_of_keypoints(const Detections& detections, int width, int height) {
  double x0 = width, y0 = height, x1 = 0, y1 = 0;
  int n_seen = 0;
  for (const KeypointDetection& k : detections.keypoints) {
    if (!detections.person || k.confidence < kSeen) continue;
    ++n_seen;
    x0 = std::min<double>(x0, k.x_px), x1 = std::max<double>(x1, k.x_px);
    y0 = std::min<double>(y0, k.y_px), y1 = std::max<double>(y1, k.y_px);
  }
  if (n_seen < kLeastSeen) return 0;
  return std::max(0.0, std::min<double>(x1, width) - std::max(x0, 0.0)) *
         std::max(0.0, std::min<double>(y1, height) - std::max(y0, 0.0));
}

}  // namespace

Segmenter::Segmenter(ocl::DeviceContext& device, ocl::DeviceContext& gate_device, const BackgroundModel& background,
                     const Camera& camera, bool gated, int frames_under_way)
    : device_(device),
      width_(camera.width),
      height_(camera.height),
      foreground_(device, gate_device, background, camera.width, camera.height),
      distance_(device, camera.width, camera.height),
      sure_distance_(device, size_t(camera.width) * camera.height),
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
  for (ocl::Buffer<float>* distance : {&item.frame->signed_distance, &sure_distance_})
    distance_.compute(item.frame->mask, middle, middle.width() * middle.height(), *distance);
  distance_.leave_open(sure_distance_, item.frame->signed_distance);
  device_.finish();
  start_over();
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
    item.nobody = foreground_.has_background() && !item.gate.person.search.empty() &&
                  found.area_px < kLeastForeground * area_of_keypoints(item.detections, width_, height_);
    if (item.nobody) item.silhouette.area_px = 0, item.silhouette.box = {};
    if (item.silhouette.area_px > 0) {
      distance_.compute(item.frame->mask, found.box, found.area_px, item.frame->signed_distance);
      if (const auto sure = foreground_.find_sure(item.mask)) {
        distance_.compute(foreground_.sure_mask(), sure->box, sure->area_px, sure_distance_);
        distance_.leave_open(sure_distance_, item.frame->signed_distance);
      }
    }
    device_.finish();
  }
  item.report.stage_ms[static_cast<int>(CaptureStage::kSegment)] += timer.elapsed_ms();
}

}  // namespace livecap
