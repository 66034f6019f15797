// A garment in folds, carried by legs: where they push it outwards it goes along, where they move away from it it stays
// hanging, since its folds open before the rest of it pulls. Not of the paper, whose V^S is the skinned template.
#pragma once

#include <span>

#include "actor/actor.h"
#include "actor/skinner.h"
#include "ocl/buffer.h"
#include "ocl/kernel.h"

namespace livecap {

class FoldedCloth {
 public:
  // hung_weights, opening: of HangingCloth. Keeps no reference to the actor.
  FoldedCloth(ocl::DeviceContext& device, const Actor& actor, const SkinWeights& hung_weights, float opening);

  // dual_quats: of HangingCloth. carried: [3n] mm, camera frame, the template skinned with HangingCloth::weights, with
  // its unit normals [3n]; cloth that legs move away from is moved back towards where it hangs. start, start_before
  // [3n]: moved by as much. Enqueued.
  void open(std::span<const float> dual_quats, const ocl::Buffer<float>& normals, ocl::Buffer<float>& carried,
            ocl::Buffer<float>& start, ocl::Buffer<float>& start_before);

 private:
  float opening_;
  int lanes_;
  int n_;
  Skinner hung_skinner_;
  ocl::Buffer<float> zero_, hung_;  // [3n]
  ocl::Buffer<float> side_;         // [n] -1 where normals point to the legs (linings), 1 elsewhere
  ocl::Kernel open_;
};

}  // namespace livecap
