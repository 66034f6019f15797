#include "pose/row_inputs.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

// More than fit are thinned to equal shares of their total weight; what has no weight is left out.
template <typename Weighted>
std::vector<Weighted> thinned(std::span<const Weighted> all, int most) {
  if (all.size() <= size_t(most)) return {all.begin(), all.end()};
  double total = 0;
  for (const Weighted& one : all) total += one.weight;
  const double share = total / most;
  double sum = share / 2;
  std::vector<Weighted> used;
  for (const Weighted& one : all) {
    sum += one.weight;
    const double n_shares = std::floor(sum / share);
    if (!(n_shares >= 1) || used.size() == size_t(most)) continue;
    sum -= n_shares * share;
    used.push_back(one);
    used.back().weight = float(n_shares * share);
  }
  return used;
}

}  // namespace

PoseRowInputs::PoseRowInputs(const PoseLayout& layout, const PoseOptions& options, int n_vertices)
    : layout_(layout), options_(options), n_vertices_(n_vertices) {
  places_.targets = 2 * LC_POSE_STATE_SIZE(layout);
  places_.ground = places_.targets + LC_POSE_TARGET * kKeypointCount;
  places_.contour_vertices = places_.ground + LC_POSE_GROUND_STANDS + layout.n_soles;
  words_.assign(places_.contour_vertices, 0.0f);
}

size_t PoseRowInputs::most_words() const {
  return size_t(places_.contour_vertices) + size_t(options_.max_contour_vertices) +
         size_t(1 + LC_POSE_MATCH) * size_t(options_.max_matches) +
         size_t(1 + LC_POSE_SHADED) * size_t(options_.max_shaded);
}

// The message of a check that is made for every vertex of every round is only written when it fails.
void PoseRowInputs::require_vertex(int vertex, const char* what) const {
  if (vertex < 0 || vertex >= n_vertices_)
    throw LogicError(format("pose: %s vertex %d of %d", what, vertex, n_vertices_));
}

void PoseRowInputs::set_frame(const KeypointTargets& targets, std::span<const int32_t> contour_vertices,
                              std::span<const VertexMatch> matches, std::span<const ShadedVertex> shaded) {
  float* target = words_.data() + places_.targets;
  for (const KeypointTarget& t : targets) {
    for (double value :
         {t.position_px.x(), t.position_px.y(), t.detection_mm.x(), t.detection_mm.y(), t.detection_mm.z(),
          std::sqrt(t.weight_2d), std::sqrt(t.weight_3d), std::sqrt(t.weight_temporal), t.previous_position_mm.x(),
          t.previous_position_mm.y(), t.previous_position_mm.z(), 0.0})
      *target++ = float(value);
  }
  words_.resize(places_.contour_vertices);
  n_contour_ = n_matches_ = n_shaded_ = 0;
  contour_weight_ = 0;
  const auto add = [this](int32_t vertex, const char* what) {
    require_vertex(vertex, what);
    words_.push_back(std::bit_cast<float>(vertex));
  };
  if (options_.weights.silhouette > 0) add_contour(contour_vertices);

  places_.match_vertices = int(words_.size());
  const auto used_matches =
      options_.weights.match > 0 ? thinned(matches, options_.max_matches) : std::vector<VertexMatch>{};
  for (const VertexMatch& match : used_matches) add(match.vertex, "matched");
  places_.match_targets = int(words_.size());
  for (const VertexMatch& match : used_matches) {
    const float root = float(std::sqrt(options_.weights.match * match.weight));
    words_.insert(words_.end(), {match.u_px, match.v_px, root * match.a, root * match.b, root * match.c});
  }
  n_matches_ = int(used_matches.size());

  places_.shaded_vertices = int(words_.size());
  const auto used_shaded =
      options_.weights.shading > 0 ? thinned(shaded, options_.max_shaded) : std::vector<ShadedVertex>{};
  for (const ShadedVertex& skin : used_shaded) add(skin.vertex, "shaded");
  places_.shaded_targets = int(words_.size());
  for (const ShadedVertex& skin : used_shaded) {
    words_.insert(words_.end(), skin.light.begin(), skin.light.end());
    words_.insert(words_.end(), {skin.brightness, float(std::sqrt(options_.weights.shading * skin.weight))});
  }
  n_shaded_ = int(used_shaded.size());
}

// Thinned evenly; the kept vertices stand for all of them.
void PoseRowInputs::add_contour(std::span<const int32_t> vertices) {
  for (int32_t vertex : vertices) require_vertex(vertex, "contour");
  const size_t n = std::min(vertices.size(), size_t(options_.max_contour_vertices));
  if (n == 0) return;
  for (size_t i = 0; i < n; ++i) words_.push_back(std::bit_cast<float>(vertices[i * vertices.size() / n]));
  n_contour_ = int(n);
  contour_weight_ = options_.weights.silhouette * double(vertices.size()) / double(n);
}

void PoseRowInputs::set_floor(const Floor* floor, std::span<const double> stands) {
  float* ground = words_.data() + places_.ground;
  std::fill_n(ground, LC_POSE_GROUND_STANDS + layout_.n_soles, 0.0f);
  if (!floor || !(options_.weights.floor > 0)) return;
  if (stands.size() != size_t(layout_.n_soles))
    throw LogicError(format("pose: %zu points stand, the soles have %d", stands.size(), layout_.n_soles));
  const Eigen::Vector3f up = floor->up.cast<float>();
  const float head[] = {up.x(),
                        up.y(),
                        up.z(),
                        float(floor->offset_mm),
                        float(std::sqrt(options_.weights.floor)),
                        float(options_.floor_huber_mm)};
  std::copy(std::begin(head), std::end(head), ground);
  std::copy(stands.begin(), stands.end(), ground + LC_POSE_GROUND_STANDS);
}

void PoseRowInputs::set_start(std::span<const double> state) {
  std::memcpy(words_.data(), state.data(), state.size_bytes());
}

}  // namespace livecap
