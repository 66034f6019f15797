#include "eval/mask_raster.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace livecap {
namespace {

// Twice the signed area of (a, b, p).
double edge(const ProjectedPoint& a, const ProjectedPoint& b, double x, double y) {
  return (b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x);
}

void fill(const ProjectedPoint& a, const ProjectedPoint& b, const ProjectedPoint& c, ImageGray& image) {
  const double area = edge(a, b, c.x, c.y);
  if (area == 0) return;
  const double sign = area > 0 ? 1 : -1;
  const auto first = [](double low) { return static_cast<int>(std::ceil(std::max(low, 0.0))); };
  const auto last = [](double high, int size) { return static_cast<int>(std::floor(std::min(high, size - 1.0))); };
  const int x1 = last(std::max({a.x, b.x, c.x}), image.width);
  const int y1 = last(std::max({a.y, b.y, c.y}), image.height);
  for (int y = first(std::min({a.y, b.y, c.y})); y <= y1; ++y) {
    for (int x = first(std::min({a.x, b.x, c.x})); x <= x1; ++x) {
      if (sign * edge(a, b, x, y) < 0 || sign * edge(b, c, x, y) < 0 || sign * edge(c, a, x, y) < 0) continue;
      image.pixels[static_cast<size_t>(y) * image.width + x] = 255;
    }
  }
}

}  // namespace

ProjectedPoint project_point(const float* point_mm, const Camera& camera) {
  const double z = point_mm[2];
  if (!(z >= 1) || !std::isfinite(point_mm[0]) || !std::isfinite(point_mm[1]) || !std::isfinite(z)) return {};
  const double x = point_mm[0] / z;
  const double y = point_mm[1] / z;
  const auto& [k1, k2, p1, p2, k3] = camera.distortion;
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double xd = x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
  const double yd = y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
  return {camera.fx * xd + camera.cx, camera.fy * yd + camera.cy, true};
}

ImageGray render_silhouette(std::span<const float> positions_mm, std::span<const int32_t> triangles,
                            const Camera& camera) {
  ImageGray image;
  image.width = camera.width;
  image.height = camera.height;
  image.pixels.assign(static_cast<size_t>(camera.width) * camera.height, 0);

  std::vector<ProjectedPoint> pixels(positions_mm.size() / 3);
  for (size_t i = 0; i < pixels.size(); ++i) pixels[i] = project_point(&positions_mm[3 * i], camera);
  for (size_t i = 0; i + 2 < triangles.size(); i += 3) {
    const ProjectedPoint& a = pixels[triangles[i]];
    const ProjectedPoint& b = pixels[triangles[i + 1]];
    const ProjectedPoint& c = pixels[triangles[i + 2]];
    if (a.visible && b.visible && c.visible) fill(a, b, c, image);
  }
  return image;
}

}  // namespace livecap
