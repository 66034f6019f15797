// `extras.livecap` of an actor file: what its author says about bones, limits, markers and keypoints
// (docs/formats.md). Private to the actor room.
#pragma once

#include <Eigen/Core>
#include <map>
#include <string>
#include <utility>

#include "actor/gltf_reader.h"

namespace livecap {

struct ActorExtras {
  std::map<std::string, std::string> bones;                     // LiveCap-32 joint -> bone of the file
  std::map<std::string, std::pair<double, double>> limits_deg;  // joint angle -> lowest, highest
  std::map<std::string, int> markers;                           // face keypoint -> welded vertex
  std::map<std::string, Eigen::Vector3d> keypoint_offsets_m;    // keypoint -> offset from its joint, rest frame
  bool guessed_weights = false, rough_shape = false;            // see Actor
};

// Collected from wherever an exporter put it: asset, scenes, meshes, skins, nodes; the first mention of a key counts.
// Throws IoError naming the field that is not what it has to be.
ActorExtras read_actor_extras(const GltfReader& file);

}  // namespace livecap
