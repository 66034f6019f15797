// The triangles of a glTF binary as they stand in the world, with the first texture or COLOR_0.
#include <Eigen/Geometry>
#include <utility>

#include "actor/gltf_reader.h"
#include "actor/texture_atlas.h"
#include "base/text.h"
#include "scan/fill_uvs.h"
#include "scan/scan_files.h"

namespace livecap {

namespace {

// Vertices and corners of triangles: nodes may show the same mesh again and again.
constexpr size_t kMost = size_t{1} << 25;

}  // namespace

Scan read_glb_scan(const std::filesystem::path& path, std::vector<std::string>& notes) {
  const GltfReader file(read_file(path), path.string());
  const tinygltf::Model& model = file.model();
  Scan scan;
  int image = -1;
  bool several = false, textured = false, colored = true;  // textures; some place in one
  for (size_t node = 0; node < model.nodes.size(); ++node) {
    if (model.nodes[node].mesh < 0) continue;
    if (model.nodes[node].mesh >= static_cast<int>(model.meshes.size()))
      file.fail(format("node %zu names mesh %d of %zu", node, model.nodes[node].mesh, model.meshes.size()));
    const Eigen::Matrix4d world =
        model.nodes[node].skin >= 0 ? Eigen::Matrix4d::Identity() : file.node_world(static_cast<int>(node));
    for (const tinygltf::Primitive& primitive : model.meshes[model.nodes[node].mesh].primitives) {
      const auto position = primitive.attributes.find("POSITION");
      if (position == primitive.attributes.end() || (primitive.mode != TINYGLTF_MODE_TRIANGLES && primitive.mode != -1))
        continue;
      const std::vector<double> p = file.read(position->second, 3, -1, "POSITION");
      const int64_t n = static_cast<int64_t>(p.size()) / 3;
      const int64_t n_corners = primitive.indices >= 0 ? file.count_of(primitive.indices, "indices") : n;
      if (scan.surface.vertices.size() + n > kMost || scan.uvs.size() + n_corners > kMost)
        file.fail(format("more than %zu vertices or corners of triangles", kMost));
      const int base = static_cast<int>(scan.surface.vertices.size());
      for (int64_t i = 0; i < n; ++i)
        scan.surface.vertices.push_back((world * Eigen::Vector4d(p[3 * i], p[3 * i + 1], p[3 * i + 2], 1)).head<3>());
      std::vector<uint32_t> indices;
      if (primitive.indices >= 0)
        indices = file.read_unsigned(primitive.indices, 1, -1, "indices");
      else
        for (int64_t i = 0; i < n; ++i) indices.push_back(static_cast<uint32_t>(i));
      const std::vector<Eigen::Vector2d> uv = file.texture_coordinates(primitive, n, "a primitive");
      int source = -1;
      if (primitive.material >= static_cast<int>(model.materials.size()))
        file.fail(format("a primitive names material %d of %zu", primitive.material, model.materials.size()));
      if (primitive.material >= 0) {
        const int texture = model.materials.at(primitive.material).pbrMetallicRoughness.baseColorTexture.index;
        if (texture >= 0 && texture < static_cast<int>(model.textures.size())) source = model.textures[texture].source;
      }
      if (image < 0) image = source;
      several = several || (source >= 0 && source != image);
      const bool has_uv = !uv.empty() && source >= 0;
      textured = textured || has_uv;
      if (const auto found = primitive.attributes.find("COLOR_0"); found != primitive.attributes.end()) {
        const int components = file.components_of(found->second, "COLOR_0");
        if (components < 3) file.fail(format("COLOR_0 has %d components, expected 3 or 4", components));
        const std::vector<double> c = file.read(found->second, components, n, "COLOR_0");
        for (int64_t i = 0; i < n; ++i)
          scan.colors.emplace_back(encode_srgb(c[components * i]), encode_srgb(c[components * i + 1]),
                                   encode_srgb(c[components * i + 2]));  // glTF's are linear
      } else {
        colored = false;
      }
      const bool mirrored = world.topLeftCorner<3, 3>().determinant() < 0;
      for (size_t i = 0; i + 2 < indices.size(); i += 3) {
        for (int k = 0; k < 3; ++k)
          if (indices[i + k] >= static_cast<uint64_t>(n))
            file.fail(format("a triangle names vertex %u of %lld", indices[i + k], static_cast<long long>(n)));
        if (mirrored) std::swap(indices[i + 1], indices[i + 2]);
        scan.surface.triangles.emplace_back(base + indices[i], base + indices[i + 1], base + indices[i + 2]);
        for (int k = 0; k < 3; ++k) scan.uvs.push_back(has_uv ? uv[indices[i + k]] : kNoUv);
      }
    }
  }
  if (several)
    notes.push_back(path.string() + ": more than one texture; the scan is read without them");
  else if (textured)
    scan.texture = file.decode_image(image);
  else if (image >= 0)
    notes.push_back(path.string() + ": no texture coordinates; the scan is read without its texture");
  if (scan.texture.empty()) scan.uvs.clear();
  if (!colored) scan.colors.clear();
  return scan;
}

}  // namespace livecap
