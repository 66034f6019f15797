// A surface of as many, evenly spread vertices as asked.
#pragma once

#include "meshing/isosurface.h"

namespace livecap::meshing {

// target_vertices on `fine`, which must be closed and manifold; with no more than those it is returned as it is. Edges
// are split, collapsed and flipped and vertices move along the surface until all edges are about as long (Botsch and
// Kobbelt 2004, "A remeshing approach to multiresolution modeling"): from 0.5 of the usual length where it is curved to
// 1.3 where it is flat. Exactly so many vertices, but where no more edges can go without losing what sticks out there
// are more. Stays closed and manifold. Throws LogicError for fewer than 4 vertices or an open `fine`.
Surface remesh(const Surface& fine, int target_vertices);

}  // namespace livecap::meshing
