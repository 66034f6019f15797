// Places in the texture for triangles that have none.
#pragma once

#include <limits>

#include "scan/scan.h"

namespace livecap {

// Stands for the texture coordinates of a corner that has none: finite, so that a file's nan is still told.
inline const Eigen::Vector2d kNoUv = Eigen::Vector2d::Constant(std::numeric_limits<double>::lowest());

// A triangle with such a corner has the colour of one place: of one of its own corners, else of a triangle beside it,
// else of the nearest one. Returns how many there were. A scan without any place is one without a texture.
size_t fill_uvs(Scan& scan);

}  // namespace livecap
