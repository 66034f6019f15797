#include "scan/fill_uvs.h"

#include <algorithm>

namespace livecap {

namespace {

using Eigen::Vector2d;

class Filler {
 public:
  explicit Filler(Scan& scan) : scan_(scan), place_(scan.surface.vertices.size(), kNoUv) {
    for (size_t i = 0; i < scan.uvs.size(); ++i)
      if (scan.uvs[i] == kNoUv)
        bare_.push_back(i / 3);
      else
        place_[vertex(i / 3, i % 3)] = scan.uvs[i];
    bare_.erase(std::unique(bare_.begin(), bare_.end()), bare_.end());
  }

  size_t run() {
    const size_t n = bare_.size();
    while (!bare_.empty()) {
      const size_t before = bare_.size();
      known_ = place_;  // what is found in this round spreads in the next: equally far to all sides
      std::erase_if(bare_, [&](size_t t) { return spread(t); });
      if (bare_.size() < before) continue;
      const int first = vertex(bare_[0], 0);
      place_[first] = nearest_place(scan_.surface.vertices[first]);
    }
    return n;
  }

 private:
  int vertex(size_t t, size_t k) const { return scan_.surface.triangles[t][static_cast<int>(k)]; }

  // False when no corner of the triangle knows a place.
  bool spread(size_t t) {
    Vector2d uv = kNoUv;
    for (size_t k = 0; k < 3 && uv == kNoUv; ++k) uv = scan_.uvs[3 * t + k];
    for (size_t k = 0; k < 3 && uv == kNoUv; ++k) uv = known_[vertex(t, k)];
    if (uv == kNoUv) return false;
    for (size_t k = 0; k < 3; ++k) {
      scan_.uvs[3 * t + k] = uv;
      if (Vector2d& place = place_[vertex(t, k)]; place == kNoUv) place = uv;
    }
    return true;
  }

  Vector2d nearest_place(const Eigen::Vector3d& p) const {
    Vector2d nearest = Vector2d::Zero();
    double best = std::numeric_limits<double>::max();
    for (size_t i = 0; i < place_.size(); ++i)
      if (const double d = (scan_.surface.vertices[i] - p).squaredNorm(); place_[i] != kNoUv && d < best)
        best = d, nearest = place_[i];
    return nearest;
  }

  Scan& scan_;
  std::vector<Vector2d> place_, known_;  // by vertex
  std::vector<size_t> bare_;             // triangles
};

}  // namespace

size_t fill_uvs(Scan& scan) {
  if (std::all_of(scan.uvs.begin(), scan.uvs.end(), [](const Vector2d& uv) { return uv == kNoUv; })) {
    scan.uvs.clear();
    scan.texture = {};
    return 0;
  }
  return Filler(scan).run();
}

}  // namespace livecap
