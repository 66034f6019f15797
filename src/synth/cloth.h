// Clothes that lag behind and swing around the skinned surface: a mass-spring simulation with position-based edge
// lengths and capsules for the limbs. Small and stable rather than exact: it makes truth that skinning alone cannot
// reach.
#pragma once

#include <vector>

#include "synth/actor_model.h"

namespace livecap::synth {

class Cloth {
 public:
  explicit Cloth(const ActorModel& actor);

  // Vertices that may leave the skinned surface.
  const std::vector<int>& vertices() const { return free_; }

  // Starts at rest on the skinned surface.
  void reset(const std::vector<Vec3>& skinned, const BonePose& pose);
  // Advances to the next frame, whose skinned surface and bones are given (linear in between); room frame, mm.
  const std::vector<Vec3>& step(const std::vector<Vec3>& skinned, const BonePose& pose, double seconds);

 private:
  struct Edge {
    int a, b;
    double length;
    double stiffness;
  };
  struct Capsule {
    int from, to;  // bones
    double radius_from, radius_to;
  };

  void substep(const std::vector<Vec3>& target, const std::vector<Vec3>& origins, double dt);

  const ActorModel& actor_;
  std::vector<int> free_;
  std::vector<double> freedom_;  // [n] 0 held on the skin .. 1 hanging free
  std::vector<double> spring_;   // [n] 1/s^2, pull towards the skinned place
  std::vector<bool> inner_;      // [n] underside of the skirt: follows its neighbours, no collisions
  std::vector<Edge> edges_;      // with at least one free end
  std::vector<Capsule> capsules_;
  std::vector<std::vector<int>> neighbors_;
  std::vector<Vec3> position_, velocity_, previous_target_, previous_origins_;
};

}  // namespace livecap::synth
