// Procedural meshes and frames for the tests of stage II, on the host and on a device.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <numbers>
#include <random>
#include <vector>

#include "actor/actor.h"
#include "livecap/camera.h"
#include "surface/surface_input.h"

namespace livecap::test {

// Icosphere: 12, 42, 162, 642, 2562 vertices for 0..4 subdivisions.
inline Mesh icosphere(int subdivisions, double radius, std::array<double, 3> center) {
  const double t = (1 + std::sqrt(5.0)) / 2;
  std::vector<std::array<double, 3>> points = {{-1, t, 0}, {1, t, 0}, {-1, -t, 0}, {1, -t, 0},
                                               {0, -1, t}, {0, 1, t}, {0, -1, -t}, {0, 1, -t},
                                               {t, 0, -1}, {t, 0, 1}, {-t, 0, -1}, {-t, 0, 1}};
  std::vector<std::array<int, 3>> faces = {{0, 11, 5}, {0, 5, 1},  {0, 1, 7},   {0, 7, 10}, {0, 10, 11},
                                           {1, 5, 9},  {5, 11, 4}, {11, 10, 2}, {10, 7, 6}, {7, 1, 8},
                                           {3, 9, 4},  {3, 4, 2},  {3, 2, 6},   {3, 6, 8},  {3, 8, 9},
                                           {4, 9, 5},  {2, 4, 11}, {6, 2, 10},  {8, 6, 7},  {9, 8, 1}};
  for (int level = 0; level < subdivisions; ++level) {
    std::map<std::pair<int, int>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto key = std::minmax(a, b);
      const auto [it, added] = middles.try_emplace(key, int(points.size()));
      if (added) {
        const auto p = points[a], q = points[b];
        points.push_back({(p[0] + q[0]) / 2, (p[1] + q[1]) / 2, (p[2] + q[2]) / 2});
      }
      return it->second;
    };
    std::vector<std::array<int, 3>> finer;
    for (const auto& f : faces) {
      const int a = middle(f[0], f[1]), b = middle(f[1], f[2]), c = middle(f[2], f[0]);
      finer.insert(finer.end(), {{f[0], a, c}, {f[1], b, a}, {f[2], c, b}, {a, b, c}});
    }
    faces = finer;
  }
  Mesh mesh;
  for (const auto& p : points) {
    const double length = std::sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    for (int a = 0; a < 3; ++a) mesh.positions.push_back(float(center[a] + radius * p[a] / length));
  }
  for (const auto& f : faces)
    for (int a = 0; a < 3; ++a) mesh.triangles.push_back(f[a]);
  return mesh;
}

// Two cones around the y axis, base to base: two vertices with `around` neighbours, as many with four.
inline Mesh double_cone(int around, double radius, std::array<double, 3> center) {
  Mesh mesh;
  const auto add = [&](double x, double y, double z) {
    for (const double value : {center[0] + x, center[1] + y, center[2] + z}) mesh.positions.push_back(float(value));
  };
  for (int i = 0; i < around; ++i) {
    const double angle = 2 * std::numbers::pi * i / around;
    add(radius * std::cos(angle), 0, radius * std::sin(angle));
    const int next = (i + 1) % around;
    mesh.triangles.insert(mesh.triangles.end(), {around, next, i, around + 1, i, next});
  }
  add(0, radius, 0);
  add(0, -radius, 0);
  return mesh;
}

// A closed-in-angle tube around the y axis, `around` x `along` vertices.
inline Mesh tube(int around, int along, double radius, double height, std::array<double, 3> center) {
  Mesh mesh;
  for (int j = 0; j < along; ++j)
    for (int i = 0; i < around; ++i) {
      const double angle = 2 * M_PI * (i + 0.5 * (j % 2)) / around;
      mesh.positions.push_back(float(center[0] + radius * std::cos(angle)));
      mesh.positions.push_back(float(center[1] + height * (double(j) / (along - 1) - 0.5)));
      mesh.positions.push_back(float(center[2] + radius * std::sin(angle)));
    }
  for (int j = 0; j + 1 < along; ++j)
    for (int i = 0; i < around; ++i) {
      const int a = j * around + i, b = j * around + (i + 1) % around;
      const int c = a + around, d = b + around;
      if (j % 2 == 0) {
        for (const int v : {a, c, b, b, c, d}) mesh.triangles.push_back(v);
      } else {
        for (const int v : {a, c, d, a, d, b}) mesh.triangles.push_back(v);
      }
    }
  return mesh;
}

// A grid of columns x rows vertices in the plane z = depth.
inline Mesh grid(int columns, int rows, double spacing, double depth) {
  Mesh mesh;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      mesh.positions.push_back(float((i - 0.5 * (columns - 1)) * spacing));
      mesh.positions.push_back(float((j - 0.5 * (rows - 1)) * spacing));
      mesh.positions.push_back(float(depth));
    }
  for (int j = 0; j + 1 < rows; ++j)
    for (int i = 0; i + 1 < columns; ++i) {
      const int a = j * columns + i;
      for (const int v : {a, a + columns, a + 1, a + 1, a + columns, a + columns + 1}) mesh.triangles.push_back(v);
    }
  return mesh;
}

// One frame of one actor on the host. The actor's mesh is given in camera coordinates, so it is its own skinned mesh.
struct Scene {
  Actor actor;
  Camera camera;
  ImageRgb image;
  Silhouette silhouette;
  std::vector<float> skinned, start, previous, before, normals;
  std::vector<int> visible, contour, vertex_part;
  std::vector<uint8_t> part_image;
  std::vector<float> matches;  // [LC_MATCH*n] or empty

  int n() const { return actor.n_vertices(); }
  std::array<double, 2> project(const std::vector<float>& v, int i) const {
    return {camera.fx * v[3 * i] / v[3 * i + 2] + camera.cx, camera.fy * v[3 * i + 1] / v[3 * i + 2] + camera.cy};
  }
};

inline Scene make_scene(Mesh mesh, int width, int height, double focal, float rigidity = 2.0f) {
  Scene s;
  s.actor.mesh = std::move(mesh);
  const int n = s.actor.n_vertices();
  s.actor.rigidity.assign(n, rigidity);
  s.actor.colors.assign(3 * n, 0.5f);
  s.actor.labels.assign(n, 5);
  s.camera.width = width;
  s.camera.height = height;
  s.camera.fx = s.camera.fy = focal;
  s.camera.cx = 0.5 * (width - 1);
  s.camera.cy = 0.5 * (height - 1);
  s.image = {width, height, std::vector<uint8_t>(size_t(3) * width * height, 128)};
  s.silhouette.width = width;
  s.silhouette.height = height;
  s.silhouette.signed_distance.assign(size_t(width) * height, 100.0f);
  s.skinned = s.start = s.previous = s.before = s.actor.mesh.positions;
  s.normals = vertex_normals(s.actor.mesh.positions, s.actor.mesh.triangles);
  s.visible.assign(n, 0);
  s.contour.assign(n, 0);
  s.vertex_part.assign(n, 1);
  s.part_image.assign(size_t(width) * height, 0);
  return s;
}

// distance(x, y): signed, px.
inline void set_distance(Scene& s, const std::function<double(double, double)>& distance) {
  for (int y = 0; y < s.camera.height; ++y)
    for (int x = 0; x < s.camera.width; ++x)
      s.silhouette.signed_distance[size_t(y) * s.camera.width + x] = float(distance(x, y));
}

// color(x, y, channel) in [0,1].
inline void set_image(Scene& s, const std::function<double(double, double, int)>& color) {
  for (int y = 0; y < s.camera.height; ++y)
    for (int x = 0; x < s.camera.width; ++x)
      for (int c = 0; c < 3; ++c)
        s.image.pixels[3 * (size_t(y) * s.camera.width + x) + c] =
            uint8_t(std::lround(255 * std::min(1.0, std::max(0.0, color(x, y, c)))));
}

// Marks the vertices of a sphere or tube whose normal is nearly perpendicular to the view ray.
inline void mark_rim(Scene& s, double max_cosine) {
  for (int i = 0; i < s.n(); ++i) {
    double dot = 0, length = 0;
    for (int a = 0; a < 3; ++a) {
      dot += double(s.normals[3 * i + a]) * s.start[3 * i + a];
      length += double(s.start[3 * i + a]) * s.start[3 * i + a];
    }
    s.contour[i] = std::abs(dot) / std::sqrt(length) < max_cosine ? 1 : 0;
    s.visible[i] = dot < 0 ? 1 : 0;
  }
}

inline void add_noise(std::vector<float>& values, double sigma, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, sigma);
  for (float& v : values) v += float(normal(random));
}

// The scene's buffers on one device.
class DeviceScene {
 public:
  DeviceScene(ocl::DeviceContext& device, const Scene& s)
      : frame(device, s.camera.width, s.camera.height),
        skinned(device, s.skinned),
        start(device, s.start),
        previous(device, s.previous),
        before(device, s.before),
        normals(device, s.normals),
        visible(device, s.visible),
        contour(device, s.contour),
        vertex_part(device, s.vertex_part),
        part_image(device, s.part_image),
        matches(device, s.matches) {
    frame.upload(s.silhouette, s.image);
  }
  SurfaceInput input(bool temporal = true, bool parts = true) const {
    return {.frame = frame,
            .skinned = skinned,
            .start = start,
            .previous = temporal ? &previous : nullptr,
            .before_previous = temporal ? &before : nullptr,
            .matches = matches.size() > 0 ? &matches : nullptr,
            .visible = visible,
            .contour_flag = contour,
            .normals = normals,
            .part_image = parts ? &part_image : nullptr,
            .vertex_part = parts ? &vertex_part : nullptr};
  }

  DeviceFrame frame;
  ocl::Buffer<float> skinned, start, previous, before, normals;
  ocl::Buffer<int> visible, contour, vertex_part;
  ocl::Buffer<uint8_t> part_image;
  ocl::Buffer<float> matches;
};

}  // namespace livecap::test
