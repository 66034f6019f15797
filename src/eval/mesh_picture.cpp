#include "eval/mesh_picture.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "geometry/mesh.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr float kAmbient = 0.62f;
constexpr float kMarginShare = 0.03f;  // of the turnaround's height, around each figure
constexpr int kOversampling = 2;       // of the turnaround, per axis

Rgb interpolate(std::span<const Rgb> stops, double value) {
  const double position = std::clamp(value, 0.0, 1.0) * static_cast<double>(stops.size() - 1);
  const size_t below = std::min(static_cast<size_t>(position), stops.size() - 2);
  const float t = static_cast<float>(position - static_cast<double>(below));
  Rgb color;
  for (int k = 0; k < 3; ++k) color[k] = (1 - t) * stops[below][k] + t * stops[below + 1][k];
  return color;
}

// Depth and brightness of every corner; y grows downwards, smaller depths cover larger ones.
struct Scene {
  std::vector<ProjectedPoint> points;  // [n]
  std::vector<float> light;            // [n] 0..1
};

void paint(const Scene& scene, std::span<const int32_t> triangles, std::span<const Rgb> colors, ImageRgb& canvas) {
  std::vector<double> nearest(size_t(canvas.width) * canvas.height, std::numeric_limits<double>::infinity());
  for (size_t i = 0; i + 2 < triangles.size(); i += 3) {
    const ProjectedPoint* c[3];
    for (int k = 0; k < 3; ++k) c[k] = &scene.points[triangles[i + k]];
    if (!c[0]->visible || !c[1]->visible || !c[2]->visible) continue;
    const double area = (c[1]->x - c[0]->x) * (c[2]->y - c[0]->y) - (c[1]->y - c[0]->y) * (c[2]->x - c[0]->x);
    if (area == 0) continue;
    const auto first = [](double low) { return static_cast<int>(std::ceil(std::max(low, 0.0))); };
    const auto last = [](double high, int size) { return static_cast<int>(std::floor(std::min(high, size - 1.0))); };
    const int x1 = last(std::max({c[0]->x, c[1]->x, c[2]->x}), canvas.width);
    const int y1 = last(std::max({c[0]->y, c[1]->y, c[2]->y}), canvas.height);
    for (int y = first(std::min({c[0]->y, c[1]->y, c[2]->y})); y <= y1; ++y) {
      for (int x = first(std::min({c[0]->x, c[1]->x, c[2]->x})); x <= x1; ++x) {
        double w[3];
        for (int k = 0; k < 3; ++k) {
          const ProjectedPoint &a = *c[(k + 1) % 3], &b = *c[(k + 2) % 3];
          w[k] = ((b.x - a.x) * (y - a.y) - (b.y - a.y) * (x - a.x)) / area;
        }
        if (w[0] < 0 || w[1] < 0 || w[2] < 0) continue;
        const double depth = w[0] * c[0]->depth_mm + w[1] * c[1]->depth_mm + w[2] * c[2]->depth_mm;
        double& in_front = nearest[size_t(y) * canvas.width + x];
        if (!(depth < in_front)) continue;
        in_front = depth;
        uint8_t* pixel = &canvas.pixels[3 * (size_t(y) * canvas.width + x)];
        for (int channel = 0; channel < 3; ++channel) {
          double value = 0;
          for (int k = 0; k < 3; ++k) {
            value += w[k] * scene.light[triangles[i + k]] * colors[triangles[i + k]][channel];
          }
          pixel[channel] = static_cast<uint8_t>(std::clamp(value + 0.5, 0.0, 255.0));
        }
      }
    }
  }
}

ImageRgb half_size(const ImageRgb& image) {
  ImageRgb half{image.width / 2, image.height / 2, {}};
  half.pixels.resize(size_t(3) * half.width * half.height);
  for (int y = 0; y < half.height; ++y) {
    for (int x = 0; x < half.width; ++x) {
      for (int k = 0; k < 3; ++k) {
        const auto at = [&](int dx, int dy) {
          return image.pixels[3 * (size_t(2 * y + dy) * image.width + 2 * x + dx) + k];
        };
        half.pixels[3 * (size_t(y) * half.width + x) + k] =
            static_cast<uint8_t>((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1) + 2) / 4);
      }
    }
  }
  return half;
}

void require_colors(std::span<const float> positions, std::span<const Rgb> colors) {
  if (positions.size() == 3 * colors.size()) return;
  throw LogicError(format("%zu colours for %zu coordinates", colors.size(), positions.size()));
}

}  // namespace

Rgb heat_color(double value) {
  static constexpr Rgb kStops[] = {{246, 244, 238}, {253, 220, 160}, {252, 150, 90},
                                   {222, 60, 40},   {140, 10, 40},   {40, 0, 40}};
  return interpolate(kStops, value);
}

Rgb diverging_color(double value) {
  static constexpr Rgb kStops[] = {{165, 15, 21}, {239, 110, 80}, {240, 240, 238}, {90, 150, 220}, {8, 60, 140}};
  return interpolate(kStops, 0.5 + 0.5 * value);
}

void paint_mesh(std::span<const float> positions_mm, std::span<const int32_t> triangles, std::span<const Rgb> colors,
                const Camera& camera, ImageRgb& canvas) {
  require_colors(positions_mm, colors);
  if (canvas.width != camera.width || canvas.height != camera.height) {
    throw LogicError(
        format("a canvas of %dx%d for a camera of %dx%d", canvas.width, canvas.height, camera.width, camera.height));
  }
  const std::vector<float> normals = vertex_normals(positions_mm, triangles);
  Scene scene;
  for (size_t i = 0; i < colors.size(); ++i) {
    scene.points.push_back(project_point(&positions_mm[3 * i], camera));
    const Eigen::Map<const Eigen::Vector3f> position(&positions_mm[3 * i]), normal(&normals[3 * i]);
    scene.light.push_back(kAmbient + (1 - kAmbient) * std::abs(normal.dot(position.normalized())));
  }
  paint(scene, triangles, colors, canvas);
}

ImageRgb paint_turnaround(std::span<const float> rest_mm, std::span<const int32_t> triangles,
                          std::span<const Rgb> colors, int height_px) {
  require_colors(rest_mm, colors);
  const int height = height_px * kOversampling;
  Eigen::Array3f low = Eigen::Array3f::Constant(std::numeric_limits<float>::infinity()), high = -low;
  for (size_t i = 0; i < rest_mm.size(); i += 3) {
    const Eigen::Map<const Eigen::Array3f> p(&rest_mm[i]);
    low = low.min(p);
    high = high.max(p);
  }
  const float margin = kMarginShare * static_cast<float>(height);
  const float px_per_mm = (static_cast<float>(height) - 2 * margin) / std::max(high.y() - low.y(), 1.0f);
  struct Side {
    Eigen::Vector3f right, towards;  // of the picture, and of the viewer, in the rest frame
  };
  const Side sides[] = {
      {{1, 0, 0}, {0, 0, 1}}, {{0, 0, -1}, {1, 0, 0}}, {{-1, 0, 0}, {0, 0, -1}}, {{0, 0, 1}, {-1, 0, 0}}};
  const std::vector<float> normals = vertex_normals(rest_mm, triangles);

  float width = 0;
  for (const Side& side : sides) width += px_per_mm * side.right.cwiseAbs().dot((high - low).matrix()) + 2 * margin;
  ImageRgb canvas{static_cast<int>(width) / 2 * 2, height, {}};
  canvas.pixels.assign(size_t(3) * canvas.width * canvas.height, 255);
  float left = 0;
  for (const Side& side : sides) {
    const float extent = px_per_mm * side.right.cwiseAbs().dot((high - low).matrix());
    const float middle = px_per_mm * side.right.dot((0.5f * (high + low)).matrix());
    Scene scene;
    for (size_t i = 0; i < colors.size(); ++i) {
      const Eigen::Map<const Eigen::Vector3f> p(&rest_mm[3 * i]), normal(&normals[3 * i]);
      scene.points.push_back({left + margin + extent / 2 + px_per_mm * side.right.dot(p) - middle,
                              margin + px_per_mm * (high.y() - p.y()), -side.towards.dot(p), true});
      scene.light.push_back(kAmbient + (1 - kAmbient) * std::abs(normal.dot(side.towards)));
    }
    paint(scene, triangles, colors, canvas);
    left += extent + 2 * margin;
  }
  return half_size(canvas);
}

}  // namespace livecap
