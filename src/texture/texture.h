// The colours of the surface from the pictures: every point takes the views that see it best, blended with weights that
// change smoothly over the surface, so that there are no seams.
#pragma once

#include <cstdint>
#include <vector>

#include "base/image_rgb.h"
#include "meshing/atlas.h"
#include "texture/surface_views.h"

namespace livecap {

// What the light of the pictures stands still with: the person, whom the camera went around, or the camera, before
// which they turned.
enum class LightFrame { kPerson, kCamera };

struct BlendedTexture {
  ImageRgb image;
  std::vector<char> seen;  // [n_vertices] 0: no view gives it a colour; that is spread from its neighbours
};

// labels: [n_vertices] LIP ids, or empty. A vertex takes its colour from views that label it so, where they have
// labels; what none shows has the colour of what is seen of its label, where vertices of that label connect the two.
BlendedTexture blend_texture(const meshing::Surface& surface, const meshing::Atlas& atlas, int size,
                             const std::vector<View>& views, const std::vector<ViewCoverage>& coverage,
                             const std::vector<uint8_t>& labels, LightFrame light_frame = LightFrame::kPerson);

// Colours of vertices that are not known from their neighbours, ring by ring; known: 1 there too
// from then on, but for what is connected to nothing known.
void spread_colors(const std::vector<std::vector<int>>& neighbors, std::vector<char>& known,
                   std::vector<Eigen::Vector3d>& colors);

}  // namespace livecap
