// What the rows of a frame are made of, packed as the kernels read it (kernels/pose/layout.h: PoseInputs): one upload
// for keypoints, floor, contour, matches and shaded vertices. Or without the last three, which a GPU can choose by
// itself (kernels/pose/choose.cl).
#pragma once

#include <bit>
#include <span>
#include <vector>

#include "geometry/seen_vertices.h"
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
  // n_rounds: what the host gives is there so many times, what the device chooses once.
  PoseRowInputs(const PoseLayout& layout, const PoseOptions& options, int n_vertices, int n_rounds = 1);

  // The round that set_... write to and arguments are of; 0 at first.
  void select_round(int round);

  void set_targets(const KeypointTargets& targets);
  // More vertices than the options allow are thinned. Those of terms without weight are left out. Throws LogicError for
  // a vertex out of range.
  void set_vertices(std::span<const int32_t> contour_vertices, std::span<const VertexMatch> matches,
                    std::span<const ShadedVertex> shaded);
  // By which the device chooses instead.
  void set_choice(const SeenVertices& seen);
  // stands: [n_soles]. floor nullptr: none is known, as before the first call. Throws LogicError for a wrong count.
  void set_floor(const Floor* floor, std::span<const double> stands);

  // [3*n_soles], or nothing. Throws LogicError for a wrong count.
  void set_soles_before(std::span<const float> soles_mm);

  // The state that the device starts from, [LC_POSE_STATE_SIZE].
  void set_start(std::span<const double> state);

  int n_contour() const { return count(LC_POSE_COUNT_CONTOUR); }
  int n_matches() const { return count(LC_POSE_COUNT_MATCHES); }
  int n_shaded() const { return count(LC_POSE_COUNT_SHADED); }
  float contour_root() const { return words_[places_.counts + LC_POSE_COUNT_CONTOUR_ROOT]; }  // of a vertex' weight
  // Of the matches, where the device chose; weights of matches.
  double missed_weight() const { return words_[places_.counts + LC_POSE_COUNT_MISSED]; }
  double seen_weight() const { return words_[places_.counts + LC_POSE_COUNT_SEEN]; }
  const PoseInputs& places() const { return places_; }
  std::span<const float> words() const { return words_; }
  // Without what the device chooses, of the first rounds.
  std::span<const float> words_given(int n_rounds = 1) const { return words().first(n_rounds * n_given_); }
  // For what the device chose: all of it, or its counts.
  std::span<float> words_read() { return words_; }
  std::span<float> counts_read() { return std::span(words_).subspan(places_.counts, LC_POSE_COUNTS); }

 private:
  void set_contour(std::span<const int32_t> vertices);
  int count(int of) const { return std::bit_cast<int32_t>(words_[places_.counts + of]); }
  void set_count(int of, size_t n) { words_[places_.counts + of] = std::bit_cast<float>(int32_t(n)); }
  void require_vertex(int vertex, const char* what) const;

  PoseLayout layout_{};
  PoseOptions options_;
  int n_vertices_ = 0;
  PoseInputs places_{};
  int n_given_ = 0;  // words of each round that the host gives
  std::vector<float> words_;
};

}  // namespace livecap
