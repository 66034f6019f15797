// What solving and snapping of stage II share: the template's graph on the device and the camera, checked once.
#pragma once

#include <memory>
#include <string>

#include "actor/actor.h"
#include "geometry/pinhole_arg.h"
#include "livecap/camera.h"
#include "livecap/error.h"
#include "ocl/buffer.h"
#include "surface/sell.h"

namespace livecap {

struct SurfaceDomain {
  // camera: undistorted. Keeps no reference to its arguments. Throws ConfigError when they do not fit.
  SurfaceDomain(ocl::DeviceContext& device, const Actor& actor, const Camera& camera);

  SellGraph graph;
  ocl::Buffer<int32_t> order, slice_offsets, neighbors;  // of the graph
  size_t lane_items, lane_local;  // work items of a kernel that takes the graph a vector of rows at a time
  PinholeArg camera;
  int width;
  int height;
};

// Throws LogicError. name: whose buffer and which, as in "snap: vertices".
template <typename T>
void require_size(const ocl::Buffer<T>& buffer, size_t expected, const char* name) {
  if (buffer.size() != expected) {
    throw LogicError(std::string(name) + " has " + std::to_string(buffer.size()) + " elements, expected " +
                     std::to_string(expected));
  }
}

}  // namespace livecap
