// Small meshes and cameras for the tests of this room.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "geometry/mesh.h"
#include "livecap/camera.h"

namespace livecap::test {

inline Camera small_camera(int width, int height) {
  Camera camera;
  camera.width = width;
  camera.height = height;
  camera.fx = 1.1 * width;
  camera.fy = 1.05 * width;
  camera.cx = 0.5 * (width - 1) + 0.3;
  camera.cy = 0.5 * (height - 1) - 0.2;
  return camera;
}

// Triangles that share nothing, at random in front of the camera.
inline Mesh random_triangles(int n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> side(-700, 700), depth(400, 2500), size(-250, 250);
  Mesh mesh;
  for (int t = 0; t < n; ++t) {
    const float center[3] = {side(random), side(random), depth(random)};
    for (int k = 0; k < 3; ++k) {
      for (float c : center) mesh.positions.push_back(c + size(random));
      mesh.triangles.push_back(3 * t + k);
    }
  }
  return mesh;
}

// Latitude-longitude sphere, triangles counter-clockwise from outside (camera axes: y down, z forward).
inline Mesh sphere(const Eigen::Vector3f& center, float radius, int rings, int sectors) {
  Mesh mesh;
  auto add = [&](const Eigen::Vector3f& direction) {
    const Eigen::Vector3f p = center + radius * direction;
    mesh.positions.insert(mesh.positions.end(), {p.x(), p.y(), p.z()});
  };
  add({0, -1, 0});
  for (int r = 1; r < rings; ++r) {
    const double polar = M_PI * r / rings;
    for (int s = 0; s < sectors; ++s) {
      const double around = 2 * M_PI * s / sectors;
      add(Eigen::Vector3d(std::sin(polar) * std::cos(around), -std::cos(polar), std::sin(polar) * std::sin(around))
              .cast<float>());
    }
  }
  add({0, 1, 0});
  const int last = mesh.n_vertices() - 1;
  auto at = [&](int r, int s) { return 1 + (r - 1) * sectors + s % sectors; };
  auto face = [&](int a, int b, int c) {
    auto p = [&](int i) { return Eigen::Map<const Eigen::Vector3f>(mesh.positions.data() + 3 * i); };
    const bool outwards = (p(b) - p(a)).cross(p(c) - p(a)).dot(p(a) - center) > 0;
    mesh.triangles.insert(mesh.triangles.end(), {a, outwards ? b : c, outwards ? c : b});
  };
  for (int s = 0; s < sectors; ++s) {
    face(0, at(1, s), at(1, s + 1));
    for (int r = 1; r + 1 < rings; ++r) {
      face(at(r, s), at(r + 1, s), at(r + 1, s + 1));
      face(at(r, s), at(r + 1, s + 1), at(r, s + 1));
    }
    face(last, at(rings - 1, s), at(rings - 1, s + 1));
  }
  return mesh;
}

// A grid of cells x cells squares at constant depth, facing the camera.
inline void add_plane(Mesh& mesh, float x0, float y0, float side, float z, int cells) {
  const int base = mesh.n_vertices();
  for (int r = 0; r <= cells; ++r) {
    for (int c = 0; c <= cells; ++c) {
      mesh.positions.insert(mesh.positions.end(), {x0 + side * c / cells, y0 + side * r / cells, z});
    }
  }
  for (int r = 0; r < cells; ++r) {
    for (int c = 0; c < cells; ++c) {
      const int a = base + r * (cells + 1) + c;
      mesh.triangles.insert(mesh.triangles.end(), {a, a + cells + 1, a + 1, a + 1, a + cells + 1, a + cells + 2});
    }
  }
}

}  // namespace livecap::test
