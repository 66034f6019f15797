#include "synth/falling_cloth.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "geometry/segment.h"
#include "livecap/error.h"

namespace livecap::synth {

namespace {

constexpr int kSmallSteps = 80;  // a frame; with fewer, one round of corrections each leaves cloth softer than it is
constexpr double kAir = 1.2e-9;  // kg/mm^3
constexpr double kSquareMetre = 1e6;

// Unit vectors in the plane of a triangle: along its warp, which goes around, and its weft, which goes up.
std::pair<Vec3, Vec3> weave_directions(const Vec3& normal) {
  Vec3 around = Vec3::UnitY().cross(normal);
  if (around.norm() < 1e-3) around = Vec3::UnitX() - normal.x() * normal;
  around.normalize();
  return {around, normal.cross(around)};
}

}  // namespace

// Gradient: Bridson et al. 2003.
double hinge_angle(const std::array<Vec3, 4>& abcd, std::array<Vec3, 4>* gradient) {
  const auto& [a, b, c, d] = abcd;
  const Vec3 edge = b - a, first = edge.cross(c - a), second = (d - a).cross(edge);
  const double length = edge.norm(), first2 = first.squaredNorm(), second2 = second.squaredNorm();
  if (length * first2 * second2 == 0) {
    if (gradient) gradient->fill(Vec3::Zero());
    return 0;
  }
  if (gradient) {
    const Vec3 along = edge / length;
    (*gradient)[2] = -length / first2 * first;
    (*gradient)[3] = -length / second2 * second;
    (*gradient)[0] = -(c - b).dot(along) / first2 * first - (d - b).dot(along) / second2 * second;
    (*gradient)[1] = (c - a).dot(along) / first2 * first + (d - a).dot(along) / second2 * second;
  }
  return std::atan2(first.cross(second).dot(edge) / length, first.dot(second));
}

FallingCloth::FallingCloth(const std::vector<Vec3>& rest, const std::vector<Eigen::Vector3i>& triangles,
                           const std::vector<char>& held, const std::vector<std::vector<double>>& reach_mm,
                           const Fabric& fabric)
    : fabric_(fabric), inverse_mass_(rest.size(), 0), reach_(reach_mm), neighbors_(rest.size()) {
  if (held.size() != rest.size()) throw LogicError("falling cloth: not one value in `held` for each vertex");
  for (const std::vector<double>& mm : reach_mm)
    if (mm.size() != rest.size()) throw LogicError("falling cloth: not one reach for each vertex");
  std::map<std::pair<int, int>, std::vector<std::array<int, 2>>> edges;  // triangle, corner opposite
  std::vector<double> mass(rest.size(), 0);
  for (const Eigen::Vector3i& t : triangles) {
    const Vec3 p = rest[t[1]] - rest[t[0]], q = rest[t[2]] - rest[t[0]], normal = p.cross(q);
    const double area = normal.norm() / 2;
    if (area == 0) continue;
    const auto [warp, weft] = weave_directions(normal.normalized());
    Eigen::Matrix2d flat;
    flat << p.dot(warp), q.dot(warp), p.dot(weft), q.dot(weft);
    const Eigen::Matrix2d inverse = flat.inverse();
    Weave weave{{t[0], t[1], t[2]}, {}, {}, area};
    weave.warp = {-inverse(0, 0) - inverse(1, 0), inverse(0, 0), inverse(1, 0)};
    weave.weft = {-inverse(0, 1) - inverse(1, 1), inverse(0, 1), inverse(1, 1)};
    for (int k = 0; k < 3; ++k) {
      mass[t[k]] += fabric.density / kSquareMetre * area / 3;
      edges[std::minmax(t[k], t[(k + 1) % 3])].push_back({static_cast<int>(weaves_.size()), t[(k + 2) % 3]});
    }
    weaves_.push_back(weave);
  }
  for (const auto& [edge, sides] : edges) {
    const auto [a, b] = edge;
    neighbors_[a].push_back(b);
    neighbors_[b].push_back(a);
    if (sides.size() != 2) continue;
    const int c = sides[0][1], d = sides[1][1];  // the sign of the angle is that of the rest
    const double area = weaves_[sides[0][0]].area + weaves_[sides[1][0]].area;
    hinges_.push_back({{a, b, c, d},
                       hinge_angle({rest[a], rest[b], rest[c], rest[d]}),
                       fabric.bending * kSquareMetre * (rest[b] - rest[a]).squaredNorm() / area});
  }
  for (int i = 0; i < static_cast<int>(rest.size()); ++i) {
    if (mass[i] == 0) continue;
    used_.push_back(i);
    if (held[i]) continue;
    inverse_mass_[i] = 1 / mass[i];
    free_.push_back(i);
  }
}

void FallingCloth::reset(const std::vector<Vec3>& position) {
  position_ = before_ = held_from_ = position;
  velocity_.assign(position.size(), Vec3::Zero());
}

const std::vector<Vec3>& FallingCloth::step(const std::vector<Vec3>& target, const std::vector<MovingCone>& cones,
                                            double seconds) {
  if (position_.size() != inverse_mass_.size() || target.size() != position_.size() || cones.size() != reach_.size())
    throw LogicError("falling cloth: other vertices or cones than before");
  const double dt = seconds / kSmallSteps;
  for (int k = 1; k <= kSmallSteps; ++k) {
    const double t = static_cast<double>(k) / kSmallSteps;
    before_ = position_;
    for (int i : used_)
      if (inverse_mass_[i] == 0) position_[i] = (1 - t) * held_from_[i] + t * target[i];
    fall(dt);
    for (const Weave& weave : weaves_) keep_shape(weave, dt);
    for (const Hinge& hinge : hinges_) keep_angle(hinge, dt);
    keep_outside(cones, t, static_cast<double>(k - 1) / kSmallSteps);
    for (int i : used_) velocity_[i] = (position_[i] - before_[i]) / dt;
  }
  held_from_ = target;
  return position_;
}

// Gravity, air on what moves across itself, and what neighbours take along.
void FallingCloth::fall(double dt) {
  std::vector<Vec3> force(position_.size(), Vec3::Zero());
  for (const Weave& w : weaves_) {
    const auto [a, b, c] = w.corner;
    const Vec3 normal = (position_[b] - position_[a]).cross(position_[c] - position_[a]);
    const double doubled = normal.norm();
    if (doubled == 0) continue;
    const double across = (velocity_[a] + velocity_[b] + velocity_[c]).dot(normal) / (3 * doubled);
    const Vec3 share = -0.5 * kAir * fabric_.drag * std::abs(across) * across / 2 / 3 * normal;
    for (int i : w.corner) force[i] += share;
  }
  const double taken = 1 - std::exp(-fabric_.damping * dt);
  for (int i : free_) {
    Vec3 mean = Vec3::Zero();
    for (int j : neighbors_[i]) mean += velocity_[j];
    Vec3 velocity = velocity_[i] + taken * (mean / static_cast<double>(neighbors_[i].size()) - velocity_[i]);
    velocity += dt * (inverse_mass_[i] * force[i] - kGravity * Vec3::UnitY());
    position_[i] += dt * velocity;
  }
}

void FallingCloth::keep_shape(const Weave& weave, double dt) {
  std::array<double, 3> free;
  for (int k = 0; k < 3; ++k) free[k] = inverse_mass_[weave.corner[k]];
  if (free[0] + free[1] + free[2] == 0) return;
  const auto direction = [&](const std::array<double, 3>& of) {
    Vec3 sum = Vec3::Zero();
    for (int k = 0; k < 3; ++k) sum += of[k] * position_[weave.corner[k]];
    return sum;
  };
  // C = how far it is violated, its gradient by each corner, N/m.
  const auto correct = [&](double violated, const std::array<Vec3, 3>& gradient, double stiffness) {
    double sum = 1 / (stiffness * weave.area * dt * dt);
    for (int k = 0; k < 3; ++k) sum += free[k] * gradient[k].squaredNorm();
    for (int k = 0; k < 3; ++k) position_[weave.corner[k]] -= free[k] * violated / sum * gradient[k];
  };
  for (const auto& thread : {weave.warp, weave.weft}) {
    const Vec3 along = direction(thread);
    const double length = along.norm();
    if (length < 1e-9) continue;
    const Vec3 unit = along / length;
    correct(length - 1, {thread[0] * unit, thread[1] * unit, thread[2] * unit}, fabric_.stretch);
  }
  const Vec3 warp = direction(weave.warp), weft = direction(weave.weft);
  std::array<Vec3, 3> gradient;
  for (int k = 0; k < 3; ++k) gradient[k] = weave.warp[k] * weft + weave.weft[k] * warp;
  correct(warp.dot(weft), gradient, fabric_.shear);
}

void FallingCloth::keep_angle(const Hinge& hinge, double dt) {
  std::array<Vec3, 4> corner, gradient;
  double sum = 1 / (hinge.stiffness * dt * dt), free = 0;
  for (int k = 0; k < 4; ++k) {
    corner[k] = position_[hinge.corner[k]];
    free += inverse_mass_[hinge.corner[k]];
  }
  if (free == 0) return;
  const double bent = std::remainder(hinge_angle(corner, &gradient) - hinge.angle, 2 * M_PI);
  for (int k = 0; k < 4; ++k) sum += inverse_mass_[hinge.corner[k]] * gradient[k].squaredNorm();
  for (int k = 0; k < 4; ++k) position_[hinge.corner[k]] -= inverse_mass_[hinge.corner[k]] * bent / sum * gradient[k];
}

// t, t_before: how far in the frame.
void FallingCloth::keep_outside(const std::vector<MovingCone>& cones, double t, double t_before) {
  for (size_t k = 0; k < cones.size(); ++k) {
    const MovingCone& cone = cones[k];
    const auto at = [&](const std::array<Vec3, 2>& end, double s) -> Vec3 { return (1 - s) * end[0] + s * end[1]; };
    const Vec3 from = at(cone.from, t), to = at(cone.to, t);
    const Vec3 from_before = at(cone.from, t_before), to_before = at(cone.to, t_before);
    for (int i : free_) {
      const double s = segment_parameter(position_[i], from, to);
      const Vec3 out = position_[i] - (1 - s) * from - s * to;
      const double radius = std::min((1 - s) * cone.radius_from + s * cone.radius_to, reach_[k][i]);
      const double distance = out.norm(), depth = radius - distance;
      if (depth <= 0 || distance < 1e-6) continue;
      const Vec3 normal = out / distance;
      position_[i] += depth * normal;
      // Friction: of what it slid along the cone, which moves itself, at most so much of how deep it was pushed.
      Vec3 slid = position_[i] - before_[i] - (1 - s) * (from - from_before) - s * (to - to_before);
      slid -= slid.dot(normal) * normal;
      const double length = slid.norm();
      if (length > 1e-12) position_[i] -= std::min(1.0, fabric_.friction * depth / length) * slid;
    }
  }
}

}  // namespace livecap::synth
