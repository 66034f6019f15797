#include "pose/row_inputs.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <utility>

#include "base/round_up.h"
#include "base/text.h"
#include "livecap/error.h"
#include "pose/thinning.h"
#include "shared/seen_weight.h"

namespace livecap {
namespace {

// More than fit are thinned to equal shares of their total weight; what has no weight is left out.
template <typename Weighted>
std::vector<Weighted> thinned(std::span<const Weighted> all, int most) {
  if (all.size() <= size_t(most)) return {all.begin(), all.end()};
  lc_exact_t total = 0, sum = 0;
  for (const Weighted& one : all) total += LC_EXACT(one.weight);
  const Shares shares = shares_of(total, most);
  std::vector<Weighted> used;
  for (const Weighted& one : all) {
    const lc_exact_t before = std::exchange(sum, sum + LC_EXACT(one.weight));
    const double n_shares = shares_until(sum, shares) - shares_until(before, shares);
    if (!(n_shares >= 1) || used.size() == size_t(most)) continue;
    used.push_back(one);
    used.back().weight = float(n_shares * shares.each * LC_EXACT_UNIT);
  }
  return used;
}

}  // namespace

PoseRowInputs::PoseRowInputs(const PoseLayout& layout, const PoseOptions& options, int n_vertices, int n_rounds)
    : layout_(layout), options_(options), n_vertices_(n_vertices) {
  int end = 0;
  const auto next = [&end](int n) { return std::exchange(end, end + n); };
  places_.start = next(2 * LC_POSE_STATE_SIZE(layout));
  places_.choice = next(2 * LC_POSE_CHOICE_NUMBERS);
  places_.lights = next(2 * LC_POSE_LIGHT);
  places_.targets = next(LC_POSE_TARGET * kKeypointCount);
  places_.ground = next(LC_POSE_GROUND_STANDS + layout.n_soles);
  places_.soles_before = next(3 * layout.n_soles);
  n_given_ = int(round_up(end, 2));  // each round begins with doubles
  end = n_rounds * n_given_;
  places_.counts = next(LC_POSE_COUNTS);
  places_.contour_vertices = next(options.max_contour_vertices);
  places_.match_vertices = next(options.max_matches);
  places_.match_targets = next(LC_POSE_MATCH * options.max_matches);
  places_.shaded_vertices = next(options.max_shaded);
  places_.shaded_targets = next(LC_POSE_SHADED * options.max_shaded);
  words_.assign(end, 0.0f);
}

void PoseRowInputs::select_round(int round) {
  const int by = round * n_given_ - places_.start;
  for (int* place :
       {&places_.start, &places_.choice, &places_.lights, &places_.targets, &places_.ground, &places_.soles_before})
    *place += by;
}

// The message of a check that is made for every vertex of every round is only written when it fails.
void PoseRowInputs::require_vertex(int vertex, const char* what) const {
  if (vertex < 0 || vertex >= n_vertices_)
    throw LogicError(format("pose: %s vertex %d of %d", what, vertex, n_vertices_));
}

void PoseRowInputs::set_targets(const KeypointTargets& targets) {
  float* target = words_.data() + places_.targets;
  for (const KeypointTarget& t : targets) {
    for (double value :
         {t.position_px.x(), t.position_px.y(), t.detection_mm.x(), t.detection_mm.y(), t.detection_mm.z(),
          std::sqrt(t.weight_2d), std::sqrt(t.weight_3d), std::sqrt(t.weight_temporal), t.previous_position_mm.x(),
          t.previous_position_mm.y(), t.previous_position_mm.z(), 0.0})
      *target++ = float(value);
  }
}

void PoseRowInputs::set_vertices(std::span<const int32_t> contour_vertices, std::span<const VertexMatch> matches,
                                 std::span<const ShadedVertex> shaded) {
  const PoseWeights& weights = options_.weights;
  set_contour(weights.silhouette > 0 ? contour_vertices : std::span<const int32_t>{});

  const auto used_matches = weights.match > 0 ? thinned(matches, options_.max_matches) : std::vector<VertexMatch>{};
  float* vertex = words_.data() + places_.match_vertices;
  float* target = words_.data() + places_.match_targets;
  for (const VertexMatch& match : used_matches) {
    require_vertex(match.vertex, "matched");
    *vertex++ = std::bit_cast<float>(match.vertex);
    const float root = row_root(weights.match, match.weight);
    for (float value : {match.u_px, match.v_px, root * match.a, root * match.b, root * match.c}) *target++ = value;
  }
  set_count(LC_POSE_COUNT_MATCHES, used_matches.size());

  const auto used_shaded = weights.shading > 0 ? thinned(shaded, options_.max_shaded) : std::vector<ShadedVertex>{};
  vertex = words_.data() + places_.shaded_vertices;
  target = words_.data() + places_.shaded_targets;
  for (const ShadedVertex& skin : used_shaded) {
    require_vertex(skin.vertex, "shaded");
    *vertex++ = std::bit_cast<float>(skin.vertex);
    target = std::copy(skin.light.begin(), skin.light.end(), target);
    *target++ = skin.brightness;
    *target++ = row_root(weights.shading, skin.weight);
  }
  set_count(LC_POSE_COUNT_SHADED, used_shaded.size());
}

// Thinned evenly; the kept vertices stand for all of them.
void PoseRowInputs::set_contour(std::span<const int32_t> vertices) {
  for (int32_t vertex : vertices) require_vertex(vertex, "contour");
  const size_t n = std::min(vertices.size(), size_t(options_.max_contour_vertices));
  for (size_t i = 0; i < n; ++i)
    words_[places_.contour_vertices + i] = std::bit_cast<float>(vertices[i * vertices.size() / n]);
  set_count(LC_POSE_COUNT_CONTOUR, n);
  words_[places_.counts + LC_POSE_COUNT_CONTOUR_ROOT] =
      contour_row_root(options_.weights.silhouette, double(vertices.size()), double(n));
}

void PoseRowInputs::set_choice(const SeenVertices& seen) {
  std::ranges::fill(counts_read(), 0.0f);  // nothing is known of what it will choose
  const PoseWeights& weights = options_.weights;
  std::array<double, LC_POSE_CHOICE_NUMBERS> numbers{weights.silhouette, weights.match, weights.shading};
  numbers[LC_POSE_CHOICE_MATCH_AREA] = seen.match_area_px;
  const auto& lights = seen.skin.lights;
  for (size_t k = 0; k < lights.size(); ++k) {
    numbers[LC_POSE_CHOICE_DEVIATIONS + k] = lights[k].deviation;
    float* light = words_.data() + places_.lights + LC_POSE_LIGHT * k;
    *light = std::bit_cast<float>(int32_t(lights[k].is_known));
    std::copy(lights[k].light.begin(), lights[k].light.end(), light + 1);
  }
  std::memcpy(words_.data() + places_.choice, numbers.data(), sizeof(numbers));
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

void PoseRowInputs::set_soles_before(std::span<const float> soles_mm) {
  if (!soles_mm.empty() && soles_mm.size() != size_t(3) * layout_.n_soles)
    throw LogicError(
        format("pose: %zu coordinates of soles before, there are %d points", soles_mm.size(), layout_.n_soles));
  std::ranges::copy(soles_mm, words_.begin() + places_.soles_before);
}

void PoseRowInputs::set_start(std::span<const double> state) {
  std::memcpy(words_.data() + places_.start, state.data(), state.size_bytes());
}

}  // namespace livecap
