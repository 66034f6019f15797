// What the rows of a frame are made of, packed as the kernels read it (kernels/pose/layout.h: PoseInputs): one upload
// for keypoints, floor, contour, matches and shaded vertices.
#pragma once

#include <span>
#include <vector>

#include "geometry/shaded_vertex.h"
#include "geometry/vertex_match.h"
#include "pose/floor.h"
#include "pose/layout.h"
#include "pose/pose_options.h"
#include "pose/targets.h"

namespace livecap {

class PoseRowInputs {
 public:
  PoseRowInputs() = default;
  PoseRowInputs(const PoseLayout& layout, const PoseOptions& options, int n_vertices);

  // More vertices than the options allow are thinned. Those of terms without weight are left out. Throws LogicError for
  // a vertex out of range.
  void set_frame(const KeypointTargets& targets, std::span<const int32_t> contour_vertices,
                 std::span<const VertexMatch> matches, std::span<const ShadedVertex> shaded);
  // stands: [n_soles]. floor nullptr: none is known, as before the first call. Throws LogicError for a wrong count.
  void set_floor(const Floor* floor, std::span<const double> stands);

  // The state that the device starts from, [LC_POSE_STATE_SIZE].
  void set_start(std::span<const double> state);

  int n_contour() const { return n_contour_; }
  int n_matches() const { return n_matches_; }
  int n_shaded() const { return n_shaded_; }
  double contour_weight() const { return contour_weight_; }  // of one contour row
  const PoseInputs& places() const { return places_; }
  std::span<const float> words() const { return words_; }
  size_t most_words() const;

 private:
  void add_contour(std::span<const int32_t> vertices);
  void require_vertex(int vertex, const char* what) const;

  PoseLayout layout_{};
  PoseOptions options_;
  int n_vertices_ = 0;
  int n_contour_ = 0;
  int n_matches_ = 0;
  int n_shaded_ = 0;
  double contour_weight_ = 0;
  PoseInputs places_{};
  std::vector<float> words_;
};

}  // namespace livecap
