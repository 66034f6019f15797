// Clothes that do more than skinning alone can reach. Skirts fall (synth/falling_cloth.h); tops and trousers, which the
// body holds, lag behind and swing around the skinned surface: a mass-spring simulation with position-based edge
// lengths, small and stable rather than exact.
#pragma once

#include <optional>
#include <vector>

#include "synth/actor_model.h"
#include "synth/falling_cloth.h"

namespace livecap::synth {

class Cloth {
 public:
  explicit Cloth(const ActorModel& actor);

  // Vertices that may leave the skinned surface.
  const std::vector<int>& vertices() const { return moving_; }

  // Starts at rest on the skinned surface.
  void reset(const std::vector<Vec3>& skinned, const BonePose& pose);
  // Advances to the next frame, whose skinned surface and bones are given (linear in between); room frame, mm.
  const std::vector<Vec3>& step(const std::vector<Vec3>& skinned, const BonePose& pose, double seconds);

 private:
  struct Edge {
    int a, b;
    double length;
  };
  struct Limb {
    int from, to;  // bones
    double radius_from, radius_to;
  };

  void set_up_skirt(const BodyShape& shape);
  void substep(const std::vector<Vec3>& target, const std::vector<Vec3>& origins, double dt);
  void step_skirt(const std::vector<Vec3>& skinned, const BonePose& pose, double seconds);

  const ActorModel& actor_;
  std::vector<int> moving_;
  std::vector<int> close_;       // of tops and trousers
  std::vector<double> freedom_;  // [n] of them, 0 held on the skin .. 1 hanging free
  std::vector<double> spring_;   // [n] of them, 1/s^2, pull towards the skinned place
  std::vector<Edge> edges_;      // of them, with at least one free end
  std::vector<Limb> limbs_;
  std::optional<FallingCloth> skirt_;
  std::vector<int> lid_;  // underside of the skirt
  std::vector<std::vector<int>> neighbors_;
  std::vector<Vec3> position_, velocity_, previous_target_, previous_origins_;
};

}  // namespace livecap::synth
