// Hanging cloth that is matched anew from where its simulation alone has it, in case that what was carried on from the
// last frame has gone astray (kernels/match/match_anew.cl).
#pragma once

#include "ocl/buffer.h"
#include "ocl/kernel.h"

namespace livecap {

class ClothAnew {
 public:
  // share: those anew count where their weights sum to so much of the others'. Keeps a reference to the device only.
  ClothAnew(ocl::DeviceContext& device, int n_vertices, float share);

  // matches [LC_MATCH*n_vertices] of a TextureMatcher, found from the simulation alone: kept for choose().
  void keep(const ocl::Buffer<float>& matches);
  // matches: found from where the last displacement has the cloth; those that were kept take their places where they
  // are better. Both are enqueued, and throw LogicError for a buffer of another size.
  void choose(ocl::Buffer<float>& matches);

 private:
  int n_vertices_;
  float share_;
  size_t group_;
  ocl::Buffer<float> anew_;
  ocl::Kernel match_anew_;
};

}  // namespace livecap
