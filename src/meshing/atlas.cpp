#include "meshing/atlas.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numeric>

#include "livecap/error.h"

namespace livecap::meshing {

namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr int kPadding = 3;  // texels between charts

struct Chart {
  std::vector<int> triangles;
  Vector2d low, high;  // extent in the projection, scaled by the group's density
  double x = 0, y = 0;
};

Vector3d axis_of(int direction) {
  Vector3d axis = Vector3d::Zero();
  axis[direction / 2] = direction % 2 ? -1 : 1;
  return axis;
}

// Seen from outside along the direction, u to the right, v down.
Vector2d project(const Vector3d& p, int direction) {
  switch (direction) {
    case 0:
      return {-p.z(), -p.y()};
    case 1:
      return {p.z(), -p.y()};
    case 2:
      return {p.x(), p.z()};
    case 3:
      return {p.x(), -p.z()};
    case 4:
      return {p.x(), -p.y()};
    default:
      return {-p.x(), -p.y()};
  }
}

std::vector<std::array<int, 3>> triangle_neighbors(const Surface& surface) {
  std::map<std::pair<int, int>, int> owner;
  for (size_t t = 0; t < surface.triangles.size(); ++t)
    for (int i = 0; i < 3; ++i)
      owner[{surface.triangles[t][i], surface.triangles[t][(i + 1) % 3]}] = static_cast<int>(t);
  std::vector<std::array<int, 3>> neighbors(surface.triangles.size());
  for (size_t t = 0; t < surface.triangles.size(); ++t)
    for (int i = 0; i < 3; ++i)
      neighbors[t][i] = owner.at({surface.triangles[t][(i + 1) % 3], surface.triangles[t][i]});
  return neighbors;
}

// The axis each triangle faces, tidied so that charts have few ragged borders.
std::vector<int> choose_directions(const Surface& surface, const std::vector<int>& group,
                                   const std::vector<std::array<int, 3>>& neighbors) {
  const size_t n = surface.triangles.size();
  std::vector<Vector3d> normals(n);
  std::vector<int> direction(n);
  for (size_t t = 0; t < n; ++t) {
    const auto& tri = surface.triangles[t];
    const Vector3d& a = surface.vertices[tri[0]];
    normals[t] = (surface.vertices[tri[1]] - a).cross(surface.vertices[tri[2]] - a).normalized();
    // Front and back first: people are looked at from there.
    double best = -1;
    for (int d = 0; d < 6; ++d) {
      const double facing = normals[t].dot(axis_of(d)) * (d >= 4 ? 1.15 : 1.0);
      if (facing > best) best = facing, direction[t] = d;
    }
  }
  for (int round = 0; round < 6; ++round) {
    for (size_t t = 0; t < n; ++t) {
      int votes[6] = {};
      for (int other : neighbors[t])
        if (group[other] == group[t]) ++votes[direction[other]];
      for (int d = 0; d < 6; ++d)
        if (votes[d] >= 2 && d != direction[t] && normals[t].dot(axis_of(d)) > 0.35) {
          direction[t] = d;
          break;
        }
    }
  }
  return direction;
}

// Shelf packing, tallest first; the height used, or infinity when a chart is wider than the page.
double pack(std::vector<Chart>& charts, const std::vector<int>& order, double scale, int size) {
  double x = kPadding, y = kPadding, shelf = 0;
  for (int index : order) {
    Chart& chart = charts[index];
    const Vector2d extent = (chart.high - chart.low) * scale;
    if (extent.x() + 2 * kPadding > size) return INFINITY;
    if (x + extent.x() + kPadding > size) {
      x = kPadding;
      y += shelf + kPadding;
      shelf = 0;
    }
    chart.x = x;
    chart.y = y;
    x += extent.x() + kPadding;
    shelf = std::max(shelf, extent.y());
  }
  return y + shelf + kPadding;
}

}  // namespace

Atlas make_atlas(const Surface& surface, const std::vector<int>& group, const std::vector<double>& density, int size) {
  const auto neighbors = triangle_neighbors(surface);
  const auto direction = choose_directions(surface, group, neighbors);
  const int n = static_cast<int>(surface.triangles.size());

  std::vector<Chart> charts;
  std::vector<int> chart_of(n, -1);
  for (int seed = 0; seed < n; ++seed) {
    if (chart_of[seed] >= 0) continue;
    const int id = static_cast<int>(charts.size());
    Chart chart{{seed}, Vector2d::Constant(1e9), Vector2d::Constant(-1e9)};
    chart_of[seed] = id;
    for (size_t next = 0; next < chart.triangles.size(); ++next)
      for (int other : neighbors[chart.triangles[next]])
        if (chart_of[other] < 0 && group[other] == group[seed] && direction[other] == direction[seed]) {
          chart_of[other] = id;
          chart.triangles.push_back(other);
        }
    for (int t : chart.triangles)
      for (int i = 0; i < 3; ++i) {
        const Vector2d uv = density[group[t]] * project(surface.vertices[surface.triangles[t][i]], direction[t]);
        chart.low = chart.low.cwiseMin(uv);
        chart.high = chart.high.cwiseMax(uv);
      }
    charts.push_back(std::move(chart));
  }

  std::vector<int> order(charts.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int a, int b) {
    return charts[a].high.y() - charts[a].low.y() > charts[b].high.y() - charts[b].low.y();
  });
  double low = 0, high = 10;  // texels per mm
  for (int step = 0; step < 40; ++step) {
    const double scale = 0.5 * (low + high);
    (pack(charts, order, scale, size) <= size ? low : high) = scale;
  }
  if (low <= 0) throw LogicError("texture charts do not fit the page");
  pack(charts, order, low, size);

  // One textured vertex per vertex and chart.
  std::map<std::pair<int, int>, int> ids;
  for (int t = 0; t < n; ++t)
    for (int i = 0; i < 3; ++i) ids[{surface.triangles[t][i], chart_of[t]}] = direction[t];
  Atlas atlas;
  for (auto& [key, value] : ids) {
    const auto [vertex, chart_id] = key;
    const Chart& chart = charts[chart_id];
    const double relative = density[group[chart.triangles.front()]];
    const Vector2d texel =
        low * (relative * project(surface.vertices[vertex], value) - chart.low) + Vector2d(chart.x, chart.y);
    atlas.uvs.push_back(texel / size);
    atlas.vertex.push_back(vertex);
    value = static_cast<int>(atlas.uvs.size()) - 1;
  }
  for (int t = 0; t < n; ++t) {
    Vector3i triangle;
    for (int i = 0; i < 3; ++i) triangle[i] = ids.at({surface.triangles[t][i], chart_of[t]});
    atlas.triangles.push_back(triangle);
  }
  return atlas;
}

ImageRgb bake_texture(const Surface& surface, const Atlas& atlas, int size,
                      const std::function<Vector3d(const SurfacePoint&)>& color) {
  ImageRgb image{size, size, std::vector<uint8_t>(static_cast<size_t>(3) * size * size, 128)};
  std::vector<int> ring(static_cast<size_t>(size) * size, -1);  // 0 inside a chart, k after k steps of growing
  for (size_t t = 0; t < atlas.triangles.size(); ++t) {
    Vector2d c[3];
    for (int i = 0; i < 3; ++i) c[i] = atlas.uvs[atlas.triangles[t][i]] * size - Vector2d(0.5, 0.5);
    const Vector2d e1 = c[1] - c[0], e2 = c[2] - c[0];
    const double det = e1.x() * e2.y() - e1.y() * e2.x();
    if (std::abs(det) < 1e-9) continue;
    const int x0 = std::max(0, static_cast<int>(std::ceil(std::min({c[0].x(), c[1].x(), c[2].x()}))));
    const int x1 = std::min(size - 1, static_cast<int>(std::floor(std::max({c[0].x(), c[1].x(), c[2].x()}))));
    const int y0 = std::max(0, static_cast<int>(std::ceil(std::min({c[0].y(), c[1].y(), c[2].y()}))));
    const int y1 = std::min(size - 1, static_cast<int>(std::floor(std::max({c[0].y(), c[1].y(), c[2].y()}))));
    const auto& tri = surface.triangles[t];
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const Vector2d q(x - c[0].x(), y - c[0].y());
        const double b1 = (q.x() * e2.y() - q.y() * e2.x()) / det, b2 = (e1.x() * q.y() - e1.y() * q.x()) / det;
        if (b1 < 0 || b2 < 0 || b1 + b2 > 1) continue;
        SurfacePoint point{static_cast<int>(t), {1 - b1 - b2, b1, b2}};
        point.position =
            (1 - b1 - b2) * surface.vertices[tri[0]] + b1 * surface.vertices[tri[1]] + b2 * surface.vertices[tri[2]];
        const Vector3d rgb = color(point);
        const size_t texel = static_cast<size_t>(y) * size + x;
        for (int k = 0; k < 3; ++k)
          image.pixels[3 * texel + k] = static_cast<uint8_t>(std::lround(255 * std::clamp(rgb[k], 0.0, 1.0)));
        ring[texel] = 0;
      }
  }
  for (int step = 1; step <= kPadding; ++step)
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        const size_t texel = static_cast<size_t>(y) * size + x;
        if (ring[texel] >= 0) continue;
        constexpr int kSteps[8][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, 1}, {-1, 1}, {1, -1}, {-1, -1}};
        for (const auto& [dx, dy] : kSteps) {
          if (x + dx < 0 || x + dx >= size || y + dy < 0 || y + dy >= size) continue;
          const size_t other = texel + dy * size + dx;
          if (ring[other] < 0 || ring[other] >= step) continue;
          std::copy_n(&image.pixels[3 * other], 3, &image.pixels[3 * texel]);
          ring[texel] = step;
          break;
        }
      }
  return image;
}

}  // namespace livecap::meshing
