// The axis of a turn from its silhouettes. Keypoints are biased, which tilts it by half a degree; but the outlines of a
// body that turns all touch one body, and only about the right axis (silhouette coherence: Hernandez, Schmitt and
// Cipolla, "Silhouette coherence for camera calibration under circular motion", 2007).
#pragma once

#include <vector>

#include "views/turn_bundle.h"
#include "views/view.h"

namespace livecap {

// Tilts turn.axis about turn.center_mm to where the outlines miss the body that all masks allow by least, in the mean.
// views: those of the turn, with masks. The axis stays where that gains nothing.
void tilt_axis_by_silhouettes(const std::vector<View>& views, Turn& turn);

}  // namespace livecap
