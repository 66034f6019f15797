#include "acquire/material_labels.h"

#include <array>

#include "actor/labels.h"
#include "meshing/surface_parts.h"

namespace livecap::acquire {

MaterialLabels vote_labels(const meshing::Surface& surface, const std::vector<View>& views,
                           const std::vector<ViewCoverage>& coverage) {
  const size_t n = surface.vertices.size();
  std::vector<std::array<float, kLabelCount>> votes(n);
  for (auto& row : votes) row.fill(0);
  int64_t n_pixels = 0, n_foreign = 0;
  for (size_t v = 0; v < views.size(); ++v) {
    const ImageGray& image = views[v].labels;
    if (image.empty()) continue;
    for (size_t i = 0; i < n; ++i) {
      const float facing = coverage[v].facing[i];
      if (facing <= 0.1f) continue;
      const int x = static_cast<int>(std::lround(coverage[v].pixels[i].x())),
                y = static_cast<int>(std::lround(coverage[v].pixels[i].y()));
      if (x < 0 || y < 0 || x >= image.width || y >= image.height) continue;
      ++n_pixels;
      const int label = image.pixels[static_cast<size_t>(y) * image.width + x];
      if (label > 0 && label < kLabelCount) votes[i][label] += facing;
      n_foreign += label >= kLabelCount;
    }
  }
  MaterialLabels result;
  result.labels.assign(n, 0);
  if (n_pixels > 0) result.foreign = static_cast<double>(n_foreign) / static_cast<double>(n_pixels);
  std::vector<char> known(n, 0);
  for (size_t i = 0; i < n; ++i) {
    const auto best = std::max_element(votes[i].begin(), votes[i].end());
    known[i] = *best > 0;
    if (known[i]) result.labels[i] = static_cast<uint8_t>(best - votes[i].begin());
    result.n_unseen += !known[i];
  }
  const std::vector<std::vector<int>> neighbors = meshing::neighbors_of(surface);
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<char> next = known;
    for (size_t i = 0; i < n; ++i) {
      if (known[i]) continue;
      std::array<int, kLabelCount> count{};
      for (int other : neighbors[i])
        if (known[other]) ++count[result.labels[other]];
      const auto best = std::max_element(count.begin(), count.end());
      if (*best == 0) continue;
      result.labels[i] = static_cast<uint8_t>(best - count.begin());
      next[i] = 1;
      changed = true;
    }
    known.swap(next);
  }
  return result;
}

}  // namespace livecap::acquire
