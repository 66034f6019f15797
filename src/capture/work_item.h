// One frame on its way through the pipeline.
#pragma once

#include <memory>
#include <vector>

#include "base/detections.h"
#include "base/image_rgb.h"
#include "base/timer.h"
#include "capture/tracker.h"
#include "image/device_frame.h"
#include "image/foreground.h"
#include "image/silhouette.h"
#include "livecap/capture.h"

namespace livecap {

struct WorkItem {
  FrameReport report;
  std::vector<FrameReport> dropped_before;  // live pacing: older frames this one replaced
  ImageRgb image;                           // undistorted
  Detections detections;
  ForegroundGate gate;                 // for the second half of the segmentation
  bool nobody = false;                 // where the network sees somebody hardly anything differs from the empty plate
  ImageGray mask;                      // the person's pixels; empty when the network sees nobody
  Silhouette silhouette;               // no distances: these are in `frame`
  std::shared_ptr<DeviceFrame> frame;  // on the solver's device; until solved
  TrackResult result;
  Timer since_read;
};

}  // namespace livecap
