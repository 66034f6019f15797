// The Gauss-Newton system of stage II assembled row by row in double precision with Eigen, written from the paper's
// equations and sharing no code with the solver: sparse J, F, and the energies.
#pragma once

#include <Eigen/Sparse>
#include <Eigen/SparseCholesky>
#include <cmath>
#include <set>
#include <vector>

#include "match/layout.h"
#include "surface/scene.h"

namespace livecap::test {

// The Gaussian-blurred image at any position, in [0,1] per channel: every pixel within the support, double precision.
inline Eigen::Vector3d blurred_color(const Scene& s, double u, double v, int kernel) {
  const int r = kernel / 2;
  const double sigma = 0.3 * ((kernel - 1) * 0.5 - 1) + 0.8;
  const auto weight = [&](double d) {
    const double e = std::min(1.0, std::max(0.0, std::abs(d) - r));
    return std::exp(-d * d / (2 * sigma * sigma)) * (1 - e * e * (3 - 2 * e));
  };
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double total = 0;
  for (int y = int(std::floor(v)) - r - 1; y <= int(std::floor(v)) + r + 2; ++y)
    for (int x = int(std::floor(u)) - r - 1; x <= int(std::floor(u)) + r + 2; ++x) {
      const double w = weight(x - u) * weight(y - v);
      const int cx = std::min(std::max(x, 0), s.camera.width - 1), cy = std::min(std::max(y, 0), s.camera.height - 1);
      for (int c = 0; c < 3; ++c) sum[c] += w * s.image.pixels[3 * (size_t(cy) * s.camera.width + cx) + c] / 255.0;
      total += w;
    }
  return sum / total;
}

inline double bilinear_distance(const Scene& s, double u, double v) {
  const int w = s.camera.width, x = std::min(std::max(int(std::floor(u)), 0), w - 2);
  const int y = std::min(std::max(int(std::floor(v)), 0), s.camera.height - 2);
  const auto at = [&](int i, int j) { return double(s.silhouette.signed_distance[size_t(j) * w + i]); };
  const double fx = u - x, fy = v - y;
  return (1 - fy) * ((1 - fx) * at(x, y) + fx * at(x + 1, y)) + fy * ((1 - fx) * at(x, y + 1) + fx * at(x + 1, y + 1));
}

struct ReferenceSystem {
  Eigen::SparseMatrix<double> A;  // J^T J + damping
  Eigen::VectorXd rhs;            // -J^T F
  SurfaceEnergies energies;
};

// v: [3n] the current vertices. Photometric and distance derivatives by central differences of the images themselves.
inline ReferenceSystem reference_system(const Scene& s, const SurfaceOptions& o, const std::vector<double>& v,
                                        int kernel, bool temporal = true) {
  const int n = s.n();
  std::vector<Eigen::Triplet<double>> J;
  std::vector<double> F;
  const auto row = [&](double residual) {
    F.push_back(residual);
    return int(F.size()) - 1;
  };
  const auto point = [&](const auto& values, int i) {
    return Eigen::Vector3d(values[3 * i], values[3 * i + 1], values[3 * i + 2]);
  };
  const auto project = [&](const Eigen::Vector3d& p) {
    return Eigen::Vector2d(s.camera.fx * p.x() / p.z() + s.camera.cx, s.camera.fy * p.y() / p.z() + s.camera.cy);
  };
  // d(f(pi(p))) / dp by the chain rule, pi differentiated numerically too.
  const auto projection_jacobian = [&](const Eigen::Vector3d& p) {
    Eigen::Matrix<double, 2, 3> D;
    for (int a = 0; a < 3; ++a) {
      const double h = 1e-3;
      Eigen::Vector3d q = p, m = p;
      q[a] += h;
      m[a] -= h;
      D.col(a) = (project(q) - project(m)) / (2 * h);
    }
    return D;
  };
  ReferenceSystem out;
  const double h = 1e-5;
  for (int i = 0; i < n; ++i) {
    const Eigen::Vector3d p = point(v, i);
    const Eigen::Vector2d uv = project(p);
    const Eigen::Matrix<double, 2, 3> D = projection_jacobian(p);
    if (s.visible[i] && o.w_photo > 0) {
      const Eigen::Vector3d d =
          blurred_color(s, uv.x(), uv.y(), kernel) -
          Eigen::Vector3d(s.actor.colors[3 * i], s.actor.colors[3 * i + 1], s.actor.colors[3 * i + 2]);
      if (d.norm() <= o.color_threshold) {
        const Eigen::Vector3d du =
            (blurred_color(s, uv.x() + h, uv.y(), kernel) - blurred_color(s, uv.x() - h, uv.y(), kernel)) / (2 * h);
        const Eigen::Vector3d dv =
            (blurred_color(s, uv.x(), uv.y() + h, kernel) - blurred_color(s, uv.x(), uv.y() - h, kernel)) / (2 * h);
        const double w = std::sqrt(double(o.w_photo));
        for (int c = 0; c < 3; ++c) {
          const int k = row(w * d[c]);
          for (int a = 0; a < 3; ++a) J.emplace_back(k, 3 * i + a, w * (du[c] * D(0, a) + dv[c] * D(1, a)));
        }
        out.energies.photo += o.w_photo * d.squaredNorm();
      }
    }
    if (s.contour[i] && o.w_silhouette > 0) {
      const int part = s.part_image[size_t(std::lround(uv.y())) * s.camera.width + size_t(std::lround(uv.x()))];
      if (part == 0 || part == s.vertex_part[i]) {
        const double d = bilinear_distance(s, uv.x(), uv.y());
        const Eigen::Vector2d g(
            (bilinear_distance(s, uv.x() + h, uv.y()) - bilinear_distance(s, uv.x() - h, uv.y())) / (2 * h),
            (bilinear_distance(s, uv.x(), uv.y() + h) - bilinear_distance(s, uv.x(), uv.y() - h)) / (2 * h));
        const Eigen::Vector2d normal = D * point(s.normals, i);
        // The paper: b = -1 inside when the normal points away from the direction to the contour, else +1. And 0
        // outside when the normal points to the contour: it is another part's.
        const double b = normal.dot(g) >= 0 ? 1.0 : d <= 0 ? -1.0 : 0.0;
        const double w = std::sqrt(double(o.w_silhouette));
        const int k = row(w * d);
        for (int a = 0; a < 3; ++a) J.emplace_back(k, 3 * i + a, w * b * (g.x() * D(0, a) + g.y() * D(1, a)));
        out.energies.silhouette += o.w_silhouette * d * d;
      }
    }
    if (!s.matches.empty() && s.matches[LC_MATCH * i + LC_MATCH_WEIGHT_PX] > 0) {
      const float* m = &s.matches[LC_MATCH * i];
      Eigen::Matrix2d root;
      root << m[2], m[3], 0, m[4];
      const double w = std::sqrt(double(o.w_match) * m[LC_MATCH_CORRELATION]);
      const Eigen::Vector2d r = w * root * (uv - Eigen::Vector2d(m[0], m[1]));
      const Eigen::Matrix<double, 2, 3> R = w * root * D;
      for (int k = 0; k < 2; ++k) {
        const int at = row(r[k]);
        for (int a = 0; a < 3; ++a) J.emplace_back(at, 3 * i + a, R(k, a));
      }
      out.energies.match += r.squaredNorm();
    }
    if (!hangs(s.actor, i)) {
      const Eigen::Vector3d skinned = point(s.skinned, i), ray = skinned.normalized();
      const double w = std::sqrt(double(o.w_depth)), r = (p - skinned).dot(ray);
      const int k = row(w * r);
      for (int a = 0; a < 3; ++a) J.emplace_back(k, 3 * i + a, w * ray[a]);
      out.energies.depth += o.w_depth * r * r;
    }
    if (temporal) {
      const double w_velocity = hangs(s.actor, i) ? o.w_velocity : o.w_worn_velocity;
      const double wv = std::sqrt(w_velocity), wa = std::sqrt(double(o.w_acceleration));
      const Eigen::Vector3d t1 = point(s.previous, i), t2 = point(s.before, i);
      for (int a = 0; a < 3; ++a) {
        J.emplace_back(row(wv * (p[a] - t1[a])), 3 * i + a, wv);
        J.emplace_back(row(wa * (p[a] - 2 * t1[a] + t2[a])), 3 * i + a, wa);
      }
      out.energies.velocity += w_velocity * (p - t1).squaredNorm();
      out.energies.acceleration += o.w_acceleration * (p - 2 * t1 + t2).squaredNorm();
    }
  }
  std::vector<std::set<int>> neighbors(n);
  const auto& triangles = s.actor.mesh.triangles;
  for (size_t t = 0; t < triangles.size(); t += 3)
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b)
        if (a != b) neighbors[triangles[t + a]].insert(triangles[t + b]);
  for (int i = 0; i < n; ++i)
    for (const int j : neighbors[i]) {
      const double share = (double(s.actor.rigidity[i]) + s.actor.rigidity[j]) / 2 / double(neighbors[i].size());
      const double ws = std::sqrt(o.w_smooth * share), we = std::sqrt(o.w_edge * share);
      const Eigen::Vector3d edge = point(v, i) - point(v, j);
      const Eigen::Vector3d r = edge - (point(s.skinned, i) - point(s.skinned, j));
      for (int a = 0; a < 3; ++a) {
        const int k = row(ws * r[a]);
        J.emplace_back(k, 3 * i + a, ws);
        J.emplace_back(k, 3 * j + a, -ws);
      }
      const double rest = (point(s.actor.mesh.positions, i) - point(s.actor.mesh.positions, j)).norm();
      const double skinned = (point(s.skinned, i) - point(s.skinned, j)).norm();
      const double rest_share = hangs(s.actor, i) && hangs(s.actor, j) ? o.hanging_rest_share : o.edge_rest_share;
      const double stretch = edge.norm() - (rest_share * rest + (1 - rest_share) * skinned);
      const int k = row(we * stretch);
      for (int a = 0; a < 3; ++a) {
        J.emplace_back(k, 3 * i + a, we * edge[a] / edge.norm());
        J.emplace_back(k, 3 * j + a, -we * edge[a] / edge.norm());
      }
      out.energies.smooth += o.w_smooth * share * r.squaredNorm();
      out.energies.edge += o.w_edge * share * stretch * stretch;
    }
  Eigen::SparseMatrix<double> jacobian(int(F.size()), 3 * n);
  jacobian.setFromTriplets(J.begin(), J.end());
  const Eigen::Map<const Eigen::VectorXd> f(F.data(), Eigen::Index(F.size()));
  Eigen::SparseMatrix<double> identity(3 * n, 3 * n);
  identity.setIdentity();
  out.A = Eigen::SparseMatrix<double>(jacobian.transpose()) * jacobian + double(o.damping) * identity;
  out.rhs = -(jacobian.transpose() * f);
  return out;
}

}  // namespace livecap::test
