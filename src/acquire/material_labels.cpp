#include "acquire/material_labels.h"

#include <algorithm>
#include <array>
#include <queue>

#include "actor/labels.h"
#include "meshing/surface_parts.h"

namespace livecap::acquire {

namespace {

constexpr float kBorderVote = 0.25f;  // of a pixel beside one of another label, where a mm decides
constexpr float kFewVotes = 0.03f;    // of all label images; fewer are of edges: a built hem is mm beside the true one
constexpr double kDown = -0.7;        // of a normal's y, up in the rest frame: what is below it looks down
constexpr double kCrease = 10;        // times the way that an edge between normals at right angles is longer

// Whether the 3x3 pixels around have one label.
bool is_even_around(const ImageGray& image, int x, int y) {
  const auto at = [&](int column, int row) {
    return image.pixels[static_cast<size_t>(std::clamp(row, 0, image.height - 1)) * image.width +
                        std::clamp(column, 0, image.width - 1)];
  };
  for (int row = y - 1; row <= y + 1; ++row)
    for (int column = x - 1; column <= x + 1; ++column)
      if (at(column, row) != at(x, y)) return false;
  return true;
}

// Vertices without a label take that of the nearest with one, along the surface, where a crease is a long way: inside
// of a skirt nothing is seen, legs go on in it and its lining does not go down on them. They end where it closes: what
// looks down there is no leg, unless `legs_everywhere`.
void spread_labels(const meshing::Surface& surface, const std::vector<std::vector<int>>& neighbors,
                   const std::vector<Eigen::Vector3d>& normals, bool legs_everywhere, std::vector<char>& known,
                   std::vector<uint8_t>& labels) {
  struct Step {
    double way;
    int vertex;
    uint8_t label;
    bool operator<(const Step& other) const {
      return way != other.way ? way > other.way : vertex != other.vertex ? vertex > other.vertex : label > other.label;
    }
  };
  std::priority_queue<Step> next;
  const auto leave = [&](int from, double way) {
    for (int to : neighbors[from]) {
      const bool is_leg = labels[from] == lip::kLeftLeg || labels[from] == lip::kRightLeg;
      if (known[to] || (is_leg && !legs_everywhere && normals[to].y() < kDown)) continue;
      const double length = (surface.vertices[to] - surface.vertices[from]).norm();
      next.push({way + length * (1 + kCrease * (1 - normals[from].dot(normals[to]))), to, labels[from]});
    }
  };
  for (size_t i = 0; i < known.size(); ++i)
    if (known[i]) leave(static_cast<int>(i), 0);
  while (!next.empty()) {
    const Step step = next.top();
    next.pop();
    if (known[step.vertex]) continue;
    known[step.vertex] = 1;
    labels[step.vertex] = step.label;
    leave(step.vertex, step.way);
  }
}

}  // namespace

MaterialLabels vote_labels(const meshing::Surface& surface, const std::vector<View>& views,
                           const std::vector<ViewCoverage>& coverage) {
  const size_t n = surface.vertices.size();
  std::vector<std::array<float, kLabelCount>> votes(n);
  for (auto& row : votes) row.fill(0);
  int64_t n_pixels = 0, n_foreign = 0;
  int n_images = 0;
  for (size_t v = 0; v < views.size(); ++v) {
    const ImageGray& image = views[v].labels;
    if (image.empty()) continue;
    ++n_images;
    for (size_t i = 0; i < n; ++i) {
      const float facing = coverage[v].facing[i];
      if (facing <= kEdgeOn) continue;
      const int x = static_cast<int>(std::lround(coverage[v].pixels[i].x())),
                y = static_cast<int>(std::lround(coverage[v].pixels[i].y()));
      if (x < 0 || y < 0 || x >= image.width || y >= image.height) continue;
      ++n_pixels;
      const int label = image.pixels[static_cast<size_t>(y) * image.width + x];
      if (label > 0 && label < kLabelCount) votes[i][label] += facing * (is_even_around(image, x, y) ? 1 : kBorderVote);
      n_foreign += label >= kLabelCount;
    }
  }
  MaterialLabels result;
  result.labels.assign(n, 0);
  if (n_pixels > 0) result.foreign = static_cast<double>(n_foreign) / static_cast<double>(n_pixels);
  std::vector<char> known(n, 0);
  for (size_t i = 0; i < n; ++i) {
    const auto best = std::max_element(votes[i].begin(), votes[i].end());
    known[i] = *best > kFewVotes * static_cast<float>(n_images);
    if (known[i]) result.labels[i] = static_cast<uint8_t>(best - votes[i].begin());
    result.n_unseen += !known[i];
  }
  const std::vector<std::vector<int>> neighbors = meshing::neighbors_of(surface);
  const std::vector<Eigen::Vector3d> normals = meshing::vertex_normals(surface);
  for (bool legs_everywhere : {false, true})
    spread_labels(surface, neighbors, normals, legs_everywhere, known, result.labels);
  return result;
}

}  // namespace livecap::acquire
