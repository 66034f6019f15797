// The light in pictures of a person who stands still: one brightness per direction of the surface. Baked into the
// texture it would lie; in a video the same light falls on the arm however it is turned, and texture matching (E_match)
// would turn the arm after it.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "meshing/isosurface.h"

namespace livecap {

// Lamps all around, infinitely far away, on a Lambertian surface that nothing shades: the sum of
// power * max(0, normal . lamp), of linear light. A polynomial in the normal would need the eighth order to follow
// where a lamp sets (docs/experiments_actor.md, "Lamps"), and could be negative.
struct Shading {
  static constexpr int kLamps = 96;
  Eigen::Matrix<double, kLamps, 3> powers;  // of red, green and blue, >= 0, by the mean over the surface
  bool found = false;

  // By how much more light a surface that faces there (unit normal) gets than the mean of all, in red, green and blue;
  // within 0.2..5. 1 when none was found.
  Eigen::Array3d at(const Eigen::Vector3d& normal) const;
};

// What an sRGB colour in [0,1] that was seen in such light is in the mean light.
Eigen::Vector3d without_light(const Eigen::Vector3d& color, const Eigen::Array3d& light);

// The normals that light is found and taken out with: those of a carved mesh are noisy.
std::vector<Eigen::Vector3d> shading_normals(const meshing::Surface& surface);

// From vertices anywhere on the body that have the same colour but for its brightness: most of them are of one material
// (Cauchy-robust), so they differ by their light. Neighbours would tell less: their normals differ by no more than the
// noise of a carved surface. colors: sRGB in [0,1] per vertex; known: 1 where they were seen. Too few known: no
// shading. normals: where each vertex faced when it was seen, in a frame in which the light stands still.
Shading find_shading(const meshing::Surface& surface, const std::vector<Eigen::Vector3d>& normals,
                     const std::vector<Eigen::Vector3d>& colors, const std::vector<char>& known);

}  // namespace livecap
