// A triangle mesh of any quality as a signed distance on a grid: open, overlapping or non-manifold meshes become solids
// (after Nooruddin & Turk, "Simplification and Repair of Polygonal Models Using Volumetric Techniques", 2003).
#pragma once

#include "scan/volume.h"

namespace livecap {

// A node is inside when most of the six axis rays from it cross the mesh more often outwards than inwards. Distances
// are exact within two steps of the mesh and cut there. The grid leaves four steps around the mesh.
Volume volume_of(const meshing::Surface& surface, double step_mm);

}  // namespace livecap
