// A small rigged figure written as GLB bytes, independent of the loader: one 4x4 patch of vertices around every joint.
#pragma once

#include <Eigen/Geometry>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>
#include <string>
#include <vector>

namespace livecap::test {

struct FixtureJoint {
  const char* name;
  const char* parent;  // nullptr: child of the armature
  Eigen::Vector3d position_m;
};

inline std::vector<FixtureJoint> mixamo_joints(const char* = nullptr) {
  return {{"mixamorig:Hips", nullptr, {0, 0.98, 0.01}},
          {"mixamorig:Spine", "mixamorig:Hips", {0, 1.2, 0}},
          {"mixamorig:Neck", "mixamorig:Spine", {0, 1.5, 0}},
          {"mixamorig:Head", "mixamorig:Neck", {0, 1.6, 0.02}},
          {"mixamorig:LeftShoulder", "mixamorig:Spine", {0.05, 1.45, 0}},
          {"mixamorig:LeftArm", "mixamorig:LeftShoulder", {0.18, 1.44, -0.01}},
          {"mixamorig:LeftForeArm", "mixamorig:LeftArm", {0.42, 1.30, -0.03}},
          {"mixamorig:LeftHand", "mixamorig:LeftForeArm", {0.64, 1.18, 0.02}},
          {"mixamorig:LeftHandMiddle1", "mixamorig:LeftHand", {0.72, 1.14, 0.03}},
          {"mixamorig:RightShoulder", "mixamorig:Spine", {-0.05, 1.45, 0}},
          {"mixamorig:RightArm", "mixamorig:RightShoulder", {-0.18, 1.44, -0.01}},
          {"mixamorig:RightForeArm", "mixamorig:RightArm", {-0.43, 1.31, -0.02}},
          {"mixamorig:RightHand", "mixamorig:RightForeArm", {-0.65, 1.20, 0.03}},
          {"mixamorig:LeftUpLeg", "mixamorig:Hips", {0.1, 0.93, 0.01}},
          {"mixamorig:LeftLeg", "mixamorig:LeftUpLeg", {0.13, 0.51, 0.03}},
          {"mixamorig:LeftFoot", "mixamorig:LeftLeg", {0.16, 0.09, -0.01}},
          {"mixamorig:LeftToeBase", "mixamorig:LeftFoot", {0.17, 0.04, 0.12}},
          {"mixamorig:RightUpLeg", "mixamorig:Hips", {-0.1, 0.93, 0.01}},
          {"mixamorig:RightLeg", "mixamorig:RightUpLeg", {-0.12, 0.5, 0.02}},
          {"mixamorig:RightFoot", "mixamorig:RightLeg", {-0.15, 0.09, -0.02}}};
}

struct FixtureOptions {
  std::vector<FixtureJoint> joints = mixamo_joints();
  Eigen::Matrix4d armature = Eigen::Matrix4d::Identity();  // world_from_mesh
  nlohmann::json livecap;                                  // extras.livecap of the mesh when not null
  bool labels = true;
};

struct Fixture {
  std::string bytes;
  nlohmann::json document;
  std::string bin;
  std::vector<Eigen::Vector3d> welded_m;  // world, first occurrence order
  int n_file_vertices = 0;

  // The container around (possibly edited) JSON and BIN.
  static std::string pack(const nlohmann::json& document, const std::string& bin) {
    return pack_text(document.dump(), bin);
  }
  static std::string pack_text(std::string json, const std::string& bin) {
    while (json.size() % 4) json += ' ';
    auto u32 = [](size_t v) {
      const uint32_t x = static_cast<uint32_t>(v);
      return std::string(reinterpret_cast<const char*>(&x), 4);
    };
    return "glTF" + u32(2) + u32(12 + 8 + json.size() + 8 + bin.size()) + u32(json.size()) + "JSON" + json +
           u32(bin.size()) + std::string("BIN\0", 4) + bin;
  }
};

inline Fixture make_fixture(const FixtureOptions& options = {}) {
  using nlohmann::json;
  Fixture f;
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> uniform(-1, 1);
  const int n_joints = static_cast<int>(options.joints.size());
  const Eigen::Matrix4d mesh_from_world = options.armature.inverse();

  std::vector<Eigen::Matrix4d> mesh_from_joint;  // turned at random: only the position may matter
  for (const FixtureJoint& joint : options.joints) {
    Eigen::Affine3d m = Eigen::Affine3d::Identity();
    m.translate((mesh_from_world * joint.position_m.homogeneous()).head<3>());
    m.rotate(Eigen::Quaterniond(uniform(rng), uniform(rng), uniform(rng), uniform(rng)).normalized());
    mesh_from_joint.push_back(m.matrix());
  }
  auto joint_index = [&](const char* name) {
    for (int j = 0; j < n_joints; ++j) {
      if (std::strcmp(options.joints[j].name, name) == 0) return j;
    }
    return -1;
  };

  // Nodes: 0..n-1 joints, n armature, n+1 the mesh with a transform that must not count.
  std::vector<std::vector<int>> children(n_joints);
  std::vector<int> roots = {n_joints + 1};
  json nodes = json::array();
  for (int j = 0; j < n_joints; ++j) {
    const int parent = options.joints[j].parent ? joint_index(options.joints[j].parent) : -1;
    (parent < 0 ? roots : children[parent]).push_back(j);
    const Eigen::Matrix4d local =
        parent < 0 ? mesh_from_joint[j] : Eigen::Matrix4d(mesh_from_joint[parent].inverse() * mesh_from_joint[j]);
    nodes.push_back(
        {{"name", options.joints[j].name}, {"matrix", std::vector<double>(local.data(), local.data() + 16)}});
  }
  for (int j = 0; j < n_joints; ++j) {
    if (!children[j].empty()) nodes[j]["children"] = children[j];
  }
  nodes.push_back({{"name", "Armature"},
                   {"children", roots},
                   {"matrix", std::vector<double>(options.armature.data(), options.armature.data() + 16)}});
  nodes.push_back({{"name", "Body"}, {"mesh", 0}, {"skin", 0}, {"translation", {3, 4, 5}}});

  std::vector<float> positions, uvs, weights, inverse_bind;
  std::vector<uint16_t> indices;
  std::vector<uint8_t> joints, labels;
  for (int j = 0; j < n_joints; ++j) {
    const int first = static_cast<int>(positions.size() / 3);
    const int parent = options.joints[j].parent ? joint_index(options.joints[j].parent) : j;
    for (int i = 0; i < 20; ++i) {  // 16 vertices, then the last row again as a seam
      const int row = i / 4 < 4 ? i / 4 : 3, column = i % 4;
      const Eigen::Vector3d world =
          options.joints[j].position_m + Eigen::Vector3d(0.03 * (column - 1.5), 0.02 * (row - 1.5), 0.05 + 0.001 * j);
      const Eigen::Vector3d x = (mesh_from_world * world.homogeneous()).head<3>();
      for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(x[k]));
      if (i < 16) f.welded_m.push_back(world);
      uvs.insert(uvs.end(), {column / 4.f, i < 16 ? row / 8.f : 0.9f});
      joints.insert(joints.end(), {static_cast<uint8_t>(j), static_cast<uint8_t>(parent), 0, 0});
      weights.insert(weights.end(), {0.75f, 0.25f, 0, 0});
      labels.insert(labels.end(), {static_cast<uint8_t>(j % 20), 0, 0, 0});
    }
    auto quad = [&](int a, int b, int c, int d) {
      for (int i : {a, b, c, a, c, d}) indices.push_back(static_cast<uint16_t>(first + i));
    };
    for (int row = 0; row < 3; ++row) {
      for (int column = 0; column < 3; ++column)
        quad(4 * row + column, 4 * row + column + 1, 4 * row + column + 5, 4 * row + column + 4);
    }
    indices.insert(indices.end(), {static_cast<uint16_t>(first + 12), static_cast<uint16_t>(first + 16),
                                   static_cast<uint16_t>(first + 13)});  // degenerate once welded
  }
  f.n_file_vertices = static_cast<int>(positions.size() / 3);
  for (const Eigen::Matrix4d& m : mesh_from_joint) {
    const Eigen::Matrix4f inverse = m.inverse().cast<float>();
    inverse_bind.insert(inverse_bind.end(), inverse.data(), inverse.data() + 16);
  }

  json views = json::array(), accessors = json::array();
  auto append = [&](const auto& data, int component_type, const char* type, size_t per_element, size_t stride = 0) {
    while (f.bin.size() % 4) f.bin += '\0';
    const size_t size = data.size() * sizeof(data[0]);
    views.push_back({{"buffer", 0}, {"byteOffset", f.bin.size()}, {"byteLength", size}});
    if (stride) views.back()["byteStride"] = stride;
    accessors.push_back({{"bufferView", views.size() - 1},
                         {"componentType", component_type},
                         {"count", data.size() / per_element},
                         {"type", type}});
    f.bin.append(reinterpret_cast<const char*>(data.data()), size);
    return accessors.size() - 1;
  };
  json attributes;
  attributes["POSITION"] = append(positions, 5126, "VEC3", 3);
  attributes["TEXCOORD_0"] = append(uvs, 5126, "VEC2", 2);
  attributes["JOINTS_0"] = append(joints, 5121, "VEC4", 4);
  attributes["WEIGHTS_0"] = append(weights, 5126, "VEC4", 4);
  if (options.labels) attributes["_LABEL"] = append(labels, 5121, "SCALAR", 4, 4);
  const size_t index_accessor = append(indices, 5123, "SCALAR", 1);
  const size_t bind_accessor = append(inverse_bind, 5126, "MAT4", 16);
  while (f.bin.size() % 4) f.bin += '\0';

  std::vector<int> joint_list(n_joints);
  for (int j = 0; j < n_joints; ++j) joint_list[j] = j;
  f.document = {{"asset", {{"version", "2.0"}}},
                {"scene", 0},
                {"scenes", {{{"nodes", {n_joints}}}}},
                {"nodes", nodes},
                {"meshes", {{{"primitives", {{{"attributes", attributes}, {"indices", index_accessor}}}}}}},
                {"skins", {{{"joints", joint_list}, {"inverseBindMatrices", bind_accessor}}}},
                {"accessors", accessors},
                {"bufferViews", views},
                {"buffers", {{{"byteLength", f.bin.size()}}}}};
  if (!options.livecap.is_null()) f.document["meshes"][0]["extras"]["livecap"] = options.livecap;
  f.bytes = Fixture::pack(f.document, f.bin);
  return f;
}

}  // namespace livecap::test
