#include "acquire/material_labels.h"

#include <algorithm>
#include <array>
#include <utility>

#include "acquire/spread_labels.h"
#include "actor/labels.h"

namespace livecap::acquire {

namespace {

constexpr float kBorderVote = 0.25f;  // of a pixel beside one of another label, where a mm decides
constexpr float kFewVotes = 0.03f;    // of all label images or views

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
  spread_labels(surface, std::move(known), result.labels);
  return result;
}

std::vector<char> well_seen(const std::vector<ViewCoverage>& coverage) {
  if (coverage.empty()) return {};
  std::vector<char> seen(coverage.front().facing.size());
  for (size_t i = 0; i < seen.size(); ++i) {
    float sum = 0;
    for (const ViewCoverage& view : coverage)
      if (view.facing[i] > kEdgeOn) sum += view.facing[i];
    seen[i] = sum > kFewVotes * static_cast<float>(coverage.size());
  }
  return seen;
}

}  // namespace livecap::acquire
