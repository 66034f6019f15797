// The skinned primitives of an actor file as they stand in the world, before welding: one entry per vertex of the file.
// Private to the actor room.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "actor/gltf_reader.h"
#include "actor/texture_atlas.h"

namespace livecap {

struct SkinBinding {
  std::vector<int> joints;                       // nodes
  std::vector<Eigen::Matrix4d> mesh_from_joint;  // bind pose
};

// All skins of the file; at least one, with at least one joint. Throws IoError.
std::vector<SkinBinding> read_skins(const GltfReader& file);

struct SkinnedMesh {
  std::vector<Eigen::Vector3d> positions;   // world, units of the file
  std::vector<std::array<double, 3>> keys;  // raw POSITION; equal skin and key weld
  std::vector<int> skins;
  std::vector<std::vector<std::pair<int, double>>> influences;  // node, weight
  std::vector<int> labels;                                      // -1: none
  std::vector<std::array<double, 2>> uvs;
  std::vector<int> tiles;                     // of the atlas, -1: no texture
  std::vector<std::array<double, 3>> colors;  // sRGB; negative: none
  std::vector<uint32_t> triangles;

  std::vector<Eigen::Vector3d> joint_world;  // [n_nodes] bind position; NaN for nodes that are no joints
  TextureAtlas atlas;                        // every texture and plain colour of the materials
  bool has_image = false;                    // false: the atlas holds plain colours only
  int n_bad_labels = 0;
};

// root_node: the joint whose default pose says how the bind pose stands in the world. What was ignored or assumed is
// appended to notes. Throws IoError.
SkinnedMesh read_skinned_mesh(const GltfReader& file, const std::vector<SkinBinding>& skins, int root_node,
                              std::vector<std::string>& notes);

}  // namespace livecap
