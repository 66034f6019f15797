// How hanging cloth moves with the body, without looking at pictures: position based dynamics of a ClothGraph, driven
// by the skinned surface. Links keep their rest lengths, limbs push particles away, and all of it falls from where it
// is held. Cloth in folds is soft; cloth that stands wide without folds must be stiff: springs draw each of its
// particles to the skinned place. It tells stage II what the camera does not see: how far a skirt swings, and where
// thighs lift it. Not of the paper, whose V^S is the skinned template.
#pragma once

#include <array>
#include <vector>

#include "actor/actor.h"
#include "cloth/cloth_graph.h"
#include "cloth/layout.h"
#include "ocl/buffer.h"
#include "ocl/groups_together.h"
#include "ocl/kernel.h"
#include "surface/sell.h"

namespace livecap {

struct ClothOptions {
  struct Fabric {
    float stiffness;  // 1/s^2, acceleration by a mm from the skinned place
    float damping;    // 1/s, of the velocity relative to the skinned place
    int steps;        // a frame; without springs cloth sags by 2.5 % in 20 steps, by Jacobi, by 1.1 % in 40
    // Vertices with less weight on the legs are fastened to the skinned surface. Taut cloth that is so far down lifts
    // off a body that squats.
    float max_held_leg_weight;
  };
  Fabric taut = {200, 8, 40, 0.06f}, loose = {0, 4, 80, 0.15f};
  // mm. A spring pulls no harder than stretched by so much: where a thigh lies between cloth and its skinned place, it
  // would pull it around the thigh.
  float spring_reach = 15;
  float gravity = 9810;        // mm/s^2
  float air_drag = 1;          // 1/s, of the velocity
  float bending_share = 0.3f;  // of a link across an edge by one along an edge
  float relaxation = 1.2f;     // of a particle's mean correction by its links
  // mm. What stage II is given of the cloth's displacement is smoothed over about so much, or not where links are
  // longer: cloth that is pushed together buckles as finely as its mesh is. The simulation goes on without.
  float smoothing_mm = 70;
  int settling_frames = 10;  // of a 30th of a second, in which legs bend and it falls before the first
  // Radii of hips, thighs at their upper ends, knees and ankles, by the length of a thigh: how near cloth may come. For
  // what is nearer in the rest pose no limb is thicker than that.
  std::array<float, 4> limb_radii = {0.3f, 0.3f, 0.2f, 0.2f};

  Fabric fabric(float looseness) const;  // what is part of both lies between them
  void validate() const;                 // throws ConfigError
};

class ClothSimulation {
 public:
  // looseness: of its hanging cloth, 0 taut to 1 loose (cloth/hanging_cloth.h). Keeps no reference to the actor; the
  // device must outlive it. Throws ConfigError.
  ClothSimulation(ocl::DeviceContext& device, const Actor& actor, const ClothOptions& options, float looseness);

  // False for an actor without hanging cloth: step() does nothing then.
  bool has_cloth() const { return graph_.n > 0; }
  const ClothGraph& cloth() const { return cloth_; }  // empty without

  // Forgets how the cloth moves: the next step begins where it has fallen for settling_frames, from the rest pose at
  // the hips, while the legs went from there to where they are; it may still swing.
  void reset() { first_ = true; }

  // One frame, seconds after the last. up: unit, camera frame; it falls the other way. skinned: [3n] mm, camera frame,
  // V^S in, where hanging cloth is replaced by the simulated one. start, start_before [3n]: moved by as much. Enqueued.
  // Throws LogicError unless seconds > 0.
  void step(const PosedSkeleton& posed, double seconds, const Eigen::Vector3d& up, ocl::Buffer<float>& skinned,
            ocl::Buffer<float>& start, ocl::Buffer<float>& start_before);

  // After the next blocking read: true once where a GPU's work-groups do not wait for each other. Then the buffers are
  // to be made anew, for a first step.
  bool gave_up();

 private:
  ClothStep step_of(double seconds, const Eigen::Vector3d& up) const;  // seconds: of a frame
  std::vector<float> limbs_at(const PosedSkeleton& posed) const;
  void set_limbs(const std::vector<float>& now);
  void set_up_links(ocl::DeviceContext& device, const Actor& actor, float looseness);
  void set_up_limbs(ocl::DeviceContext& device, const Actor& actor);

  ocl::DeviceContext* device_;
  ClothOptions options_;
  ClothOptions::Fabric fabric_;
  ClothGraph cloth_;
  SellGraph graph_;                           // of particles
  std::array<std::array<int, 3>, 2> legs_{};  // hip, knee and ankle
  float thigh_mm_ = 0;
  bool first_ = true;
  std::vector<float> limbs_before_;
  int base_ = 0;                   // the bone the legs hang from
  std::vector<float> rest_mm_;     // [3n] the template
  std::vector<float> limbs_rest_;  // as limbs_at() has them, in the rest pose
  size_t group_ = 1;
  int n_moved_ = 0;
  int n_smoothings_ = 0;
  ocl::Buffer<int32_t> slice_offsets_, neighbors_, vertices_, moved_, particles_;
  ocl::Buffer<float> pulls_, lengths_, smoothing_shares_, is_free_, reach_, weights_, limbs_;
  ocl::Buffer<float> before_, target_, x_, v_;  // 3 planes each
  ocl::Buffer<float> ahead_;                    // 6
  ocl::Buffer<float> hung_;                     // [3n] the template where the hips are
  ocl::GroupsTogether groups_;
  ocl::Kernel simulate_;
};

// Known-answer tests of the simulation's kernel.
std::vector<ocl::SelfTestResult> cloth_self_test(ocl::DeviceContext& device);

}  // namespace livecap
