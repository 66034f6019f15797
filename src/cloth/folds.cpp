#include "cloth/folds.h"

#include <algorithm>
#include <array>
#include <map>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "cloth/hanging_cloth.h"
#include "geometry/disjoint_sets.h"

namespace livecap {
namespace {

constexpr int kSections = 16;
constexpr float kLeastOnLegs = 0.05f;  // sum of a vertex's weights on them; with less, legs do not move it

// Where a plane cuts an edge of the mesh.
struct Cut {
  std::array<int, 2> edge;  // vertices, the lower index first
  cv::Point2f place;        // x and z, mm
};

// The cuts of one triangle; two or none.
std::vector<Cut> cuts_of(const Actor& actor, const int32_t* corners, float height) {
  std::vector<Cut> cuts;
  for (int k = 0; k < 3; ++k) {
    const auto [i, j] = std::minmax(corners[k], corners[(k + 1) % 3]);
    const float *p = &actor.mesh.positions[3 * i], *q = &actor.mesh.positions[3 * j];
    if ((p[1] < height) == (q[1] < height)) continue;
    const float t = (height - p[1]) / (q[1] - p[1]);
    cuts.push_back({{i, j}, {p[0] + t * (q[0] - p[0]), p[2] + t * (q[2] - p[2])}});
  }
  return cuts;
}

struct Section {
  double around = 0, hull = 0;  // mm
};

// The longest closed line of a section through these triangles (their corners); nothing where there is none.
Section section_at(const Actor& actor, const std::vector<const int32_t*>& triangles, float height) {
  std::map<std::array<int, 2>, int> points;  // by the edge that is cut
  std::vector<cv::Point2f> places;
  std::vector<std::pair<int, int>> lines;
  for (const int32_t* corners : triangles) {
    const std::vector<Cut> cuts = cuts_of(actor, corners, height);
    if (cuts.size() != 2) continue;
    std::array<int, 2> ends;
    for (int k = 0; k < 2; ++k) {
      const auto [at, is_new] = points.emplace(cuts[k].edge, int(places.size()));
      if (is_new) places.push_back(cuts[k].place);
      ends[k] = at->second;
    }
    lines.emplace_back(ends[0], ends[1]);
  }
  DisjointSets pieces(int(places.size()));
  for (const auto& [i, j] : lines) pieces.join(i, j);
  std::vector<double> around(places.size(), 0);
  std::vector<int> n_lines(places.size(), 0);
  for (const auto& [i, j] : lines) {
    around[pieces.find(i)] += cv::norm(places[i] - places[j]);
    ++n_lines[i], ++n_lines[j];
  }
  for (int i = 0; i < int(places.size()); ++i)
    if (n_lines[i] != 2) around[pieces.find(i)] = 0;  // it ends or branches
  if (places.empty()) return {};
  const int longest = int(std::max_element(around.begin(), around.end()) - around.begin());
  if (around[longest] == 0) return {};
  std::vector<cv::Point2f> of_longest, hull;
  for (int i = 0; i < int(places.size()); ++i)
    if (pieces.find(i) == longest) of_longest.push_back(places[i]);
  cv::convexHull(of_longest, hull);
  return {around[longest], cv::arcLength(hull, true)};
}

}  // namespace

double share_in_folds(const Actor& actor) {
  const std::vector<float> legs = leg_weights(actor);
  const auto moves = [&](int i) { return hangs(actor, i) && legs[i] >= kLeastOnLegs; };
  std::vector<const int32_t*> triangles;
  float low = 0, high = 0;
  for (int t = 0; t < actor.mesh.n_triangles(); ++t) {
    const int32_t* corners = &actor.mesh.triangles[3 * t];
    if (!std::all_of(corners, corners + 3, moves)) continue;
    for (int k = 0; k < 3; ++k) {
      const float y = actor.mesh.positions[3 * corners[k] + 1];
      low = triangles.empty() && k == 0 ? y : std::min(low, y);
      high = triangles.empty() && k == 0 ? y : std::max(high, y);
    }
    triangles.push_back(corners);
  }
  Section sum;
  for (int k = 0; k < kSections; ++k) {
    const Section section = section_at(actor, triangles, low + (high - low) * (float(k) + 0.5f) / kSections);
    sum.around += section.around;
    sum.hull += section.hull;
  }
  return sum.hull > 0 ? std::max(0.0, sum.around / sum.hull - 1) : 0;
}

}  // namespace livecap
