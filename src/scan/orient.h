// Which way around the triangles of a file run.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <vector>

#include "meshing/isosurface.h"

namespace livecap {

// Turns triangles, and their uvs (3 a triangle, or none), until all of a patch look to one side, that of most of its
// area. A patch is what hangs together by edges of two triangles. Then every closed patch is turned outwards; open ones
// so that together they enclose a positive volume. Returns how many triangles were turned.
size_t orient(meshing::Surface& surface, std::vector<Eigen::Vector2d>& uvs);

}  // namespace livecap
