// A textured plane before a camera, and pictures of it: a ray through every pixel.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "actor/actor.h"
#include "base/image_rgb.h"
#include "image/silhouette.h"
#include "livecap/camera.h"

namespace livecap::test {

inline constexpr int kPlaneCells = 20;
inline constexpr int kTextureSide = 256;
inline constexpr double kPlaneHalf = 300, kPlaneDepth = 2000;  // mm

inline Camera plane_camera() {
  return {.width = 320, .height = 280, .fx = 800, .fy = 800, .cx = 159.5, .cy = 139.5};
}

// Luminance of the texture, 0..255: waves with up to `most` periods a side.
inline std::vector<double> noise(int seed, double most = 20) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  struct Wave {
    double kx, ky, phase;
  };
  std::vector<Wave> waves;
  for (int i = 0; i < 24; ++i)
    waves.push_back(
        {std::round(2 * most * (uniform(rng) - 0.5)), std::round(2 * most * (uniform(rng) - 0.5)), 6.3 * uniform(rng)});
  std::vector<double> values;
  for (int y = 0; y < kTextureSide; ++y) {
    for (int x = 0; x < kTextureSide; ++x) {
      double sum = 0;
      for (const Wave& w : waves) sum += std::cos(2 * M_PI * (w.kx * x + w.ky * y) / kTextureSide + w.phase);
      values.push_back(std::clamp(128 + 18 * sum, 0.0, 255.0));
    }
  }
  return values;
}

inline Actor plane_actor(const std::vector<double>& texture) {
  Actor actor;
  for (int j = 0; j <= kPlaneCells; ++j) {
    for (int i = 0; i <= kPlaneCells; ++i) {
      const double u = double(i) / kPlaneCells, v = double(j) / kPlaneCells;
      for (double value : {(2 * u - 1) * kPlaneHalf, (2 * v - 1) * kPlaneHalf, kPlaneDepth})
        actor.mesh.positions.push_back(float(value));
      actor.render.uvs.insert(actor.render.uvs.end(), {float(u), float(v)});
    }
  }
  for (int j = 0; j < kPlaneCells; ++j) {
    for (int i = 0; i < kPlaneCells; ++i) {
      const int a = j * (kPlaneCells + 1) + i, c = a + kPlaneCells + 1;
      actor.mesh.triangles.insert(actor.mesh.triangles.end(), {a, c, a + 1, a + 1, c, c + 1});
    }
  }
  actor.render.triangles = actor.mesh.triangles;
  actor.texture = {kTextureSide, kTextureSide, {}};
  for (double value : texture) actor.texture.pixels.insert(actor.texture.pixels.end(), 3, uint8_t(std::lround(value)));
  return actor;
}

struct Drawing {
  ImageRgb picture;
  Silhouette silhouette;
};

// The plane moved by (dx, dy) px in the picture; light: factor of the luminance from left to right.
inline Drawing draw(const Camera& camera, const std::vector<double>& texture, double dx, double dy, double light_left,
                    double light_right) {
  Drawing d;
  d.picture = {camera.width, camera.height, {}};
  ImageGray mask{camera.width, camera.height, {}};
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double u = ((x - dx - camera.cx) / camera.fx * kPlaneDepth / kPlaneHalf + 1) / 2;
      const double v = ((y - dy - camera.cy) / camera.fy * kPlaneDepth / kPlaneHalf + 1) / 2;
      const bool inside = u > 0 && u < 1 && v > 0 && v < 1;
      const int tx = std::clamp(int(u * kTextureSide), 0, kTextureSide - 1),
                ty = std::clamp(int(v * kTextureSide), 0, kTextureSide - 1);
      const double light = light_left + (light_right - light_left) * x / camera.width;
      const double value = inside ? std::clamp(light * texture[size_t(ty) * kTextureSide + tx], 0.0, 255.0) : 40;
      d.picture.pixels.insert(d.picture.pixels.end(), 3, uint8_t(std::lround(value)));
      mask.pixels.push_back(inside ? 255 : 0);
    }
  }
  d.silhouette = make_silhouette(mask);
  return d;
}

}  // namespace livecap::test
