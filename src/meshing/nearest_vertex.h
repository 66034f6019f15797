#pragma once

#include <Eigen/Core>

#include "meshing/isosurface.h"

namespace livecap::meshing {

// Index of the vertex nearest to p; 0 for a surface without any.
inline int nearest_vertex(const Surface& surface, const Eigen::Vector3d& p) {
  int best = 0;
  for (size_t i = 1; i < surface.vertices.size(); ++i)
    if ((surface.vertices[i] - p).squaredNorm() < (surface.vertices[best] - p).squaredNorm())
      best = static_cast<int>(i);
  return best;
}

}  // namespace livecap::meshing
