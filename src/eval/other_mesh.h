// Truth of another mesh than the capture's: an actor made by `actor build` or `actor fit` against the person's own.
#pragma once

#include <span>
#include <vector>

#include "actor/actor.h"
#include "meshing/nearest_surface.h"

namespace livecap {

// True when the vertices of the one are those of the other, whatever their size.
bool same_mesh(const Actor& a, const Actor& b);

// The rigid motion that lays the actor's rest surface on the truth's, and the point of the true surface each moved
// vertex is nearest to.
struct RestOverlay {
  Eigen::Isometry3d truth_from_actor;
  std::vector<meshing::SurfacePoint> nearest;  // [n_vertices of the actor]
};
RestOverlay overlay_rest(const Actor& actor, const Actor& truth);

// The same laid the other way round: the point of the actor's rest surface that each true vertex is nearest to.
std::vector<meshing::SurfacePoint> true_vertices_on(const Actor& actor, const Actor& truth, const RestOverlay& overlay);

// Where the points of the true surface that the actor's vertices lie on at rest are, given the true vertices [3*n] and
// triangles; or those of the actor's that the true vertices lie on, given the captured ones.
std::vector<float> resample(const std::vector<meshing::SurfacePoint>& nearest, std::span<const int32_t> triangles,
                            std::span<const float> truth);

// Distances of every fifth captured vertex to the true surface, mm, after the translation that lays them on it: what
// differs in shape and pose, whatever slides along the surface. vertices: [3*n] mm; paired: [3*n] the true points that
// they should lie on, where the translation starts (the vertices' centroid would tell how densely places are meshed);
// truth: of another mesh or the same.
std::vector<double> surface_distances(std::span<const float> vertices, std::span<const float> paired,
                                      std::span<const float> truth, std::span<const int32_t> truth_triangles);

}  // namespace livecap
