// The light in pictures of a person who stands still: one brightness per direction of the surface. Baked into the
// texture it would lie; in a video the same light falls on the arm however it is turned, and texture matching (E_match)
// would turn the arm after it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "meshing/isosurface.h"

namespace livecap {

// A polynomial of third order in the normal, of the logarithm, so that it stays positive. Light on Lambertian surfaces
// needs only the second order (Ramamoorthi and Hanrahan, "An Efficient Representation for Irradiance Environment Maps",
// 2001), but its logarithm bends more, most on the side turned away from a lamp.
struct Shading {
  static constexpr int kTerms = 15;
  Eigen::Vector<double, kTerms> coefficients = Eigen::Vector<double, kTerms>::Zero();
  double mean_log = 0;  // over the surface it was found on

  // By how much a surface that faces there (unit normal) is brighter than the mean of all; within 0.5..2.
  double at(const Eigen::Vector3d& normal) const;
};

// The normals that light is found and taken out with: those of a carved mesh are noisy.
std::vector<Eigen::Vector3d> shading_normals(const meshing::Surface& surface);

// From vertices anywhere on the body that have the same colour but for its brightness: most of them are of one material
// (Cauchy-robust), so they differ by their light. Neighbours would tell less: their normals differ by no more than the
// noise of a carved surface. colors: sRGB in [0,1] per vertex; known: 1 where they were seen. Too few known: no
// shading.
Shading find_shading(const meshing::Surface& surface, const std::vector<Eigen::Vector3d>& colors,
                     const std::vector<char>& known);

}  // namespace livecap
