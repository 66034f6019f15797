#include "acquire/refine.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <array>
#include <cmath>

#include "livecap/error.h"
#include "meshing/surface_parts.h"

namespace livecap::acquire {

namespace {

using Eigen::Vector3d;

constexpr double kDeepestMm = 45;    // how far a vertex may sink
constexpr double kStepMm = 3;        // of the search
constexpr double kSpacingMm = 3.5;   // between the samples of a patch of 7 x 7
constexpr double kLeastScore = 0.8;  // correlation that counts as agreement
constexpr double kStiffness = 4;     // of neighbours against one vertex with full agreement
constexpr int kSide = 7, kPatch = kSide * kSide;
using Patch = std::array<float, kPatch>;

struct GrayView {
  int width, height;
  std::vector<float> pixels;
};

// Not base/luminance.h's weights, of which these are rounded: no patch would match better by them, but every built
// actor would change a little.
GrayView gray_of(const ImageRgb& image) {
  GrayView gray{image.width, image.height, std::vector<float>(size_t(image.width) * image.height)};
  for (size_t i = 0; i < gray.pixels.size(); ++i)
    gray.pixels[i] = 0.3f * image.pixels[3 * i] + 0.59f * image.pixels[3 * i + 1] + 0.11f * image.pixels[3 * i + 2];
  return gray;
}

// The patch around `center` as a view sees it, mean 0 and norm 1; false outside of the picture or without texture.
bool sample_patch(const View& view, const GrayView& gray, const Vector3d& center, const Vector3d& u, const Vector3d& v,
                  Patch& patch) {
  float sum = 0;
  for (int j = 0; j < kSide; ++j)
    for (int i = 0; i < kSide; ++i) {
      Eigen::Vector2d q;
      if (!view.project(center + (i - kSide / 2) * u + (j - kSide / 2) * v, q)) return false;
      if (!(q.x() >= 0 && q.y() >= 0 && q.x() < gray.width - 1 && q.y() < gray.height - 1)) return false;
      const int x = static_cast<int>(q.x()), y = static_cast<int>(q.y());
      const float fx = static_cast<float>(q.x() - x), fy = static_cast<float>(q.y() - y);
      const float* row = &gray.pixels[static_cast<size_t>(y) * gray.width + x];
      const float value =
          (1 - fy) * ((1 - fx) * row[0] + fx * row[1]) + fy * ((1 - fx) * row[gray.width] + fx * row[gray.width + 1]);
      patch[j * kSide + i] = value;
      sum += value;
    }
  float norm = 0;
  for (float& value : patch) {
    value -= sum / kPatch;
    norm += value * value;
  }
  norm = std::sqrt(norm);
  if (norm < 5 * kSide) return false;  // 5 levels on average
  for (float& value : patch) value /= norm;
  return true;
}

// One view that looks at the vertex best, and up to six that look from 8 to 50 degrees beside it.
std::vector<int> choose_views(size_t vertex, const Vector3d& p, const std::vector<View>& views,
                              const std::vector<Vector3d>& centers, const std::vector<ViewCoverage>& coverage) {
  int reference = -1;
  for (size_t v = 0; v < views.size(); ++v)
    if (coverage[v].facing[vertex] > 0.5f &&
        (reference < 0 || coverage[v].facing[vertex] > coverage[reference].facing[vertex]))
      reference = static_cast<int>(v);
  if (reference < 0) return {};
  const Vector3d to = (centers[reference] - p).normalized();
  std::vector<std::pair<float, int>> others;
  for (size_t v = 0; v < views.size(); ++v) {
    if (coverage[v].facing[vertex] < 0.45f) continue;
    const double cosine = to.dot((centers[v] - p).normalized());
    if (cosine < 0.990 && cosine > 0.64) others.emplace_back(-coverage[v].facing[vertex], static_cast<int>(v));
  }
  std::sort(others.begin(), others.end());
  std::vector<int> chosen{reference};
  for (size_t i = 0; i < std::min<size_t>(6, others.size()); ++i) chosen.push_back(others[i].second);
  return chosen.size() >= 4 ? chosen : std::vector<int>{};
}

// Mean correlation of the reference with the better half of the others.
double agreement(const std::vector<int>& chosen, const std::vector<View>& views, const std::vector<GrayView>& grays,
                 const Vector3d& center, const Vector3d& u, const Vector3d& v) {
  Patch reference;
  if (!sample_patch(views[chosen[0]], grays[chosen[0]], center, u, v, reference)) return -1;
  std::vector<double> scores;
  for (size_t k = 1; k < chosen.size(); ++k) {
    Patch patch;
    double score = -1;
    if (sample_patch(views[chosen[k]], grays[chosen[k]], center, u, v, patch)) {
      score = 0;
      for (int i = 0; i < kPatch; ++i) score += reference[i] * patch[i];
    }
    scores.push_back(score);
  }
  std::sort(scores.rbegin(), scores.rend());
  const size_t half = (scores.size() + 1) / 2;
  double sum = 0;
  for (size_t k = 0; k < half; ++k) sum += scores[k];
  return sum / half;
}

}  // namespace

RefineResult refine_by_color(const std::vector<View>& views, const std::vector<ViewCoverage>& coverage,
                             meshing::Surface& surface) {
  const size_t n = surface.vertices.size();
  const std::vector<std::vector<int>> neighbors = meshing::neighbors_of(surface);
  const auto normals = meshing::smooth_normals(surface, neighbors, 2);
  std::vector<GrayView> grays;
  std::vector<Vector3d> centers;
  for (const View& view : views) {
    grays.push_back(gray_of(view.image));
    centers.push_back(view.center());
  }

  std::vector<double> depth(n, 0), trust(n, 0);
  const int steps = static_cast<int>(kDeepestMm / kStepMm);
  for (size_t i = 0; i < n; ++i) {
    const auto chosen = choose_views(i, surface.vertices[i], views, centers, coverage);
    if (chosen.empty()) continue;
    const Vector3d u = kSpacingMm * normals[i].unitOrthogonal(), v = normals[i].cross(u);
    std::vector<double> score(steps + 1);
    for (int s = 0; s <= steps; ++s)
      score[s] = agreement(chosen, views, grays, surface.vertices[i] - s * kStepMm * normals[i], u, v);
    const int best = static_cast<int>(std::max_element(score.begin(), score.end()) - score.begin());
    if (score[best] < kLeastScore || best == steps) continue;
    // A second peak as good somewhere else: a pattern that repeats.
    double second = -1;
    for (int s = 0; s <= steps; ++s)
      if (std::abs(s - best) > 2) second = std::max(second, score[s]);
    double at = best;
    if (best > 0) {
      const double a = score[best - 1], b = score[best], c = score[best + 1];
      if (const double curve = a - 2 * b + c; curve < -1e-9) at += std::clamp(0.5 * (a - c) / curve, -0.5, 0.5);
    }
    depth[i] = at * kStepMm;
    trust[i] = std::clamp((score[best] - second) / 0.15, 0.0, 1.0);
  }

  // A membrane over the surface that the trusted vertices pull on; who disagrees with it counts little next time.
  RefineResult result;
  Eigen::VectorXd sunk = Eigen::VectorXd::Zero(static_cast<int>(n));
  for (int round = 0; round < 4; ++round) {
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd right = Eigen::VectorXd::Zero(static_cast<int>(n));
    for (size_t i = 0; i < n; ++i) {
      const int row = static_cast<int>(i);
      const double off = round == 0 ? 0 : (sunk[row] - depth[i]) / 6;
      const double weight = trust[i] / (1 + off * off);
      entries.emplace_back(row, row, weight + 0.02);
      right[row] = weight * depth[i];
      for (int other : neighbors[i]) {
        const double spring = kStiffness / static_cast<double>(neighbors[i].size() + neighbors[other].size());
        entries.emplace_back(row, row, spring);
        entries.emplace_back(row, other, -spring);
      }
    }
    Eigen::SparseMatrix<double> system(static_cast<int>(n), static_cast<int>(n));
    system.setFromTriplets(entries.begin(), entries.end());
    const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> factor(system);
    if (factor.info() != Eigen::Success) throw LogicError("refinement: the membrane cannot be factored");
    sunk = factor.solve(right);
  }
  for (size_t i = 0; i < n; ++i) {
    const double by = std::clamp(sunk[static_cast<int>(i)], 0.0, kDeepestMm);
    surface.vertices[i] -= by * normals[i];
    if (trust[i] > 0) ++result.n_evidence;
  }
  return result;
}

}  // namespace livecap::acquire
