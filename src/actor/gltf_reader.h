// A GLB file read with suspicion: tinygltf parses it, this class checks every index, range and stride before a byte is
// used. Whatever is wrong becomes an IoError "FILE: what". Private to the actor room.
#pragma once

#include <tiny_gltf.h>

#include <Eigen/Core>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "base/image_rgb.h"

namespace livecap {

// Of one picture, and of what is put together from several.
inline constexpr int64_t kMaxTexturePixels = 1 << 28;

class GltfReader {
 public:
  // Keeps a copy of what it needs. Throws IoError.
  GltfReader(const std::string& bytes, std::string name);

  const tinygltf::Model& model() const { return model_; }
  const nlohmann::json& document() const { return document_; }  // for `extras`, which tinygltf would retype

  [[noreturn]] void fail(const std::string& what) const;

  // Accessor `index` as doubles, [count*components], normalised integers expanded. `what` names it in messages.
  // Throws unless it has `components` components and, where expected_count >= 0, that many elements.
  std::vector<double> read(int index, int components, int64_t expected_count, const std::string& what) const;

  // The same for unsigned integers (indices, joints). Throws for float data.
  std::vector<uint32_t> read_unsigned(int index, int components, int64_t expected_count, const std::string& what) const;

  // Number of components of an accessor's element.
  int components_of(int index, const std::string& what) const;
  int64_t count_of(int index, const std::string& what) const;

  // Parent of each node, -1 for roots. The hierarchy was checked to be a forest.
  const std::vector<int>& parents() const { return parents_; }

  // world_from_node of the file's default pose.
  Eigen::Matrix4d node_world(int node) const;

  // Where each of the n vertices of a primitive looks into the base colour texture of its material, the texture's
  // KHR_texture_transform applied. Empty where the primitive does not say.
  std::vector<Eigen::Vector2d> texture_coordinates(const tinygltf::Primitive& primitive, int64_t n,
                                                   const std::string& what) const;

  // Decodes an embedded PNG or JPEG of at most kMaxTexturePixels.
  ImageRgb decode_image(int index) const;

 private:
  struct View {
    const uint8_t* data;
    size_t count, stride;
    int components, component_type;
    bool normalized;
  };
  View view(int index, const std::string& what) const;
  // Bytes of a buffer view after checking that it lies within its buffer.
  std::pair<const uint8_t*, size_t> buffer_view_bytes(int index, const std::string& what) const;
  void check_container(const std::string& bytes);
  void check_nodes();

  std::string name_;
  tinygltf::Model model_;
  nlohmann::json document_;
  std::vector<int> parents_;
};

}  // namespace livecap
