// Triangles instead of vertices on the surface. A limb of few triangles whose vertices lie on its surface is thinner
// than the limb, by 4 to 5 mm of a forearm at 5,000 vertices: less of the silhouette is covered, and a smaller body is
// taken for a farther one.
#pragma once

#include <functional>
#include <vector>

#include "meshing/isosurface.h"
#include "scan/volume.h"

namespace livecap::acquire {

// By how much a point of the surface, with its unit normal, lies outside of where it should, mm; NaN: unknown.
using OutsideMm = std::function<double(const Eigen::Vector3d& point, const Eigen::Vector3d& normal)>;

// How far each vertex is to move along its normal, mm, for the triangles around it to be as much outside as inside, in
// the mean of their points of which it is known; 0 where of none. rounds: of moving and asking again. [n_vertices], at
// most most_mm.
std::vector<double> mean_offsets(const meshing::Surface& surface, int rounds, double most_mm, const OutsideMm& outside);

// How far each vertex is to move along its normal, mm, for the triangles around it to lie as much outside of the
// volume's surface as inside. [n_vertices], at most a quarter of the mean edge.
std::vector<double> facet_offsets(const meshing::Surface& surface, const Volume& volume);

// How much of a move is made at p when what lies below lowest_mm (Y) stays: 0 there, 1 from 20 mm above it.
double ramp_above(double lowest_mm, const Eigen::Vector3d& p);

// Moves them.
void move_along_normals(const std::vector<double>& offsets_mm, meshing::Surface& surface);

}  // namespace livecap::acquire
