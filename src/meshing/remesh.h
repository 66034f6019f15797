// A surface of as many, evenly spread triangles as asked.
#pragma once

#include "meshing/isosurface.h"

namespace livecap::meshing {

// Exactly target_vertices on `fine`, which must be closed and manifold; with no more than those it is returned as it
// is. Edges are split, collapsed and flipped and vertices move along the surface until all edges are about as long
// (Botsch and Kobbelt 2004, "A remeshing approach to multiresolution modeling"), but for those of curved places, which
// are down to half as long. Stays closed and manifold.
Surface remesh(const Surface& fine, int target_vertices);

}  // namespace livecap::meshing
