// Pictures of an actor for people to look at: strips of views side by side.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "actor/actor.h"
#include "base/image_rgb.h"

namespace livecap {

enum class StripColor { kTexture, kShape, kLabels, kWeights };

// The actor at rest, seen from n_views directions around it; with_bones draws the skeleton over it.
ImageRgb turnaround_strip(const Actor& actor, StripColor color, int n_views, bool with_bones = false);

// The actor at rest with these vertex colours, [3*n_vertices] sRGB in [0,1], from six sides; then from straight below.
ImageRgb painted_strip(const Actor& actor, const std::vector<float>& colors);

// The actor textured in these poses (joint angles, rad), from the front and a little from the side.
ImageRgb pose_strip(const Actor& actor, const std::vector<Eigen::VectorXd>& poses);

}  // namespace livecap
