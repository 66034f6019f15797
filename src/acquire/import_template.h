// `livecap actor import`: a template as the data sets of LiveCap, MonoPerfCap and DeepCap publish it, a mesh with a
// Skeletool skeleton and skin (actor/skeletool.h), to actor.glb (docs/actor_build.md).
#pragma once

#include <Eigen/Geometry>
#include <filesystem>
#include <string>
#include <vector>

#include "acquire/template_rig.h"
#include "actor/actor.h"
#include "actor/skeletool.h"
#include "meshing/actor_glb.h"

namespace livecap::acquire {

struct TemplateFiles {
  std::filesystem::path skeleton;
  std::filesystem::path skin;
  std::filesystem::path mesh;     // of the skeleton at zero angles, mm
  std::filesystem::path texture;  // empty: what the mesh itself names
  std::filesystem::path labels;   // see vertex_labels.h; empty: guessed
  std::filesystem::path bones;    // see find_rig; empty: by their names
};

struct ImportedTemplate {
  meshing::ActorFile actor;  // all bones of the skeleton, with the rig's named
  SkeletoolSkeleton skeleton;
  RigBones rig{};
  SkinWeights skin;  // of the actor's vertices, by the skeleton's bones
  Eigen::Isometry3d rest_from_world = Eigen::Isometry3d::Identity();  // mm, from the skeleton's world at zero angles
  std::vector<std::string> notes;                                     // what was left out, assumed or guessed
};

// name: of the actor. Throws IoError naming the file and what is wrong with it or does not fit to another.
ImportedTemplate import_template(const TemplateFiles& files, const std::string& name);

}  // namespace livecap::acquire
