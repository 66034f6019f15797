// One frame on its way through the pipeline.
#pragma once

#include <vector>

#include "base/image_rgb.h"
#include "base/timer.h"
#include "capture/tracker.h"
#include "image/silhouette.h"
#include "livecap/capture.h"
#include "livecap/detections.h"

namespace livecap {

struct WorkItem {
  FrameReport report;
  std::vector<FrameReport> dropped_before;  // live pacing: older frames this one replaced
  ImageRgb image;                           // undistorted
  Detections detections;
  ImageGray mask;  // the person's pixels; empty when the network sees nobody
  Silhouette silhouette;
  TrackResult result;
  Timer since_read;
};

}  // namespace livecap
