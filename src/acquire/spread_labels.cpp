#include "acquire/spread_labels.h"

#include <queue>

#include "actor/labels.h"
#include "meshing/surface_parts.h"

namespace livecap::acquire {

namespace {

using Eigen::Vector3d;

constexpr double kDown = -0.7;  // of a normal's y, up in the rest frame: what is below it looks down
constexpr double kCrease = 10;  // times the way that an edge between normals at right angles is longer

void spread(const meshing::Surface& surface, const std::vector<std::vector<int>>& neighbors,
            const std::vector<Vector3d>& normals, bool legs_everywhere, std::vector<char>& known,
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
      const bool on_leg =
          labels[from] == lip::kLeftLeg || labels[from] == lip::kRightLeg || labels[from] == lip::kPants;
      if (known[to] || (on_leg && !legs_everywhere && normals[to].y() < kDown)) continue;
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

void spread_labels(const meshing::Surface& surface, std::vector<char> known, std::vector<uint8_t>& labels) {
  const std::vector<std::vector<int>> neighbors = meshing::neighbors_of(surface);
  const std::vector<Vector3d> normals = meshing::vertex_normals(surface);
  for (bool legs_everywhere : {false, true}) spread(surface, neighbors, normals, legs_everywhere, known, labels);
}

}  // namespace livecap::acquire
