// The poses of a turn from its silhouettes. Tracks of the clothes tell how far the body turns from one picture to the
// next, but their drift adds up to a degree and tilts the axis, and keypoints are biased. The outlines of a rigid body
// all touch one body, and only where the poses are right (silhouette coherence: Hernandez, Schmitt and Cipolla,
// "Silhouette coherence for camera calibration under circular motion", 2007).
#pragma once

#include <vector>

#include "views/turn_bundle.h"
#include "views/view.h"

namespace livecap {

// Moves the deviations of turn, smoothly from view to view, to where the outlines miss the body that all masks allow by
// least. views: those of the turn, in its order, with masks. Nothing moves where that gains nothing.
void align_turn_by_silhouettes(const std::vector<View>& views, Turn& turn);

}  // namespace livecap
