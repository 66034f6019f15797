#include "texture/texture.h"

#include <algorithm>
#include <cmath>

#include "actor/labels.h"
#include "image/silhouette.h"
#include "meshing/surface_parts.h"
#include "texture/shading.h"

namespace livecap {

namespace {

using Eigen::Vector3d;

constexpr int kViewsPerVertex = 5;
constexpr double kSharpness = 5;  // power of the weights: how much the best view outweighs the others
constexpr double kBorderPx = 3;   // from the silhouette: background bleeds in there
constexpr double kFewestViews = 3, kManyViews = 0.1;  // of all: more than an edge a mm beside the true one has
constexpr double kMinFacing = 0.25;                   // cosine; flatter views are stretched

struct Share {
  int view;
  double weight;
};

Vector3d sample(const ImageRgb& image, double u, double v) {
  const double x = std::clamp(u, 0.0, image.width - 1.001), y = std::clamp(v, 0.0, image.height - 1.001);
  const int ix = static_cast<int>(x), iy = static_cast<int>(y);
  const double fx = x - ix, fy = y - iy;
  const uint8_t* a = &image.pixels[3 * (static_cast<size_t>(iy) * image.width + ix)];
  const uint8_t* b = a + 3 * static_cast<size_t>(image.width);
  Vector3d c;
  for (int k = 0; k < 3; ++k)
    c[k] = ((1 - fy) * ((1 - fx) * a[k] + fx * a[k + 3]) + fy * ((1 - fx) * b[k] + fx * b[k + 3])) / 255;
  return c;
}

// Whether what the view shows at the pixel is labelled so, left or right, which parsers exchange in views from behind;
// true when its label is not known.
bool shows_label(const View& view, int x, int y, int label) {
  const ImageGray& image = view.labels;
  if (x < 0 || y < 0 || x >= image.width || y >= image.height) return true;
  const int shown = image.pixels[static_cast<size_t>(y) * image.width + x];
  const auto either_side = [](int id) { return id >= lip::kLeftArm ? id & ~1 : id; };
  return shown == 0 || shown >= kLabelCount || either_side(shown) == either_side(label);
}

// The best views of each vertex. A vertex counts as seen when its neighbours are: near an occluder's edge a pixel shows
// the occluder.
std::vector<std::vector<Share>> choose_views(const meshing::Surface& surface, const std::vector<View>& views,
                                             const std::vector<ViewCoverage>& coverage,
                                             const std::vector<uint8_t>& labels,
                                             const std::vector<std::vector<int>>& neighbors) {
  const size_t n = surface.vertices.size();
  std::vector<std::vector<Share>> shares(n), of_other_label(n);
  for (size_t v = 0; v < views.size(); ++v) {
    const Silhouette silhouette = views[v].mask.empty() ? Silhouette{} : make_silhouette(views[v].mask);
    const Vector3d center = views[v].center();
    for (size_t i = 0; i < n; ++i) {
      double facing = coverage[v].facing[i];
      if (facing <= kMinFacing) continue;  // would weigh nothing
      for (int other : neighbors[i]) facing = coverage[v].facing[other] > 0 ? facing : 0;
      if (facing <= 0) continue;
      const int x = static_cast<int>(std::lround(coverage[v].pixels[i].x())),
                y = static_cast<int>(std::lround(coverage[v].pixels[i].y()));
      double inside = 1;
      if (!silhouette.empty()) {
        if (x < 0 || y < 0 || x >= silhouette.width || y >= silhouette.height) continue;
        const double depth = -silhouette.signed_distance[static_cast<size_t>(y) * silhouette.width + x];
        inside = std::clamp(depth / kBorderPx - 0.3, 0.0, 1.0);
      }
      // Pixels per mm of the surface.
      const double resolution = views[v].camera.fx / (surface.vertices[i] - center).norm() * facing;
      if (inside <= 0) continue;
      const bool agrees = labels.empty() || shows_label(views[v], x, y, labels[i]);
      (agrees ? shares : of_other_label)[i].push_back(
          {static_cast<int>(v), inside * (facing - kMinFacing) * resolution});
    }
  }
  // At a border of materials most views may disagree with the vote: then they are right.
  for (size_t i = 0; i < n; ++i)
    if (of_other_label[i].size() > shares[i].size() &&
        static_cast<double>(of_other_label[i].size()) >=
            std::max(kFewestViews, kManyViews * static_cast<double>(views.size())))
      shares[i] = std::move(of_other_label[i]);
  for (auto& list : shares) {
    std::sort(list.begin(), list.end(), [](const Share& a, const Share& b) {
      return a.weight != b.weight ? a.weight > b.weight : a.view < b.view;
    });
    if (list.size() > kViewsPerVertex) list.resize(kViewsPerVertex);
    double best = list.empty() ? 1 : list.front().weight, sum = 0;
    // Minus the weight of the first that is left out would be 0 at the change; the power makes it small enough.
    for (Share& share : list) sum += share.weight = std::pow(share.weight / best, kSharpness);
    for (Share& share : list) share.weight /= sum;
  }
  return shares;
}

std::vector<std::vector<int>> of_one_label(std::vector<std::vector<int>> neighbors,
                                           const std::vector<uint8_t>& labels) {
  if (!labels.empty())
    for (size_t i = 0; i < neighbors.size(); ++i)
      std::erase_if(neighbors[i], [&](int other) { return labels[other] != labels[i]; });
  return neighbors;
}

// From the person's frame into the camera's, of the views that a vertex has its colour from.
void turn_with_views(const std::vector<View>& views, const std::vector<std::vector<Share>>& shares,
                     std::vector<Vector3d>& normals) {
  for (size_t i = 0; i < shares.size(); ++i) {
    if (shares[i].empty()) continue;
    Vector3d turned = Vector3d::Zero();
    for (const auto& [view, weight] : shares[i])
      turned += weight * (views[view].camera_from_world.linear() * normals[i]);
    normals[i] = turned.normalized();
  }
}

}  // namespace

void spread_colors(const std::vector<std::vector<int>>& neighbors, std::vector<char>& known,
                   std::vector<Vector3d>& colors) {
  for (bool changed = true; changed;) {
    changed = false;
    std::vector<char> next = known;
    for (size_t i = 0; i < known.size(); ++i) {
      if (known[i]) continue;
      Vector3d sum = Vector3d::Zero();
      int count = 0;
      for (int other : neighbors[i])
        if (known[other]) sum += colors[other], ++count;
      if (count == 0) continue;
      colors[i] = sum / count;
      next[i] = 1;
      changed = true;
    }
    known.swap(next);
  }
}

BlendedTexture blend_texture(const meshing::Surface& surface, const meshing::Atlas& atlas, int size,
                             const std::vector<View>& views, const std::vector<ViewCoverage>& coverage,
                             const std::vector<uint8_t>& labels, LightFrame light_frame) {
  const auto neighbors = meshing::neighbors_of(surface);
  const auto shares = choose_views(surface, views, coverage, labels, neighbors);
  std::vector<Vector3d> colors(surface.vertices.size(),
                               Vector3d::Constant(0.5));  // as pictured; below, without the light
  std::vector<char> known(surface.vertices.size(), 0);
  for (size_t i = 0; i < shares.size(); ++i) {
    if (shares[i].empty()) continue;
    known[i] = 1;
    colors[i].setZero();
    for (const auto& [view, weight] : shares[i])
      colors[i] += weight * sample(views[view].image, coverage[view].pixels[i].x(), coverage[view].pixels[i].y());
  }
  BlendedTexture result;
  result.seen = known;
  std::vector<Vector3d> normals = shading_normals(surface);
  if (light_frame == LightFrame::kCamera) turn_with_views(views, shares, normals);
  const Shading shading = find_shading(surface, normals, colors, known);
  std::vector<Eigen::Array3d> light;
  for (const Vector3d& normal : normals) light.push_back(shading.at(normal));
  for (size_t i = 0; i < colors.size(); ++i)
    if (known[i]) colors[i] = without_light(colors[i], light[i]);
  spread_colors(of_one_label(neighbors, labels), known, colors);
  spread_colors(neighbors, known, colors);
  const auto color = [&](const meshing::SurfacePoint& point) {
    const auto& t = surface.triangles[point.triangle];
    Vector3d lit = Vector3d::Zero(), unlit = Vector3d::Zero();
    Eigen::Array3d its_light = Eigen::Array3d::Zero();
    double lit_share = 0;
    for (int k = 0; k < 3; ++k) {
      if (shares[t[k]].empty()) unlit += point.weights[k] * colors[t[k]];
      for (const auto& [view, weight] : shares[t[k]]) {
        // A view that does not show the whole triangle stands back for the corner's own colour.
        const bool whole = coverage[view].facing[t[(k + 1) % 3]] > 0 && coverage[view].facing[t[(k + 2) % 3]] > 0;
        const double share = point.weights[k] * weight;
        Eigen::Vector2d pixel;
        if (whole && views[view].project(point.position, pixel)) {
          lit += share * sample(views[view].image, pixel.x(), pixel.y());
          its_light += share * light[t[k]];  // a corner that no view sees has none
          lit_share += share;
        } else {
          unlit += share * colors[t[k]];
        }
      }
    }
    if (lit_share > 0) unlit += lit_share * without_light(lit / lit_share, its_light / lit_share);
    return unlit;
  };
  result.image = meshing::bake_texture(surface, atlas, size, color);
  return result;
}

}  // namespace livecap
