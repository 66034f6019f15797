// The distances of all vertices in all judged frames, kept to be asked for by frame, by vertex and by material.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "eval/metrics.h"

namespace livecap {

class VertexErrors {
 public:
  // One frame: direct and translation-aligned distances, [n_vertices] mm each. Throws LogicError when the number of
  // vertices changes.
  void add(std::span<const double> direct_mm, std::span<const double> aligned_mm);

  int n_vertices() const { return n_vertices_; }
  int64_t n_frames() const { return n_frames_; }

  // Of all frames and the vertices for which `takes` is true (empty: all).
  Summary direct(const std::function<bool(int vertex)>& takes = {}) const { return summary(direct_, takes); }
  Summary aligned(const std::function<bool(int vertex)>& takes = {}) const { return summary(aligned_, takes); }

  // Mean over the frames, translation-aligned, mm. [n_vertices]
  std::vector<float> mean_aligned() const;

 private:
  Summary summary(const std::vector<float>& values, const std::function<bool(int)>& takes) const;

  int n_vertices_ = 0;
  int64_t n_frames_ = 0;
  std::vector<float> direct_, aligned_;  // [n_frames*n_vertices]
};

// Errors of the vertices of one label.
struct LabelError {
  std::string label;  // of actor/labels.h
  int n_vertices = 0;
  Summary direct;
  Summary aligned;
};

// True for garments that hang and swing: dress, coat, skirt.
bool is_loose_garment(int label);

// One row for each label the actor has, in the order of their ids. labels: [n_vertices] (LogicError).
std::vector<LabelError> errors_by_label(const VertexErrors& errors, std::span<const uint8_t> labels);

}  // namespace livecap
