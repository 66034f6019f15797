#include "eval/vertex_errors.h"

#include <algorithm>

#include "actor/labels.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap {

void VertexErrors::add(std::span<const double> direct_mm, std::span<const double> aligned_mm) {
  const int n = static_cast<int>(direct_mm.size());
  if (n_frames_ == 0) n_vertices_ = n;
  if (n != n_vertices_ || aligned_mm.size() != direct_mm.size()) {
    throw LogicError(
        format("errors of %zu and %zu vertices after %d", direct_mm.size(), aligned_mm.size(), n_vertices_));
  }
  direct_.insert(direct_.end(), direct_mm.begin(), direct_mm.end());
  aligned_.insert(aligned_.end(), aligned_mm.begin(), aligned_mm.end());
  ++n_frames_;
}

Summary VertexErrors::summary(const std::vector<float>& values, const std::function<bool(int)>& takes) const {
  std::vector<double> taken;
  for (int v = 0; v < n_vertices_; ++v) {
    if (takes && !takes(v)) continue;
    for (int64_t frame = 0; frame < n_frames_; ++frame) taken.push_back(values[frame * n_vertices_ + v]);
  }
  return summarize(std::move(taken));
}

std::vector<float> VertexErrors::mean_aligned() const {
  std::vector<double> sums(n_vertices_);
  for (int64_t frame = 0; frame < n_frames_; ++frame) {
    for (int v = 0; v < n_vertices_; ++v) sums[v] += aligned_[frame * n_vertices_ + v];
  }
  std::vector<float> means(n_vertices_);
  for (int v = 0; v < n_vertices_; ++v) means[v] = static_cast<float>(sums[v] / static_cast<double>(n_frames_));
  return means;
}

bool is_loose_garment(int label) {
  const std::string_view name = label >= 0 && label < kLabelCount ? kLabelNames[label] : "";
  return name == "dress" || name == "coat" || name == "skirt";
}

std::vector<LabelError> errors_by_label(const VertexErrors& errors, std::span<const uint8_t> labels) {
  if (static_cast<int>(labels.size()) != errors.n_vertices()) {
    throw LogicError(format("%zu labels of %d vertices", labels.size(), errors.n_vertices()));
  }
  std::vector<LabelError> rows;
  for (int label = 0; label < kLabelCount; ++label) {
    const int count = static_cast<int>(std::count(labels.begin(), labels.end(), label));
    if (count == 0) continue;
    const auto takes = [&](int vertex) { return labels[vertex] == label; };
    rows.push_back({std::string(kLabelNames[label]), count, errors.direct(takes), errors.aligned(takes)});
  }
  return rows;
}

}  // namespace livecap
