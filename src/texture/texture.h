// The colours of the surface from the pictures: every point takes the views that see it best, blended with weights that
// change smoothly over the surface, so that there are no seams.
#pragma once

#include <vector>

#include "base/image_rgb.h"
#include "meshing/atlas.h"
#include "texture/surface_views.h"

namespace livecap {

struct BlendedTexture {
  ImageRgb image;
  std::vector<char> seen;  // [n_vertices] 0: no view shows it; its colour is spread from its neighbours
};

BlendedTexture blend_texture(const meshing::Surface& surface, const meshing::Atlas& atlas, int size,
                             const std::vector<View>& views, const std::vector<ViewCoverage>& coverage);

// Colours of vertices that are not known from their neighbours, ring by ring.
void spread_colors(const std::vector<std::vector<int>>& neighbors, std::vector<char> known,
                   std::vector<Eigen::Vector3d>& colors);

}  // namespace livecap
