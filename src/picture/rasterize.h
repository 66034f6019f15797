// The pixels of a triangle, and which of several triangles is in front: the one loop behind every picture of this room.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

namespace livecap {

// Where a corner is in the picture.
struct ScreenPoint {
  float x = 0, y = 0;  // px
  // What is nearer has more of it, and it is linear in the picture: 1/depth, or -depth in parallel projection.
  float nearness = 0;
};

// How near the nearest triangle so far is, per pixel.
struct NearnessImage {
  NearnessImage(int w, int h)
      : width(w), height(h), values(static_cast<size_t>(w) * h, -std::numeric_limits<float>::infinity()) {}
  int width, height;          // px
  std::vector<float> values;  // [width*height]
};

// Calls paint(x, y, w, nearness) for every pixel whose centre the triangle covers in front of what is there already.
// None of a triangle whose area a float does not hold.
// w[3]: the corners' shares, linear in the picture.
template <typename Paint>
void rasterize(const ScreenPoint (&c)[3], NearnessImage& image, Paint&& paint) {
  const float area = (c[1].x - c[0].x) * (c[2].y - c[0].y) - (c[1].y - c[0].y) * (c[2].x - c[0].x);
  if (area == 0 || !std::isfinite(area)) return;
  const auto first = [](float a, float b, float d, int size) {
    return static_cast<int>(std::ceil(std::clamp(std::min({a, b, d}), 0.f, static_cast<float>(size))));
  };
  const auto last = [](float a, float b, float d, int size) {
    return static_cast<int>(std::floor(std::clamp(std::max({a, b, d}), -1.f, static_cast<float>(size - 1))));
  };
  const int x0 = first(c[0].x, c[1].x, c[2].x, image.width), x1 = last(c[0].x, c[1].x, c[2].x, image.width);
  const int y0 = first(c[0].y, c[1].y, c[2].y, image.height), y1 = last(c[0].y, c[1].y, c[2].y, image.height);
  for (int y = y0; y <= y1; ++y) {
    for (int x = x0; x <= x1; ++x) {
      float w[3];
      bool inside = true;
      for (int k = 0; k < 3; ++k) {
        const ScreenPoint& a = c[(k + 1) % 3];
        const ScreenPoint& b = c[(k + 2) % 3];
        w[k] = ((b.x - a.x) * (static_cast<float>(y) - a.y) - (b.y - a.y) * (static_cast<float>(x) - a.x)) / area;
        inside &= w[k] >= 0;
      }
      if (!inside) continue;
      const float nearness = w[0] * c[0].nearness + w[1] * c[1].nearness + w[2] * c[2].nearness;
      float& nearest = image.values[static_cast<size_t>(y) * image.width + x];
      if (!(nearness > nearest)) continue;
      nearest = nearness;
      paint(x, y, w, nearness);
    }
  }
}

}  // namespace livecap
