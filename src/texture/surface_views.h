// Which vertices of the finished surface each view sees, and how well.
#pragma once

#include <filesystem>
#include <limits>
#include <vector>

#include "geometry/mesh.h"
#include "meshing/isosurface.h"
#include "ocl/context.h"
#include "views/view.h"

namespace livecap {

Mesh mesh_of(const meshing::Surface& surface);

inline constexpr float kEdgeOn = 0.1f;  // cosine; flatter views tell nothing of a vertex

// For one view, per vertex: the cosine between normal and viewing ray where the vertex is visible, 0 elsewhere; and its
// pixel. overlap: of the surface's silhouette with the view's mask, intersection over union; NaN without a mask.
struct ViewCoverage {
  std::vector<float> facing;            // [n_vertices]
  std::vector<Eigen::Vector2f> pixels;  // [n_vertices]
  double overlap = std::numeric_limits<double>::quiet_NaN();
};

// From what a visibility map (raster/visibility.h) says of positions and normals in the camera's frame, mm, [3*n].
// overlap stays NaN.
ViewCoverage coverage_of(const Camera& camera, const std::vector<int32_t>& visible, const std::vector<float>& positions,
                         const std::vector<float>& normals);

// views: in the mesh's frame, mm. One entry per view. A vertex is visible where none of the
// 3x3 pixels around it shows anything in front of it.
std::vector<ViewCoverage> cover_surface(ocl::DeviceContext& device, const Mesh& mesh, const std::vector<View>& views);

// 255 where the mesh covers a view's picture. One per view.
std::vector<ImageGray> draw_masks(ocl::DeviceContext& device, const Mesh& mesh, const std::vector<View>& views);

// Mean overlap of the views that have one, NaN when none has.
double mean_overlap(const std::vector<ViewCoverage>& coverage);

// What pictures can tell of a surface, given where their cameras stood (read_view_poses; the world is the mesh's frame
// in units of unit_mm) and its own silhouettes (masks/<stem>.png). [n_vertices] 1: some camera sees the vertex, not
// quite edge-on, and it is no concavity: in some picture it lies within kConcavityMm of the outline. 0: hidden, or
// deeper inside of every silhouette's cone, where the visual hull is not the surface. Throws IoError, ConfigError.
inline constexpr double kConcavityMm = 5;
std::vector<char> visible_hull_vertices(ocl::DeviceContext& device, const Mesh& mesh,
                                        const std::filesystem::path& cameras, const std::filesystem::path& masks,
                                        double unit_mm);

}  // namespace livecap
