// A built-in actor as an outsider reads it: TinyGLTF, welded by position, first occurrence first.
#pragma once

#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <Eigen/Geometry>
#include <array>
#include <map>
#include <string>
#include <vector>

namespace livecap::test {

struct GlbFile {
  tinygltf::Model model;
  std::vector<Eigen::Vector3d> vertices;      // welded, metres
  std::vector<int> first;                     // [n_vertices] file vertex of each
  std::vector<int> welded;                    // [n_file_vertices]
  std::vector<std::array<int, 3>> triangles;  // welded
  std::vector<std::array<int, 3>> file_triangles;

  template <typename T>
  std::vector<T> values(int accessor_index) const {
    const auto& accessor = model.accessors.at(accessor_index);
    const auto& view = model.bufferViews.at(accessor.bufferView);
    const unsigned char* data = model.buffers.at(view.buffer).data.data() + view.byteOffset + accessor.byteOffset;
    EXPECT_EQ(tinygltf::GetComponentSizeInBytes(accessor.componentType), static_cast<int>(sizeof(T)));
    const size_t n = accessor.count * tinygltf::GetNumComponentsInType(accessor.type);
    EXPECT_LE(view.byteOffset + accessor.byteOffset + n * sizeof(T), model.buffers[view.buffer].data.size());
    std::vector<T> result(n);
    std::memcpy(result.data(), data, n * sizeof(T));
    return result;
  }
  const tinygltf::Primitive& primitive() const { return model.meshes.at(0).primitives.at(0); }
  template <typename T>
  std::vector<T> attribute(const std::string& name) const {
    return values<T>(primitive().attributes.at(name));
  }
};

inline GlbFile read_glb(const std::string& bytes) {
  GlbFile file;
  tinygltf::TinyGLTF reader;
  std::string error, warning;
  EXPECT_TRUE(reader.LoadBinaryFromMemory(&file.model, &error, &warning,
                                          reinterpret_cast<const unsigned char*>(bytes.data()),
                                          static_cast<unsigned>(bytes.size())))
      << error;
  EXPECT_EQ(error + warning, "");
  const auto positions = file.attribute<float>("POSITION");
  std::map<std::array<float, 3>, int> ids;
  for (size_t i = 0; i < positions.size() / 3; ++i) {
    const std::array<float, 3> p{positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
    const auto [found, is_new] = ids.try_emplace(p, static_cast<int>(file.vertices.size()));
    if (is_new) {
      file.vertices.emplace_back(p[0], p[1], p[2]);
      file.first.push_back(static_cast<int>(i));
    }
    file.welded.push_back(found->second);
  }
  const auto indices = file.values<uint32_t>(file.primitive().indices);
  for (size_t t = 0; t + 2 < indices.size(); t += 3) {
    const std::array<int, 3> corners{static_cast<int>(indices[t]), static_cast<int>(indices[t + 1]),
                                     static_cast<int>(indices[t + 2])};
    file.file_triangles.push_back(corners);
    file.triangles.push_back({file.welded.at(corners[0]), file.welded.at(corners[1]), file.welded.at(corners[2])});
  }
  return file;
}

}  // namespace livecap::test
