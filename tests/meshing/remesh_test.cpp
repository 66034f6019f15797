// Surfaces of known fields with as many vertices as asked: closed, even, finer where they are curved, and nothing that
// sticks out is lost.
#include "meshing/remesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "livecap/error.h"
#include "meshing/isosurface.h"
#include "scan/scan.h"

namespace livecap::meshing {
namespace {

using Eigen::Vector3d;

double capsule(const Vector3d& p, const Vector3d& a, const Vector3d& b, double radius) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - a - t * (b - a)).norm() - radius;
}

// A trunk of 90 mm with a finger of 8 mm that sticks out by 100.
double trunk_with_finger(const Vector3d& p) {
  return std::min(capsule(p, {0, -150, 0}, {0, 150, 0}, 90), capsule(p, {0, 0, 0}, {182, 0, 0}, 8));
}

// A cone of cloth with a sharp hem: its lower end is flat.
double skirt(const Vector3d& p) {
  const double around = (std::hypot(p.x(), p.z()) - (200 - 0.4 * p.y())) / std::hypot(1.0, 0.4);
  return std::max({around, -p.y() - 150, p.y() - 150});
}

Surface fine_surface(const DistanceField& field, double reach, double step) {
  return extract_surface(field, Vector3d::Constant(-reach), Vector3d::Constant(reach), step);
}

std::vector<double> edges_of(const Surface& surface) {
  std::vector<double> lengths;
  for (const auto& t : surface.triangles)
    for (int k = 0; k < 3; ++k)
      if (t[k] < t[(k + 1) % 3]) lengths.push_back((surface.vertices[t[k]] - surface.vertices[t[(k + 1) % 3]]).norm());
  std::sort(lengths.begin(), lengths.end());
  return lengths;
}

double quantile(const std::vector<double>& sorted, double share) {
  return sorted[static_cast<size_t>(share * static_cast<double>(sorted.size() - 1))];
}

double smallest_angle_deg(const Surface& surface) {
  double least = 180;
  for (const auto& t : surface.triangles)
    for (int k = 0; k < 3; ++k) {
      const Vector3d a = surface.vertices[t[(k + 1) % 3]] - surface.vertices[t[k]];
      const Vector3d b = surface.vertices[t[(k + 2) % 3]] - surface.vertices[t[k]];
      least = std::min(least, std::atan2(a.cross(b).norm(), a.dot(b)) * 180 / M_PI);
    }
  return least;
}

// Euler's formula for a closed surface without holes.
void expect_closed_ball(const Surface& surface) {
  EXPECT_TRUE(is_closed_manifold(surface));
  EXPECT_EQ(surface.triangles.size(), 2 * surface.vertices.size() - 4);
}

TEST(Remesh, ABallIsEvenAndOnItsSurface) {
  const DistanceField ball = [](const Vector3d& p) { return p.norm() - 150; };
  const Surface fine = fine_surface(ball, 180, 6);
  const Surface coarse = remesh(fine, 500);
  ASSERT_EQ(coarse.vertices.size(), 500u);
  expect_closed_ball(coarse);
  const auto edges = edges_of(coarse);
  // Of 996 equilateral triangles that cover it.
  const double ideal = std::sqrt(4 * M_PI * 150 * 150 / 996 * 4 / std::sqrt(3.0));
  std::printf("edges of a ball: %.1f, %.1f and %.1f mm (5, 50 and 95 %%), ideal %.1f; least angle %.0f degrees\n",
              quantile(edges, 0.05), quantile(edges, 0.5), quantile(edges, 0.95), ideal, smallest_angle_deg(coarse));
  EXPECT_GT(quantile(edges, 0.05), 0.7 * ideal);
  EXPECT_LT(quantile(edges, 0.95), 1.35 * ideal);
  EXPECT_GT(smallest_angle_deg(coarse), 20);
  const auto off = [](const Surface& surface) {
    double worst = 0;
    for (const Vector3d& p : surface.vertices) worst = std::max(worst, std::abs(p.norm() - 150));
    return worst;
  };
  std::printf("off the ball by at most %.2f mm, before %.2f\n", off(coarse), off(fine));
  EXPECT_LT(off(coarse), off(fine) + 0.3);  // and what the fine triangles are lower than their corners
}

TEST(Remesh, AFingerIsFinerAndAsLongAsItWas) {
  const Surface fine = fine_surface(trunk_with_finger, 260, 4);
  const Surface coarse = remesh(fine, 700);
  ASSERT_EQ(coarse.vertices.size(), 700u);
  expect_closed_ball(coarse);
  double reach = 0;
  std::vector<double> trunk, finger;
  for (const auto& t : coarse.triangles) {
    const Vector3d &a = coarse.vertices[t[0]], &b = coarse.vertices[t[1]];
    (a.x() > 110 ? finger : trunk).push_back((a - b).norm());
  }
  for (const Vector3d& p : coarse.vertices) reach = std::max(reach, p.x());
  std::sort(trunk.begin(), trunk.end());
  std::sort(finger.begin(), finger.end());
  std::printf("a finger of 190 mm reaches %.1f; edges %.1f there and %.1f on the trunk\n", reach, quantile(finger, 0.5),
              quantile(trunk, 0.5));
  EXPECT_GT(reach, 186);
  EXPECT_LT(quantile(finger, 0.5), 0.75 * quantile(trunk, 0.5));
}

TEST(Remesh, AHemStaysSharp) {
  const Surface fine = fine_surface(skirt, 300, 6);
  const Surface coarse = remesh(fine, 800);
  ASSERT_EQ(coarse.vertices.size(), 800u);
  expect_closed_ball(coarse);
  // The flat lid ends where the cone does: 260 mm from the axis, in every direction.
  std::vector<double> rim(36, 0);
  for (const Vector3d& p : coarse.vertices) {
    if (p.y() > -140) continue;
    const int sector = static_cast<int>((std::atan2(p.z(), p.x()) / (2 * M_PI) + 0.5) * 35.999);
    rim[sector] = std::max(rim[sector], std::hypot(p.x(), p.z()));
  }
  const auto [least, most] = std::minmax_element(rim.begin(), rim.end());
  std::printf("a hem of 260 mm: %.1f to %.1f\n", *least, *most);
  EXPECT_GT(*least, 252);
  EXPECT_LT(*most, 262);
}

TEST(Remesh, TheSameTwice) {
  const Surface fine = fine_surface(trunk_with_finger, 260, 8);
  const Surface one = remesh(fine, 300), other = remesh(fine, 300);
  ASSERT_EQ(one.vertices.size(), other.vertices.size());
  EXPECT_EQ(one.vertices, other.vertices);
  EXPECT_EQ(one.triangles, other.triangles);
}

// A crumpled ring to few vertices: more than a hundred times fewer than there were, and with a hole through it.
TEST(Remesh, ANoisyRingStaysARing) {
  const DistanceField ring = [](const Vector3d& p) {
    const double noise = 0.6 * std::sin(0.9 * p.x()) * std::sin(1.1 * p.y()) * std::sin(0.7 * p.z());
    return std::hypot(std::hypot(p.x(), p.z()) - 120, p.y()) - 40 + noise;
  };
  const Surface fine = fine_surface(ring, 180, 5);
  const Surface coarse = remesh(fine, 250);
  EXPECT_GT(fine.vertices.size(), 100 * coarse.vertices.size());
  EXPECT_EQ(coarse.vertices.size(), 250u);
  EXPECT_TRUE(is_closed_manifold(coarse));
  // Euler's formula with one hole.
  EXPECT_EQ(fine.triangles.size(), 2 * fine.vertices.size());
  EXPECT_EQ(coarse.triangles.size(), 2 * coarse.vertices.size());
}

TEST(Remesh, OneVertexLess) {
  const Surface fine = fine_surface(skirt, 300, 40);
  const int n = static_cast<int>(fine.vertices.size());
  EXPECT_EQ(remesh(fine, n - 1).vertices.size(), static_cast<size_t>(n - 1));
  EXPECT_THROW(remesh(fine, 3), LogicError);
}

TEST(Remesh, WhatIsCoarseEnoughStaysAsItIs) {
  const Surface fine = fine_surface(trunk_with_finger, 260, 20);
  const int n = static_cast<int>(fine.vertices.size());
  EXPECT_EQ(remesh(fine, n).vertices, fine.vertices);
  EXPECT_EQ(remesh(fine, n + 100).triangles.size(), fine.triangles.size());
}

}  // namespace
}  // namespace livecap::meshing
