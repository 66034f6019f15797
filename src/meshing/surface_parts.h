// What many steps derive from a surface.
#pragma once

#include <vector>

#include "geometry/mesh.h"
#include "meshing/isosurface.h"

namespace livecap::meshing {

Surface surface_of(const Mesh& mesh);

// Of one edge of each triangle; 0 where there are none.
double mean_edge(const Surface& surface);

// Area-weighted unit normal of each vertex; of one without triangles (0, 0, 0).
std::vector<Eigen::Vector3d> vertex_normals(const Surface& surface);

// The vertices that share an edge with each; of a closed surface each once.
std::vector<std::vector<int>> neighbors_of(const Surface& surface);

// vertex_normals in the mean with their neighbours', `rounds` times: what the noise of a carved surface leaves of them.
std::vector<Eigen::Vector3d> smooth_normals(const Surface& surface, const std::vector<std::vector<int>>& neighbors,
                                            int rounds);

}  // namespace livecap::meshing
