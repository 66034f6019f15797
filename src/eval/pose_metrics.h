// Scores of single frames that know what a point is: which joint is the root, which are left and right, how far an
// angle may go. Pure functions beside eval/metrics.h.
#pragma once

#include <span>
#include <utility>
#include <vector>

namespace livecap {

// Threshold of 3DPCK and largest of its AUC (Mehta et al., 3DV 2017, "MPI-INF-3DHP"), mm.
inline constexpr double kPckMm = 150;

// Distances after both roots are on top of each other. The root itself, 0 by definition, is left out: [n-1]. Throws
// LogicError when sizes differ or there is no such point.
std::vector<double> root_aligned_distances(std::span<const float> estimate, std::span<const float> truth, int root);

// 3DPCK: share of the distances of at most threshold_mm. A distance that is not finite (no result) is a miss. NaN for
// an empty list.
double share_within(std::span<const double> distances_mm, double threshold_mm = kPckMm);

// Mean of 3DPCK at 0, 5, ..., 150 mm: the area under its curve as MPI-INF-3DHP computes it. NaN for an empty list.
double area_under_pck(std::span<const double> distances_mm);

// Left and right point of each pair, indices.
using SidePairs = std::vector<std::pair<int, int>>;

// Below this mean error of the pairs' points nothing counts as exchanged: limbs that are side by side are not.
inline constexpr double kExchangeMm = 60;

// True when calling the left points right and the right ones left would at least halve the mean error of the pairs, and
// that error is at least kExchangeMm. estimate and truth [3*n] mm are compared after the translation that aligns all
// their points. False without pairs. Throws LogicError when sizes differ.
bool sides_exchanged(std::span<const float> estimate, std::span<const float> truth, const SidePairs& pairs);

// A limb that was pulled into the body: a captured point of an arm nearer than this to the line from pelvis to neck ...
inline constexpr double kInsideTrunkMm = 90;
// ... while the true one is at least this far from the true line.
inline constexpr double kOutsideTrunkMm = 160;

// True when that holds for one of `points`. root, neck: indices of pelvis and neck; estimate and truth [3*n] mm. Throws
// LogicError when sizes differ.
bool limb_inside_trunk(std::span<const float> estimate, std::span<const float> truth, int root, int neck,
                       std::span<const int> points);

// An angle within so much of a limit, or beyond it, is at the limit.
inline constexpr double kLimitDeg = 1;

bool at_limit(double angle_deg, double min_deg, double max_deg);

}  // namespace livecap
