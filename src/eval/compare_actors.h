// How far a built actor is from the true one: surface, joints, posing, materials.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "actor/actor.h"
#include "eval/metrics.h"

namespace livecap {

struct ActorComparison {
  Summary built_to_truth_mm;         // every vertex of the built actor to the true surface, after rigid alignment
  std::vector<double> distances_mm;  // [n_vertices of the built actor] of that
  Summary truth_to_built_mm;         // the other way; includes what no camera can see, such as the inside of a skirt
  std::vector<std::pair<std::string, Eigen::Vector3d>> joints_mm;   // built minus true: 15 bones and the wrists
  std::vector<std::pair<std::string, double>> surface_by_label_mm;  // mean of built_to_truth_mm per material
  double joints_mean_mm = 0;  // without root, chest and collarbones, which no picture tells
  Summary posed_mm;           // in test poses: a built vertex to the point of the true actor it lies on at rest
  double rest_mm = 0;         // the same at rest, mean: what of it is shape
  double labels = 0;          // share of the built vertices with the label of the nearest true vertex
  double rigidity = 0;        // the same for the seven rigidity classes
  // The same without what pictures cannot tell (concavities, hidden places): vertices whose nearest true triangle has
  // no corner they tell of. Empty and zero when it is not known.
  std::vector<char> hidden;  // [n_vertices of the built actor]
  Summary seen_built_to_truth_mm;
  double seen_labels = 0;
};

// Joint angles of the test poses, [n_poses][n_dofs]: random within three quarters of the limits, at most 80 degrees,
// the same every time.
std::vector<Eigen::VectorXd> test_poses(const Skeleton& skeleton, int n_poses);

// Skinned vertices [n] mm in the pose with these angles, root at rest; dual quaternions blended in double, apart from
// the tracker's.
std::vector<Eigen::Vector3d> pose_actor(const Actor& actor, const Skeleton& skeleton, const SkinWeights& skin,
                                        const Eigen::VectorXd& angles_rad);

// seen: [n_vertices of the truth] 1 where pictures can tell the true surface (texture/surface_views.h); empty: unknown.
ActorComparison compare_actors(const Actor& built, const Actor& truth, int n_poses = 20,
                               const std::vector<char>& seen = {});

// Lines of text.
std::string comparison_report(const ActorComparison& comparison);

}  // namespace livecap
