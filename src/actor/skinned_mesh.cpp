#include "actor/skinned_mesh.h"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>

#include "actor/actor.h"
#include "actor/labels.h"
#include "actor/rest_axes.h"
#include "base/text.h"

namespace livecap {
namespace {

// Seams at most quadruple a template; this only keeps absurd files from being processed at length.
constexpr size_t kMostInFile = 8 * static_cast<size_t>(kMaxVertices);  // vertices, and triangles
constexpr int kMostSkinSets = 16;

class SkinnedMeshReader {
 public:
  SkinnedMeshReader(const GltfReader& file, const std::vector<SkinBinding>& skins, int root_node,
                    std::vector<std::string>& notes)
      : file_(file), skins_(skins), root_node_(root_node), notes_(notes) {}

  SkinnedMesh read() {
    raw_.joint_world.assign(model().nodes.size(), Eigen::Vector3d::Constant(std::nan("")));
    int n_unskinned = 0;
    for (size_t n = 0; n < model().nodes.size(); ++n) {
      const tinygltf::Node& node = model().nodes[n];
      if (node.mesh < 0) continue;
      if (static_cast<size_t>(node.mesh) >= model().meshes.size())
        file_.fail(format("nodes[%zu].mesh is %d, there are %zu", n, node.mesh, model().meshes.size()));
      if (node.skin < 0) {
        ++n_unskinned;
        continue;
      }
      if (static_cast<size_t>(node.skin) >= skins_.size())
        file_.fail(format("nodes[%zu].skin is %d, there are %zu", n, node.skin, skins_.size()));
      const Eigen::Matrix4d world = placed_skin(node.skin);
      const tinygltf::Mesh& mesh = model().meshes[node.mesh];
      for (size_t p = 0; p < mesh.primitives.size(); ++p)
        read_primitive(mesh.primitives[p], node.skin, world, format("meshes[%d].primitives[%zu]", node.mesh, p));
    }
    if (raw_.positions.empty()) file_.fail("has no mesh bound to a skin");
    if (n_unskinned > 0) note(format("%d meshes without a skin ignored", n_unskinned));
    return std::move(raw_);
  }

 private:
  const tinygltf::Model& model() const { return file_.model(); }
  void note(const std::string& text) { notes_.push_back(text); }

  // world_from_mesh of a skin; the first time its joints are placed as well.
  const Eigen::Matrix4d& placed_skin(int s) {
    const auto [placed, is_new] = world_of_skin_.try_emplace(s);
    if (!is_new) return placed->second;
    placed->second = world_from_mesh(s);
    const SkinBinding& skin = skins_[s];
    for (size_t j = 0; j < skin.joints.size(); ++j) {
      Eigen::Vector3d& position = raw_.joint_world[skin.joints[j]];
      if (std::isnan(position.x())) position = (placed->second * skin.mesh_from_joint[j]).topRightCorner<3, 1>();
    }
    return placed->second;
  }

  // world_from_mesh of a skin: what the default pose of its root bone does to the bind pose. The mesh node's own
  // transform does not count (glTF 2.0, section 3.7.3.3).
  Eigen::Matrix4d world_from_mesh(int s) {
    const SkinBinding& skin = skins_[s];
    int reference = 0;
    for (size_t j = 0; j < skin.joints.size(); ++j) {
      if (skin.joints[j] == root_node_) reference = static_cast<int>(j);
    }
    auto motion = [&](size_t j) -> Eigen::Matrix4d {
      return file_.node_world(skin.joints[j]) * skin.mesh_from_joint[j].inverse();
    };
    Eigen::Matrix4d world = motion(reference);
    double disagreement = 0;
    for (size_t j = 0; j < skin.joints.size(); ++j) disagreement = std::max(disagreement, (motion(j) - world).norm());
    if (!(disagreement < 1e-3 * world.norm())) {
      // The file's default pose is not the bind pose. Its scale and axes still tell how the mesh stands in the world.
      const double scale = std::cbrt(std::abs(world.topLeftCorner<3, 3>().determinant()));
      world.topLeftCorner<3, 3>() = scale * nearest_axis_rotation(world.topLeftCorner<3, 3>() / scale);
      world.topRightCorner<3, 1>().setZero();
      note("the file's default pose differs from its bind pose; the bind pose is used");
    }
    return world;
  }

  void read_primitive(const tinygltf::Primitive& primitive, int s, const Eigen::Matrix4d& world,
                      const std::string& what) {
    if (primitive.mode != -1 && primitive.mode != TINYGLTF_MODE_TRIANGLES) {
      note(what + " is not a triangle list; ignored");
      return;
    }
    auto attribute = [&](const std::string& name) {
      const auto found = primitive.attributes.find(name);
      return found == primitive.attributes.end() ? -1 : found->second;
    };
    auto named = [&](const std::string& name) { return what + "." + name; };
    if (attribute("POSITION") < 0) file_.fail(named("POSITION") + " is missing");
    if (attribute("JOINTS_0") < 0 || attribute("WEIGHTS_0") < 0) file_.fail(what + " has no JOINTS_0 / WEIGHTS_0");
    const std::vector<double> positions = file_.read(attribute("POSITION"), 3, -1, named("POSITION"));
    const int64_t n = static_cast<int64_t>(positions.size() / 3);
    const size_t first = raw_.positions.size();
    if (first + n > kMostInFile) file_.fail(format("more than %zu vertices", kMostInFile));

    for (int64_t i = 0; i < n; ++i) {
      const Eigen::Vector3d x(positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]);
      raw_.positions.push_back((world * x.homogeneous()).head<3>());
      raw_.keys.push_back({x.x() + 0.0, x.y() + 0.0, x.z() + 0.0});  // -0 and 0 are one place
      raw_.skins.push_back(s);
    }
    raw_.influences.resize(first + n);
    for (int set = 0;
         attribute("JOINTS_" + std::to_string(set)) >= 0 && attribute("WEIGHTS_" + std::to_string(set)) >= 0; ++set) {
      const std::string k = std::to_string(set);
      if (set == kMostSkinSets) file_.fail(named("JOINTS_" + k) + format(": at most %d sets", kMostSkinSets));
      const std::vector<uint32_t> joints = file_.read_unsigned(attribute("JOINTS_" + k), 4, n, named("JOINTS_" + k));
      const std::vector<double> weights = file_.read(attribute("WEIGHTS_" + k), 4, n, named("WEIGHTS_" + k));
      for (int64_t i = 0; i < 4 * n; ++i) {
        if (weights[i] <= 0) continue;
        if (joints[i] >= skins_[s].joints.size())
          file_.fail(named("JOINTS_" + k) +
                     format(" holds bone %u, the skin has %zu", joints[i], skins_[s].joints.size()));
        raw_.influences[first + i / 4].push_back({skins_[s].joints[joints[i]], weights[i]});
      }
    }

    raw_.labels.resize(first + n, -1);
    if (const int index = attribute("_LABEL"); index >= 0) {
      const std::vector<double> labels = file_.read(index, 1, n, named("_LABEL"));
      for (int64_t i = 0; i < n; ++i) {
        const double id = std::round(labels[i]);
        if (id < 0 || id >= kLabelCount) ++raw_.n_bad_labels;
        raw_.labels[first + i] = id >= 0 && id < kLabelCount ? static_cast<int>(id) : 0;
      }
    }

    raw_.tiles.resize(first + n, read_material(primitive.material));
    raw_.uvs.resize(first + n, {0, 0});
    const std::vector<Eigen::Vector2d> uvs = file_.texture_coordinates(primitive, n, what);
    for (size_t i = 0; i < uvs.size(); ++i) raw_.uvs[first + i] = {uvs[i].x(), uvs[i].y()};
    raw_.colors.resize(first + n, {-1, -1, -1});
    if (const int index = attribute("COLOR_0"); index >= 0) {
      const int components = file_.components_of(index, named("COLOR_0"));
      if (components != 3 && components != 4) file_.fail(named("COLOR_0") + format(" has %d components", components));
      const std::vector<double> colors = file_.read(index, components, n, named("COLOR_0"));
      for (int64_t i = 0; i < n; ++i) {
        for (int k = 0; k < 3; ++k) raw_.colors[first + i][k] = encode_srgb(colors[components * i + k]);
      }
    }

    std::vector<uint32_t> indices;
    if (primitive.indices >= 0) {
      indices = file_.read_unsigned(primitive.indices, 1, -1, named("indices"));
    } else {
      for (int64_t i = 0; i < n; ++i) indices.push_back(static_cast<uint32_t>(i));
    }
    if (indices.size() % 3 != 0)
      file_.fail(named("indices") + format(" has %zu entries, not a multiple of 3", indices.size()));
    if (raw_.triangles.size() + indices.size() > 3 * kMostInFile)
      file_.fail(format("more than %zu triangles", kMostInFile));
    const bool mirrored = world.topLeftCorner<3, 3>().determinant() < 0;
    for (size_t t = 0; t < indices.size(); t += 3) {
      for (int k : {0, mirrored ? 2 : 1, mirrored ? 1 : 2}) {
        if (indices[t + k] >= n)
          file_.fail(named("indices") +
                     format(" holds %u, there are %lld vertices", indices[t + k], static_cast<long long>(n)));
        raw_.triangles.push_back(static_cast<uint32_t>(first + indices[t + k]));
      }
    }
  }

  // The atlas tile of a material; -1: no texture and no colour.
  int read_material(int material) {
    if (material < 0 || static_cast<size_t>(material) >= model().materials.size()) return -1;
    const auto& pbr = model().materials[material].pbrMetallicRoughness;
    const int texture = pbr.baseColorTexture.index;
    int key = -1 - material, image = -1;  // a plain colour is keyed by its material
    if (texture >= 0 && static_cast<size_t>(texture) < model().textures.size()) {
      image = model().textures[texture].source;
      key = image;
      if (image < 0) {
        note(format("materials[%d] uses a texture format that is not supported; its colour is used", material));
        key = -1 - material;
      }
    }
    int tile = -1;
    if (const auto known = tile_of_.find(key); known != tile_of_.end()) {
      tile = known->second;
    } else if (image >= 0) {
      tile = tile_of_[key] = raw_.atlas.add(file_.decode_image(image));
      raw_.has_image = true;
    } else {
      std::array<uint8_t, 3> rgb = {255, 255, 255};
      for (size_t k = 0; k < 3 && k < pbr.baseColorFactor.size(); ++k)
        rgb[k] = static_cast<uint8_t>(std::lround(255 * encode_srgb(pbr.baseColorFactor[k])));
      tile = tile_of_[key] = raw_.atlas.add_color(rgb);
    }
    const TextureAtlas& atlas = raw_.atlas;
    if (atlas.width() * atlas.height() > kMaxTexturePixels)
      file_.fail(format("the textures of all materials side by side are %lld x %lld pixels, too large",
                        static_cast<long long>(atlas.width()), static_cast<long long>(atlas.height())));
    return tile;
  }

  const GltfReader& file_;
  const std::vector<SkinBinding>& skins_;
  const int root_node_;
  std::vector<std::string>& notes_;
  SkinnedMesh raw_;
  std::map<int, int> tile_of_;
  std::map<int, Eigen::Matrix4d> world_of_skin_;
};

}  // namespace

std::vector<SkinBinding> read_skins(const GltfReader& file) {
  const tinygltf::Model& model = file.model();
  std::vector<SkinBinding> skins;
  for (size_t s = 0; s < model.skins.size(); ++s) {
    const tinygltf::Skin& skin = model.skins[s];
    const std::string what = format("skins[%zu]", s);
    SkinBinding binding;
    for (int joint : skin.joints) {
      if (joint < 0 || static_cast<size_t>(joint) >= model.nodes.size())
        file.fail(what + format(".joints holds %d, there are %zu nodes", joint, model.nodes.size()));
      binding.joints.push_back(joint);
    }
    std::vector<double> inverse_bind;
    if (skin.inverseBindMatrices >= 0)
      inverse_bind = file.read(skin.inverseBindMatrices, 16, -1, what + ".inverseBindMatrices");
    if (!inverse_bind.empty() && inverse_bind.size() < 16 * binding.joints.size())
      file.fail(what + format(".inverseBindMatrices has %zu matrices for %zu joints", inverse_bind.size() / 16,
                              binding.joints.size()));
    for (size_t j = 0; j < binding.joints.size(); ++j) {
      Eigen::Matrix4d inverse = Eigen::Matrix4d::Identity();
      if (!inverse_bind.empty()) inverse = Eigen::Map<const Eigen::Matrix4d>(inverse_bind.data() + 16 * j);
      inverse.row(3) << 0, 0, 0, 1;
      const Eigen::FullPivLU<Eigen::Matrix4d> lu(inverse);
      if (!(std::abs(inverse.determinant()) > 1e-18) || !lu.isInvertible())
        file.fail(what + format(".inverseBindMatrices[%zu] is singular", j));
      binding.mesh_from_joint.push_back(lu.inverse());
    }
    skins.push_back(std::move(binding));
  }
  if (skins.empty() || skins[0].joints.empty())
    file.fail("has no skin: an actor needs a rigged mesh (bones and weights)");
  return skins;
}

SkinnedMesh read_skinned_mesh(const GltfReader& file, const std::vector<SkinBinding>& skins, int root_node,
                              std::vector<std::string>& notes) {
  return SkinnedMeshReader(file, skins, root_node, notes).read();
}

}  // namespace livecap
