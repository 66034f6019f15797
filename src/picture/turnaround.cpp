#include "picture/turnaround.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "base/text.h"
#include "geometry/mesh.h"
#include "livecap/error.h"
#include "picture/rasterize.h"
#include "picture/resample.h"

namespace livecap {
namespace {

constexpr float kTurnaroundAmbient = 0.62f;
constexpr float kMarginShare = 0.03f;  // of the turnaround's height, around each figure
constexpr int kOversampling = 2;       // of the turnaround, per axis

// Every corner; y grows downwards.
struct Scene {
  std::vector<ScreenPoint> points;  // [n]
  std::vector<float> light;         // [n] 0..1
};

void paint(const Scene& scene, std::span<const int32_t> triangles, std::span<const Rgb> colors, ImageRgb& canvas) {
  NearnessImage nearest(canvas.width, canvas.height);
  for (size_t i = 0; i + 2 < triangles.size(); i += 3) {
    const int32_t* corner = &triangles[i];
    rasterize({scene.points[corner[0]], scene.points[corner[1]], scene.points[corner[2]]}, nearest,
              [&](int x, int y, const float(&w)[3], float) {
                uint8_t* pixel = &canvas.pixels[3 * (size_t(y) * canvas.width + x)];
                for (int channel = 0; channel < 3; ++channel) {
                  float value = 0;
                  for (int k = 0; k < 3; ++k) value += w[k] * scene.light[corner[k]] * colors[corner[k]][channel];
                  pixel[channel] = static_cast<uint8_t>(std::clamp(value + 0.5f, 0.f, 255.f));
                }
              });
  }
}

}  // namespace

ImageRgb paint_turnaround(std::span<const float> rest_mm, std::span<const int32_t> triangles,
                          std::span<const Rgb> colors, int height_px) {
  if (rest_mm.size() != 3 * colors.size())
    throw LogicError(format("%zu colours for %zu coordinates", colors.size(), rest_mm.size()));
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
  ImageRgb canvas{static_cast<int>(width) / kOversampling * kOversampling, height, {}};
  canvas.pixels.assign(size_t(3) * canvas.width * canvas.height, 255);
  float left = 0;
  for (const Side& side : sides) {
    const float extent = px_per_mm * side.right.cwiseAbs().dot((high - low).matrix());
    const float middle = px_per_mm * side.right.dot((0.5f * (high + low)).matrix());
    Scene scene;
    for (size_t i = 0; i < colors.size(); ++i) {
      const Eigen::Map<const Eigen::Vector3f> p(&rest_mm[3 * i]), normal(&normals[3 * i]);
      scene.points.push_back({left + margin + extent / 2 + px_per_mm * side.right.dot(p) - middle,
                              margin + px_per_mm * (high.y() - p.y()), side.towards.dot(p)});
      scene.light.push_back(kTurnaroundAmbient + (1 - kTurnaroundAmbient) * std::abs(normal.dot(side.towards)));
    }
    paint(scene, triangles, colors, canvas);
    left += extent + 2 * margin;
  }
  return averaged(canvas, kOversampling);
}

}  // namespace livecap
