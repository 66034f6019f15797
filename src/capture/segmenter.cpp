#include "capture/segmenter.h"

#include "capture/tracker_options.h"
#include "detect/blazepose.h"

namespace livecap {

Segmenter::Segmenter(ocl::DeviceContext& device, ocl::DeviceContext& gate_device, const BackgroundModel& background,
                     const Camera& camera, bool gated, int frames_under_way)
    : device_(device),
      foreground_(device, gate_device, background, camera.width, camera.height),
      distance_(device, camera.width, camera.height),
      frames_(device, gate_device, camera.width, camera.height, frames_under_way),
      gated_(gated || !background.trained()) {
  foreground_.prepare_crop_masks(detect::BlazePose::kCropSize);
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
