#include "meshing/actor_glb.h"

#include <tiny_gltf.h>

#include <cstring>
#include <limits>
#include <sstream>

#include "base/srgb.h"
#include "image/image_io.h"
#include "livecap/error.h"
#include "meshing/surface_parts.h"

namespace livecap::meshing {

namespace {

using Eigen::Vector3d;

class Builder {
 public:
  tinygltf::Model model;

  int add_view(const void* data, size_t bytes, int target) {
    auto& buffer = model.buffers.front().data;
    buffer.resize((buffer.size() + 3) / 4 * 4);
    tinygltf::BufferView view;
    view.buffer = 0;
    view.byteOffset = buffer.size();
    view.byteLength = bytes;
    view.target = target;
    buffer.resize(buffer.size() + bytes);
    std::memcpy(buffer.data() + view.byteOffset, data, bytes);
    model.bufferViews.push_back(view);
    return static_cast<int>(model.bufferViews.size()) - 1;
  }

  template <typename T>
  int add_accessor(const std::vector<T>& data, int component, int type, int components,
                   int target = TINYGLTF_TARGET_ARRAY_BUFFER) {
    tinygltf::Accessor accessor;
    accessor.bufferView = add_view(data.data(), data.size() * sizeof(T), target);
    accessor.componentType = component;
    accessor.type = type;
    accessor.count = data.size() / components;
    model.accessors.push_back(accessor);
    return static_cast<int>(model.accessors.size()) - 1;
  }
};

void add_bones(const ActorFile& actor, Builder& builder) {
  tinygltf::Skin skin;
  skin.name = "rig";
  std::vector<float> inverse_bind;
  const int n_bones = static_cast<int>(actor.bones.size());
  for (int bone = 0; bone < n_bones; ++bone) {
    const int parent = actor.bones[bone].parent;
    const Vector3d from = parent >= 0 ? actor.bones[parent].position_mm : Vector3d(Vector3d::Zero());
    const Vector3d offset = (actor.bones[bone].position_mm - from) / 1000;
    tinygltf::Node node;
    node.name = actor.bones[bone].name;
    node.translation = {offset.x(), offset.y(), offset.z()};
    for (int child = bone + 1; child < n_bones; ++child)
      if (actor.bones[child].parent == bone) node.children.push_back(child);
    builder.model.nodes.push_back(node);
    skin.joints.push_back(bone);
    const Vector3d at = actor.bones[bone].position_mm / 1000;
    const float matrix[16] = {1,
                              0,
                              0,
                              0,
                              0,
                              1,
                              0,
                              0,
                              0,
                              0,
                              1,
                              0,
                              static_cast<float>(-at.x()),
                              static_cast<float>(-at.y()),
                              static_cast<float>(-at.z()),
                              1};
    inverse_bind.insert(inverse_bind.end(), matrix, matrix + 16);
  }
  skin.skeleton = 0;
  skin.inverseBindMatrices =
      builder.add_accessor(inverse_bind, TINYGLTF_COMPONENT_TYPE_FLOAT, TINYGLTF_TYPE_MAT4, 16, 0);
  builder.model.skins.push_back(skin);
}

// Of an actor with a texture.
int add_material(const ActorFile& actor, Builder& builder) {
  const auto png = encode_png(actor.texture);
  tinygltf::Image image;
  image.name = "texture";
  image.mimeType = "image/png";
  image.bufferView = builder.add_view(png.data(), png.size(), 0);
  builder.model.images.push_back(image);
  tinygltf::Sampler sampler;
  sampler.magFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
  sampler.minFilter = TINYGLTF_TEXTURE_FILTER_LINEAR;
  builder.model.samplers.push_back(sampler);
  tinygltf::Texture texture;
  texture.sampler = 0;
  texture.source = 0;
  builder.model.textures.push_back(texture);
  tinygltf::Material material;
  material.name = "actor";
  material.pbrMetallicRoughness.baseColorTexture.index = 0;
  material.pbrMetallicRoughness.metallicFactor = 0;
  material.pbrMetallicRoughness.roughnessFactor = 0.9;
  builder.model.materials.push_back(material);
  return 0;
}

tinygltf::Primitive add_geometry(const ActorFile& actor, Builder& builder) {
  std::vector<float> positions, normals, uvs, weights, labels, colors;
  std::vector<uint16_t> joints;
  std::vector<uint32_t> indices;
  const auto vertex_normals = meshing::vertex_normals(actor.surface);
  std::vector<double> low(3, std::numeric_limits<double>::max()), high(3, std::numeric_limits<double>::lowest());
  for (size_t i = 0; i < actor.atlas.vertex.size(); ++i) {
    const int vertex = actor.atlas.vertex[i];
    for (int k = 0; k < 3; ++k) {
      positions.push_back(static_cast<float>(actor.surface.vertices[vertex][k] / 1000));
      normals.push_back(static_cast<float>(vertex_normals[vertex][k]));
      low[k] = std::min<double>(low[k], positions.back());
      high[k] = std::max<double>(high[k], positions.back());
    }
    for (int k = 0; k < 2; ++k) uvs.push_back(static_cast<float>(actor.atlas.uvs[i][k]));
    for (const auto& [bone, weight] : actor.weights[vertex]) {
      joints.push_back(static_cast<uint16_t>(bone));
      weights.push_back(static_cast<float>(weight));
    }
    labels.push_back(actor.labels[vertex]);
    if (actor.colors.empty()) continue;
    for (int k = 0; k < 3; ++k) colors.push_back(static_cast<float>(linear_from_srgb(actor.colors[vertex][k])));
  }
  for (const auto& t : actor.atlas.triangles)
    for (int k = 0; k < 3; ++k) indices.push_back(static_cast<uint32_t>(t[k]));

  constexpr int kFloat = TINYGLTF_COMPONENT_TYPE_FLOAT;
  tinygltf::Primitive primitive;
  primitive.mode = TINYGLTF_MODE_TRIANGLES;
  primitive.attributes["POSITION"] = builder.add_accessor(positions, kFloat, TINYGLTF_TYPE_VEC3, 3);
  builder.model.accessors.back().minValues = low;
  builder.model.accessors.back().maxValues = high;
  primitive.attributes["NORMAL"] = builder.add_accessor(normals, kFloat, TINYGLTF_TYPE_VEC3, 3);
  primitive.attributes["TEXCOORD_0"] = builder.add_accessor(uvs, kFloat, TINYGLTF_TYPE_VEC2, 2);
  primitive.attributes["JOINTS_0"] =
      builder.add_accessor(joints, TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, TINYGLTF_TYPE_VEC4, 4);
  primitive.attributes["WEIGHTS_0"] = builder.add_accessor(weights, kFloat, TINYGLTF_TYPE_VEC4, 4);
  primitive.attributes["_LABEL"] = builder.add_accessor(labels, kFloat, TINYGLTF_TYPE_SCALAR, 1);
  if (actor.texture.empty() && !colors.empty())
    primitive.attributes["COLOR_0"] = builder.add_accessor(colors, kFloat, TINYGLTF_TYPE_VEC3, 3);
  primitive.indices = builder.add_accessor(indices, TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT, TINYGLTF_TYPE_SCALAR, 1,
                                           TINYGLTF_TARGET_ELEMENT_ARRAY_BUFFER);
  return primitive;
}

}  // namespace

int ActorFile::marker_vertex(const std::string& name) const {
  for (const auto& [marker, vertex] : markers)
    if (marker == name) return vertex;
  return -1;
}

std::string actor_glb(const ActorFile& actor) {
  Builder builder;
  tinygltf::Model& model = builder.model;
  model.asset.version = "2.0";
  model.asset.generator = "LiveCap-CL";
  model.buffers.emplace_back();
  tinygltf::Mesh mesh;
  mesh.name = "actor";
  mesh.primitives.push_back(add_geometry(actor, builder));
  if (!actor.texture.empty()) mesh.primitives.back().material = add_material(actor, builder);
  tinygltf::Value::Object markers, bones;
  for (const auto& [keypoint, vertex] : actor.markers) markers[keypoint] = tinygltf::Value(vertex);
  for (const auto& [joint, bone] : actor.rig) bones[joint] = tinygltf::Value(bone);
  tinygltf::Value::Object livecap;
  if (!markers.empty()) livecap["markers"] = tinygltf::Value(markers);
  if (!bones.empty()) livecap["bones"] = tinygltf::Value(bones);
  if (actor.guessed_weights) livecap["weights"] = tinygltf::Value(std::string("guessed"));
  if (actor.rough_shape) livecap["shape"] = tinygltf::Value(std::string("rough"));
  if (!livecap.empty()) {
    mesh.extras = tinygltf::Value(tinygltf::Value::Object{{"livecap", tinygltf::Value(livecap)}});
  }
  model.meshes.push_back(mesh);
  add_bones(actor, builder);
  tinygltf::Node body;
  body.name = actor.name;
  body.mesh = 0;
  body.skin = 0;
  model.nodes.push_back(body);
  tinygltf::Scene scene;
  scene.name = "Scene";
  scene.nodes = {0, static_cast<int>(model.nodes.size()) - 1};
  model.scenes.push_back(scene);
  model.defaultScene = 0;

  std::ostringstream out;
  tinygltf::TinyGLTF writer;
  if (!writer.WriteGltfSceneToStream(&model, out, false, true)) throw LogicError("the actor cannot be written as GLB");
  return std::move(out).str();
}

}  // namespace livecap::meshing
