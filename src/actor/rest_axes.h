// How somebody stands in a file: the turn by multiples of 90 degrees from its axes to those of the rest frame
// (geometry/skeleton.h).
#pragma once

#include <Eigen/Core>
#include <optional>

#include "actor/livecap_skeleton.h"

namespace livecap {

// The rotation among the 24 that map axes to axes which is nearest to m.
Eigen::Matrix3d nearest_axis_rotation(const Eigen::Matrix3d& m);

// rest_from_file of somebody whose neck, hips and shoulders are there, in any unit: the one of the 24 after which +X is
// the subject's left, +Y up and +Z the front. Nothing where these joints coincide.
std::optional<Eigen::Matrix3d> rest_from_file_axes(const RigPositions& joints);

}  // namespace livecap
