// Which vertices of the finished surface each view sees, and how well.
#pragma once

#include <vector>

#include "acquire/view.h"
#include "geometry/mesh.h"
#include "meshing/isosurface.h"
#include "ocl/context.h"

namespace livecap::acquire {

Mesh mesh_of(const meshing::Surface& surface);

// For one view, per vertex: the cosine between normal and viewing ray where the vertex is visible, 0 elsewhere; and its
// pixel.
struct ViewCoverage {
  std::vector<float> facing;            // [n_vertices]
  std::vector<Eigen::Vector2f> pixels;  // [n_vertices]
};

// views: in the mesh's frame, mm. One entry per view.
std::vector<ViewCoverage> cover_surface(ocl::DeviceContext& device, const Mesh& mesh, const std::vector<View>& views);

}  // namespace livecap::acquire
