// The colours of a built surface: its texture, of pictures or of a scan, and what that says at each vertex.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <string>
#include <vector>

#include "base/image_rgb.h"
#include "meshing/actor_glb.h"
#include "meshing/atlas.h"
#include "scan/scan.h"
#include "texture/surface_views.h"
#include "texture/texture.h"

namespace livecap::acquire {

// The head and each arm have charts of their own: an arm held out would make a wide chart of the trunk, mostly empty.
// Head and neck have twice the texels per mm.
meshing::Atlas body_atlas(const meshing::Surface& surface, const std::vector<meshing::Influences>& weights, int size);

// blend_texture, with a note about what no picture shows. surface and views in the rest frame, mm.
BlendedTexture texture_from_views(const meshing::Surface& surface, const meshing::Atlas& atlas, int size,
                                  const std::vector<View>& views, const std::vector<ViewCoverage>& coverage,
                                  const std::vector<uint8_t>& labels, LightFrame light_frame,
                                  std::vector<std::string>& notes);

// size x size; of the nearest points of the scan, which lies where the surface does. Grey when it has no colour.
ImageRgb texture_from_scan(const meshing::Surface& surface, const meshing::Atlas& atlas, int size, const Scan& scan,
                           std::vector<std::string>& notes);

// The texture at each vertex: [n_vertices] sRGB in [0,1].
std::vector<Eigen::Vector3d> vertex_colors(const meshing::Surface& surface, const meshing::Atlas& atlas,
                                           const ImageRgb& texture);

}  // namespace livecap::acquire
