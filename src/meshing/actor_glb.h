// A rigged, textured, labelled actor as a glTF 2.0 binary (docs/formats.md).
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "base/image_rgb.h"
#include "meshing/atlas.h"
#include "meshing/isosurface.h"

namespace livecap::meshing {

struct Influence {
  int bone = 0;
  double weight = 0;
};
using Influences = std::array<Influence, 4>;  // strongest first, sum 1, unused slots are {0, 0}

struct RigBone {
  std::string name;
  int parent = -1;              // -1 for the root; parents come first
  Eigen::Vector3d position_mm;  // of its joint, rest frame; every bone frame is parallel to the rest frame
};

struct ActorFile {
  std::string name;
  Surface surface;  // welded, mm: +X the subject's left, +Y up, +Z front
  std::vector<RigBone> bones;
  std::vector<Influences> weights;  // [n_vertices]
  std::vector<uint8_t> labels;      // [n_vertices] LIP ids
  Atlas atlas;
  ImageRgb texture;                                           // empty: the colours, if there are some
  std::vector<std::pair<std::string, int>> markers;           // face keypoint, welded vertex
  std::vector<Eigen::Vector3d> colors = {};                   // [n_vertices] sRGB in [0,1], or empty
  std::vector<std::pair<std::string, std::string>> rig = {};  // LiveCap's joint, bone; empty: told by the names
  bool guessed_weights = false;                               // nobody painted them
  bool rough_shape = false;                                   // sizes are some mm off

  int marker_vertex(const std::string& name) const;  // -1: there is none
};

// The bytes of the file. Throws LogicError when they cannot be made.
std::string actor_glb(const ActorFile& actor);

}  // namespace livecap::meshing
