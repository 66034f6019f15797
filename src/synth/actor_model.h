// A built-in actor, complete: surface, skin, labels, texture, markers.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "base/image_rgb.h"
#include "meshing/atlas.h"
#include "synth/body_shape.h"
#include "synth/rig.h"
#include "synth/synth.h"

namespace livecap::synth {

using meshing::Atlas;

struct ActorModel {
  std::string name;
  double scale = 1;                     // size relative to the shape's 1700 mm
  Surface surface;                      // welded, mm, actor frame, sole at y = 0
  std::array<Vec3, kBoneCount> joints;  // mm
  std::vector<Influences> weights;
  std::vector<Part> parts;
  std::vector<uint8_t> labels;  // LIP ids
  Atlas atlas;
  ImageRgb texture;
  int left_eye = 0, right_eye = 0, nose = 0, chin = 0;  // welded vertices; chin is the middle of the mouth
};

// Throws ConfigError as make_builtin_actor_glb does.
ActorModel build_actor(const std::string& name, double height_mm, int target_vertices);

// Other proportions at the same height: bones and the surface around them are stretched. Throws ConfigError.
void apply_physique(const Physique& physique, ActorModel& actor);

// What meshing::actor_glb writes.
meshing::ActorFile actor_file(const ActorModel& actor);
std::string actor_glb(const ActorModel& actor);

}  // namespace livecap::synth
