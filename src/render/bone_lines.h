// The skeleton as lines over a picture: the subject's left orange, right blue, the middle green.
#pragma once

#include <Eigen/Core>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "base/image_rgb.h"
#include "geometry/skeleton.h"
#include "render/viewpoint.h"

namespace livecap::render {

// Pairs of indices into `names`, the joints and keypoints of a capture: every bone from its parent, and on to wrists,
// hands, toes and the top of the head.
std::vector<std::pair<int, int>> bone_lines(const Skeleton& skeleton, const std::vector<std::string>& names);

// joints_mm: by name, camera frame. Lines with an end nearer than 100 mm to the camera are left out.
void draw_bones(const std::vector<std::pair<int, int>>& lines, const std::vector<std::string>& names,
                std::span<const Eigen::Vector3d> joints_mm, const Viewpoint& view, ImageRgb& canvas);

}  // namespace livecap::render
