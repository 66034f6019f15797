// Cloth that hangs by its own weight: triangles that resist strain along warp and weft and shear between them, hinges
// that resist bending (Grinspun et al. 2003), air, and cones it slides on, by extended position based dynamics (Macklin
// et al. 2016) with small steps. In units of material, and written apart from the tracker's simulation on purpose:
// truth must not fall the way its measure does.
#pragma once

#include <array>
#include <vector>

#include "synth/rig.h"

namespace livecap::synth {

constexpr double kGravity = 9810;  // mm/s^2

// Of a stiff, lined skirt.
struct Fabric {
  double density = 0.22;  // kg/m^2
  double stretch = 700;   // N/m, along warp and weft
  double shear = 150;     // N/m
  double bending = 9e-4;  // N m
  double drag = 1.1;      // of a plate across the air
  double damping = 4;     // 1/s, of velocities relative to those of the neighbours
  double friction = 0.3;  // of what it slides on
};

// A cone with round ends, mm: where it is at the beginning of a step and at its end. That it spins takes nothing along.
struct MovingCone {
  std::array<Vec3, 2> from, to;  // at the beginning, at the end
  double radius_from, radius_to;
};

// The angle between two triangles about their common edge a b, 0 where they are flat, rad; c and d are opposite, the
// triangles a b c and b a d. gradient: by a, b, c, d.
double hinge_angle(const std::array<Vec3, 4>& abcd, std::array<Vec3, 4>* gradient = nullptr);

class FallingCloth {
 public:
  // rest: mm, of all vertices, of which the triangles use some; held [n]: 1 for what the caller moves. reach_mm
  // [n_cones][n]: for a vertex a cone is at most so thick. Y is up. Throws LogicError for lists of other lengths, as
  // step() does.
  FallingCloth(const std::vector<Vec3>& rest, const std::vector<Eigen::Vector3i>& triangles,
               const std::vector<char>& held, const std::vector<std::vector<double>>& reach_mm, const Fabric& fabric);

  // What falls.
  const std::vector<int>& vertices() const { return free_; }

  // At rest where `position` [n] is.
  void reset(const std::vector<Vec3>& position);

  // From one frame to the next: held vertices go on straight lines to where `target` [n] is.
  const std::vector<Vec3>& step(const std::vector<Vec3>& target, const std::vector<MovingCone>& cones, double seconds);

 private:
  struct Weave {
    std::array<int, 3> corner;
    std::array<double, 3> warp, weft;  // of the corners' positions: the deformed directions of a mm
    double area;                       // mm^2
  };
  struct Hinge {
    std::array<int, 4> corner;
    double angle, stiffness;  // rad, N mm
  };

  void fall(double dt);
  void keep_shape(const Weave& weave, double dt);
  void keep_angle(const Hinge& hinge, double dt);
  void keep_outside(const std::vector<MovingCone>& cones, double t, double t_before);

  Fabric fabric_;
  std::vector<int> free_, used_;
  std::vector<double> inverse_mass_;  // [n] 1/kg
  std::vector<std::vector<double>> reach_;
  std::vector<std::vector<int>> neighbors_;
  std::vector<Weave> weaves_;
  std::vector<Hinge> hinges_;
  std::vector<Vec3> position_, before_, velocity_, held_from_;
};

}  // namespace livecap::synth
