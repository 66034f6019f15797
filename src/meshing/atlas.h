// The texture of an actor: charts by projection along the six axes, packed on shelves, painted per texel from
// the position on the rest surface.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "base/image_rgb.h"
#include "meshing/isosurface.h"
#include "meshing/nearest_surface.h"

namespace livecap::meshing {

// Vertices repeated along chart borders. Copies of one vertex follow each other in the order of the vertices, so that
// the first occurrences are the vertices themselves.
struct Atlas {
  std::vector<int> vertex;                 // surface vertex of each textured vertex
  std::vector<Eigen::Vector2d> uvs;        // glTF: v down, [0,1]
  std::vector<Eigen::Vector3i> triangles;  // of textured vertices, in the order of the surface's
};

// group[t]: triangles of different groups never share a chart. density[g]: texels per length of a group, relative.
Atlas make_atlas(const Surface& surface, const std::vector<int>& group, const std::vector<double>& density, int size);

// color: of a point of the surface, sRGB in [0,1]. Texels around the charts repeat the nearest chart's border.
ImageRgb bake_texture(const Surface& surface, const Atlas& atlas, int size,
                      const std::function<Eigen::Vector3d(const SurfacePoint&)>& color);

}  // namespace livecap::meshing
