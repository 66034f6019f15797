// The silhouette of a posed mesh in the input picture. A plain host rasteriser of its own: what judges the tracker
// shares no projection or coverage code with it.
#pragma once

#include <cstdint>
#include <span>

#include "base/image_rgb.h"
#include "livecap/camera.h"

namespace livecap {

struct ProjectedPoint {
  double x = 0;  // px
  double y = 0;
  bool visible = false;  // finite and at least 1 mm in front of the camera
};

// OpenCV's pinhole model with k1, k2, p1, p2, k3. point_mm: [3] camera frame.
ProjectedPoint project_point(const float* point_mm, const Camera& camera);

// 255 where a pixel centre lies in the projection of a triangle, else 0. positions: [3*n] mm, camera frame; lens
// distortion is applied to the vertices. Triangles with a vertex nearer than 1 mm or not finite are left out.
ImageGray render_silhouette(std::span<const float> positions_mm, std::span<const int32_t> triangles,
                            const Camera& camera);

}  // namespace livecap
