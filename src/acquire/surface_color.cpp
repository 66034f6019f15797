#include "acquire/surface_color.h"

#include <algorithm>
#include <cmath>

#include "acquire/body_rig.h"
#include "base/text.h"

namespace livecap::acquire {

using Eigen::Vector3d;

namespace {

enum AtlasGroup { kRestGroup, kHeadGroup, kLeftArmGroup, kRightArmGroup };
const std::vector<double> kGroupDensity = {1, 2, 1, 1};

AtlasGroup group_of(int bone) {
  if (bone == kHeadBone || bone == kNeckBone) return kHeadGroup;
  if (bone >= kLeftArmBone && bone <= kLeftKnuckleBone) return kLeftArmGroup;
  if (bone >= kRightArmBone && bone <= kRightKnuckleBone) return kRightArmGroup;
  return kRestGroup;
}

}  // namespace

meshing::Atlas body_atlas(const meshing::Surface& surface, const std::vector<meshing::Influences>& weights, int size) {
  std::vector<int> groups;
  for (const auto& t : surface.triangles) {
    // That of two corners, or of the first.
    const AtlasGroup a = group_of(weights[t[0]][0].bone), b = group_of(weights[t[1]][0].bone),
                     c = group_of(weights[t[2]][0].bone);
    groups.push_back(b == c ? b : a);
  }
  return meshing::make_atlas(surface, groups, kGroupDensity, size);
}

BlendedTexture texture_from_views(const meshing::Surface& surface, const meshing::Atlas& atlas, int size,
                                  const std::vector<View>& views, const std::vector<ViewCoverage>& coverage,
                                  const std::vector<uint8_t>& labels, LightFrame light_frame,
                                  std::vector<std::string>& notes) {
  BlendedTexture blended = blend_texture(surface, atlas, size, views, coverage, labels, light_frame);
  if (const auto unseen = std::count(blended.seen.begin(), blended.seen.end(), 0); unseen > 0)
    notes.push_back(format("%d vertices get no colour from any picture; it is spread from their neighbours",
                           static_cast<int>(unseen)));
  return blended;
}

ImageRgb texture_from_scan(const meshing::Surface& surface, const meshing::Atlas& atlas, int size, const Scan& scan,
                           std::vector<std::string>& notes) {
  if (!scan.has_color()) {
    notes.emplace_back("the scan has no colour: every vertex is grey, colour cannot guide the surface");
    return {size, size, std::vector<uint8_t>(static_cast<size_t>(3) * size * size, 153)};
  }
  // Cells of about three edges of the scan.
  const double cell = 3 * std::sqrt(3e6 / static_cast<double>(scan.surface.triangles.size()));
  const meshing::NearestSurface near(scan.surface, std::clamp(cell, 4.0, 40.0));
  return meshing::bake_texture(surface, atlas, size, [&](const meshing::SurfacePoint& point) {
    return scan.color_at(near.find(point.position));
  });
}

std::vector<Vector3d> vertex_colors(const meshing::Surface& surface, const meshing::Atlas& atlas,
                                    const ImageRgb& texture) {
  std::vector<Vector3d> colors(surface.vertices.size(), Vector3d::Constant(0.5));
  for (size_t i = 0; i < atlas.vertex.size(); ++i) {
    const auto x = static_cast<int>(std::clamp(atlas.uvs[i].x() * texture.width, 0.0, texture.width - 1.0)),
               y = static_cast<int>(std::clamp(atlas.uvs[i].y() * texture.height, 0.0, texture.height - 1.0));
    const uint8_t* p = &texture.pixels[3 * (static_cast<size_t>(y) * texture.width + x)];
    colors[atlas.vertex[i]] = Vector3d(p[0], p[1], p[2]) / 255;
  }
  return colors;
}

}  // namespace livecap::acquire
