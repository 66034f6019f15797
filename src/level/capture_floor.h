// The floor that the person of a capture stands on.
#pragma once

#include "eval/capture_folder.h"
#include "pose/floor.h"

namespace livecap {

enum class FloorSource {
  kMeasured,    // it was given to the capture
  kFeet,        // below feet at rest, tilted as the capture had it in the end
  kLevelCamera  // neither, or not asked: the camera is taken to be level, and the lowest vertex to be on the floor
};

struct CaptureFloor {
  Floor floor;
  FloorSource source = FloorSource::kLevelCamera;
};

// Of all tracked rows. Throws IoError when no vertex tells.
CaptureFloor find_floor(CaptureFolder& capture);
CaptureFloor floor_of_level_camera(CaptureFolder& capture);

}  // namespace livecap
