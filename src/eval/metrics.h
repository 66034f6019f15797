// How far a capture is from the truth, as pure functions: vertex and joint distances under the three usual alignments
// (none, translation, similarity), and their summaries.
#pragma once

#include <cstdint>
#include <limits>
#include <span>
#include <vector>

namespace livecap {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();  // not measured

// Distance of each point of `estimate` to the same point of `truth`. Both [3*n], any unit -> [n]. Throws LogicError
// when sizes differ or are no multiple of 3.
std::vector<double> point_distances(std::span<const float> estimate, std::span<const float> truth);

// The same after the translation that minimises the sum of squared distances (both centroids on top of each other).
std::vector<double> translation_aligned_distances(std::span<const float> estimate, std::span<const float> truth);

// The same after the rotation, translation and uniform scale that minimise it (Umeyama, PAMI 1991; without reflection).
// Needs three points (LogicError). Points that coincide are aligned by translation alone.
std::vector<double> similarity_aligned_distances(std::span<const float> estimate, std::span<const float> truth);

struct Summary {
  int64_t n = 0;
  double mean = 0;
  double median = 0;
  double p05 = 0;  // 5 % of the values are below
  double p95 = 0;  // 5 % of the values are above
  double min = 0;
  double max = 0;
};

// Of finite values; zeros for an empty list. Quantiles interpolate linearly between neighbouring ranks.
Summary summarize(std::vector<double> values);

// NaN of nothing.
double mean_or_nan(const Summary& summary);
// Of the finite values; NaN when there are none.
double mean_of(std::vector<double> values);

}  // namespace livecap
