// actor.glb -> Actor: gather the skinned primitives, bring them to the rest frame, weld, fold bones, build the chain.
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <unordered_map>

#include "actor/actor.h"
#include "actor/bone_names.h"
#include "actor/gltf_reader.h"
#include "actor/keypoint_anchors.h"
#include "actor/labels.h"
#include "actor/livecap_skeleton.h"
#include "actor/texture_atlas.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

using nlohmann::json;

// `extras.livecap` of the file, wherever an exporter put it: asset, scenes, nodes, meshes, skins.
struct Extras {
  std::map<std::string, std::string> bones;
  std::map<std::string, std::pair<double, double>> limits_deg;
  std::map<std::string, int> markers;
  std::map<std::string, Eigen::Vector3d> keypoint_offsets_m;
};

void merge_extras(const json& holder, Extras& extras, const GltfReader& file) {
  if (!holder.is_object() || !holder.contains("extras")) return;
  const json& all = holder["extras"];
  if (!all.is_object() || !all.contains("livecap")) return;
  const json& own = all["livecap"];
  if (!own.is_object()) file.fail("extras.livecap must be an object");
  auto each = [&](const char* field, auto&& take) {
    if (!own.contains(field)) return;
    if (!own[field].is_object()) file.fail(std::string("extras.livecap.") + field + " must be an object");
    for (const auto& [key, value] : own[field].items()) {
      if (!take(key, value))
        file.fail("extras.livecap." + std::string(field) + "." + key + " is " + value.dump().substr(0, 40));
    }
  };
  auto numbers = [](const json& value, size_t n) {
    return value.is_array() && value.size() == n &&
           std::all_of(value.begin(), value.end(), [](const json& v) { return v.is_number(); });
  };
  each("bones", [&](const std::string& key, const json& value) {
    return value.is_string() && (extras.bones.emplace(key, value.get<std::string>()), true);
  });
  each("limits", [&](const std::string& key, const json& value) {
    if (!numbers(value, 2) || value[0].get<double>() > value[1].get<double>()) return false;
    extras.limits_deg.emplace(key, std::pair{value[0].get<double>(), value[1].get<double>()});
    return true;
  });
  each("markers", [&](const std::string& key, const json& value) {
    if (!value.is_number_integer() || value.get<int64_t>() < 0 || value.get<int64_t>() > kMaxVertices) return false;
    extras.markers.emplace(key, value.get<int>());
    return true;
  });
  each("keypoints", [&](const std::string& key, const json& value) {
    if (!numbers(value, 3)) return false;
    extras.keypoint_offsets_m.emplace(
        key, Eigen::Vector3d(value[0].get<double>(), value[1].get<double>(), value[2].get<double>()));
    return true;
  });
}

Extras read_extras(const GltfReader& file) {
  Extras extras;
  const json& document = file.document();
  if (document.contains("asset")) merge_extras(document["asset"], extras, file);
  for (const char* list : {"scenes", "meshes", "skins", "nodes"}) {
    if (!document.contains(list) || !document[list].is_array()) continue;
    for (const json& item : document[list]) merge_extras(item, extras, file);
  }
  return extras;
}

// One vertex as the file has it, in world space (the skin's bind pose).
struct RawVertices {
  std::vector<Eigen::Vector3d> positions;   // world, metres
  std::vector<std::array<double, 3>> keys;  // raw POSITION and skin: equal keys weld
  std::vector<int> skins;
  std::vector<std::vector<std::pair<int, double>>> influences;  // node, weight
  std::vector<int> labels;                                      // -1: none
  std::vector<std::array<double, 2>> uvs;
  std::vector<int> tiles;                     // -1: no texture
  std::vector<std::array<double, 3>> colors;  // sRGB; negative: none
  std::vector<uint32_t> triangles;
};

struct SkinBinding {
  std::vector<int> joints;                       // nodes
  std::vector<Eigen::Matrix4d> mesh_from_joint;  // bind pose
};

class ActorBuilder {
 public:
  ActorBuilder(const std::string& bytes, const std::string& name, double height_mm)
      : file_(bytes, name), height_mm_(height_mm), extras_(read_extras(file_)) {
    actor_.name = name;
  }

  Actor build() {
    read_skins();
    match_bones();
    read_meshes();
    orient();
    weld();
    place_joints();
    fold_skin();
    color();
    label();
    scale_and_finish();
    return std::move(actor_);
  }

 private:
  const tinygltf::Model& model() const { return file_.model(); }
  void note(const std::string& text) { actor_.notes.push_back(text); }

  void read_skins() {
    for (size_t s = 0; s < model().skins.size(); ++s) {
      const tinygltf::Skin& skin = model().skins[s];
      const std::string what = format("skins[%zu]", s);
      SkinBinding binding;
      for (int joint : skin.joints) {
        if (joint < 0 || static_cast<size_t>(joint) >= model().nodes.size())
          file_.fail(what + format(".joints holds %d, there are %zu nodes", joint, model().nodes.size()));
        binding.joints.push_back(joint);
      }
      std::vector<double> inverse_bind;
      if (skin.inverseBindMatrices >= 0)
        inverse_bind = file_.read(skin.inverseBindMatrices, 16, -1, what + ".inverseBindMatrices");
      if (!inverse_bind.empty() && inverse_bind.size() < 16 * binding.joints.size())
        file_.fail(what + format(".inverseBindMatrices has %zu matrices for %zu joints", inverse_bind.size() / 16,
                                 binding.joints.size()));
      for (size_t j = 0; j < binding.joints.size(); ++j) {
        Eigen::Matrix4d inverse = Eigen::Matrix4d::Identity();
        if (!inverse_bind.empty()) inverse = Eigen::Map<const Eigen::Matrix4d>(inverse_bind.data() + 16 * j);
        inverse.row(3) << 0, 0, 0, 1;
        const Eigen::FullPivLU<Eigen::Matrix4d> lu(inverse);
        if (!(std::abs(inverse.determinant()) > 1e-18) || !lu.isInvertible())
          file_.fail(what + format(".inverseBindMatrices[%zu] is singular", j));
        binding.mesh_from_joint.push_back(lu.inverse());
      }
      skins_.push_back(std::move(binding));
    }
    if (skins_.empty() || skins_[0].joints.empty())
      file_.fail("has no skin: an actor needs a rigged mesh (bones and weights)");
  }

  void match_bones() {
    std::vector<int> nodes;  // joints of all skins, first occurrence
    std::vector<std::string> names;
    for (const SkinBinding& skin : skins_) {
      for (int node : skin.joints) {
        if (std::find(nodes.begin(), nodes.end(), node) != nodes.end()) continue;
        nodes.push_back(node);
        names.push_back(model().nodes[node].name);
      }
    }
    const RigMatch match = match_rig(names, extras_.bones, actor_.notes);
    std::string missing;
    int n_found = 0;
    for (int j = 0; j < kRigJointCount; ++j) {
      node_of_joint_[j] = match.index[j] < 0 ? -1 : nodes[match.index[j]];
      if (!rig_joint_required(j)) continue;
      if (node_of_joint_[j] >= 0)
        ++n_found;
      else
        missing += (missing.empty() ? "" : ", ") + std::string(kRigJointNames[j]);
    }
    if (n_found == 0)
      file_.fail(format("none of the %zu bones has a known name (Mixamo, UE/MakeHuman or extras.livecap.bones)",
                        names.size()));
    if (!missing.empty())
      file_.fail("no bone found for " + missing + " (closest naming: " + match.table +
                 "); name them in extras.livecap.bones");
    note("bones named as in " + match.table + format(": %zu in the file", names.size()));
  }

  // world_from_mesh of a skin: what the default pose of its root bone does to the bind pose. The mesh node's own
  // transform does not count (glTF 2.0, section 3.7.3.3).
  Eigen::Matrix4d world_from_mesh(int s) {
    const SkinBinding& skin = skins_[s];
    int reference = 0;
    for (size_t j = 0; j < skin.joints.size(); ++j) {
      if (skin.joints[j] == node_of_joint_[kRigRoot]) reference = static_cast<int>(j);
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

  // The rotation among the 24 that map axes to axes which is nearest to m.
  static Eigen::Matrix3d nearest_axis_rotation(const Eigen::Matrix3d& m) {
    Eigen::Matrix3d best = Eigen::Matrix3d::Identity();
    double best_score = -1e300;
    for (int x = 0; x < 6; ++x) {
      for (int y = 0; y < 6; ++y) {
        if (x % 3 == y % 3) continue;
        Eigen::Matrix3d r;
        r.col(0) = Eigen::Vector3d::Unit(x % 3) * (x < 3 ? 1 : -1);
        r.col(1) = Eigen::Vector3d::Unit(y % 3) * (y < 3 ? 1 : -1);
        r.col(2) = r.col(0).cross(r.col(1));
        if (const double score = (r.transpose() * m).trace(); score > best_score + 1e-12) {
          best_score = score;
          best = r;
        }
      }
    }
    return best;
  }

  void read_meshes() {
    joint_world_.assign(model().nodes.size(), Eigen::Vector3d::Constant(std::nan("")));
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
      const Eigen::Matrix4d world = world_from_mesh(node.skin);
      const SkinBinding& skin = skins_[node.skin];
      for (size_t j = 0; j < skin.joints.size(); ++j) {
        Eigen::Vector3d& position = joint_world_[skin.joints[j]];
        if (std::isnan(position.x())) position = (world * skin.mesh_from_joint[j]).topRightCorner<3, 1>();
      }
      const tinygltf::Mesh& mesh = model().meshes[node.mesh];
      for (size_t p = 0; p < mesh.primitives.size(); ++p)
        read_primitive(mesh.primitives[p], node.skin, world, format("meshes[%d].primitives[%zu]", node.mesh, p));
    }
    if (raw_.positions.empty()) file_.fail("has no mesh bound to a skin");
    if (n_unskinned > 0) note(format("%d meshes without a skin ignored", n_unskinned));
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
    // Seams at most quadruple a template; this only keeps absurd files from being processed at length.
    if (first + n > 8 * static_cast<size_t>(kMaxVertices))
      file_.fail(format("more than %d vertices", 8 * kMaxVertices));

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
        if (id < 0 || id >= kLabelCount) ++n_bad_labels_;
        raw_.labels[first + i] = id >= 0 && id < kLabelCount ? static_cast<int>(id) : 0;
      }
    }

    int tile = -1;
    const std::string uv_name = read_material(primitive.material, tile);
    raw_.uvs.resize(first + n, {0, 0});
    raw_.tiles.resize(first + n, tile);
    if (const int index = attribute(uv_name); index >= 0) {
      const std::vector<double> uvs = file_.read(index, 2, n, named(uv_name));
      for (int64_t i = 0; i < n; ++i) raw_.uvs[first + i] = {uvs[2 * i], uvs[2 * i + 1]};
    }
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

  // Sets the atlas tile of a material (-1: no texture and no colour) and returns its texture coordinate attribute.
  std::string read_material(int material, int& tile) {
    if (material < 0 || static_cast<size_t>(material) >= model().materials.size()) return "TEXCOORD_0";
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
    if (const auto known = tile_of_.find(key); known != tile_of_.end()) {
      tile = known->second;
    } else if (image >= 0) {
      tile = tile_of_[key] = atlas_.add(file_.decode_image(image));
      has_image_ = true;
    } else {
      std::array<uint8_t, 3> rgb = {255, 255, 255};
      for (size_t k = 0; k < 3 && k < pbr.baseColorFactor.size(); ++k)
        rgb[k] = static_cast<uint8_t>(std::lround(255 * encode_srgb(pbr.baseColorFactor[k])));
      tile = tile_of_[key] = atlas_.add_color(rgb);
    }
    const int set = pbr.baseColorTexture.texCoord;
    return "TEXCOORD_" + std::to_string(set >= 0 && set < 8 ? set : 0);
  }

  // Turns the subject to +X left, +Y up, +Z front when the file has it otherwise.
  void orient() {
    auto at = [&](int joint) { return joint_world_[node_of_joint_[joint]]; };
    for (int j = 0; j < kRigJointCount; ++j) {
      if (node_of_joint_[j] >= 0 && !at(j).allFinite())
        file_.fail("bone \"" + model().nodes[node_of_joint_[j]].name + "\" has no bind pose");
    }
    const Eigen::Vector3d up = (at(kRigNeck) - (at(kRigLeftHip) + at(kRigRightHip)) / 2).normalized();
    Eigen::Vector3d left =
        (at(kRigLeftHip) - at(kRigRightHip)).normalized() + (at(kRigLeftShoulder) - at(kRigRightShoulder)).normalized();
    left = (left - left.dot(up) * up).normalized();
    if (!up.allFinite() || !left.allFinite())
      file_.fail("hips, shoulders and neck coincide: the bind pose has no orientation");
    Eigen::Matrix3d subject;
    subject << left, up, left.cross(up);
    const Eigen::Matrix3d turn = nearest_axis_rotation(subject).transpose();
    if (!turn.isIdentity(1e-9)) {
      note("the subject does not stand upright facing +Z; turned by a multiple of 90 degrees");
      for (Eigen::Vector3d& x : raw_.positions) x = turn * x;
      for (Eigen::Vector3d& x : joint_world_) x = turn * x;
    }
    // Millimetres, and the unit mistakes that files are known for.
    double low = 1e300, high = -1e300;
    for (const Eigen::Vector3d& x : raw_.positions) {
      low = std::min(low, x.y());
      high = std::max(high, x.y());
    }
    const double height = high - low;
    double mm_per_unit = 1000;
    if (height_mm_ <= 0 && height > 50 && height < 400) {
      mm_per_unit = 10;
      note(format("%.0f units tall: taken as centimetres", height));
    } else if (height_mm_ <= 0 && height > 500 && height < 4000) {
      mm_per_unit = 1;
      note(format("%.0f units tall: taken as millimetres", height));
    } else if (height_mm_ > 0) {
      if (!(height > 1e-9)) file_.fail("the mesh has no height");
      mm_per_unit = height_mm_ / height;
    } else if (height < 0.4 || height > 4) {
      note(format("%.3g m tall, which no person is; give --height", height));
    }
    metres_to_mm_ = mm_per_unit;
    for (Eigen::Vector3d& x : raw_.positions) x *= mm_per_unit;
    for (Eigen::Vector3d& x : joint_world_) x *= mm_per_unit;
  }

  void weld() {
    std::map<std::tuple<int, double, double, double>, int> seen;
    RenderMesh& render = actor_.render;
    for (size_t i = 0; i < raw_.positions.size(); ++i) {
      const auto key = std::tuple(raw_.skins[i], raw_.keys[i][0], raw_.keys[i][1], raw_.keys[i][2]);
      const auto [entry, is_new] = seen.try_emplace(key, actor_.mesh.n_vertices());
      if (is_new) {
        for (int k = 0; k < 3; ++k) actor_.mesh.positions.push_back(static_cast<float>(raw_.positions[i][k]));
        first_raw_.push_back(i);
      }
      render.template_vertex.push_back(entry->second);
      const auto uv = raw_.tiles[i] < 0
                          ? std::array<float, 2>{static_cast<float>(raw_.uvs[i][0]), static_cast<float>(raw_.uvs[i][1])}
                          : atlas_.place(raw_.tiles[i], raw_.uvs[i][0], raw_.uvs[i][1]);
      render.uvs.insert(render.uvs.end(), uv.begin(), uv.end());
    }
    const int n = actor_.n_vertices();
    if (n < kMinVertices || n > kMaxVertices)
      file_.fail(format("%d vertices after welding, must be %d to %d", n, kMinVertices, kMaxVertices));
    auto point = [&](int v) {
      return Eigen::Map<const Eigen::Vector3f>(actor_.mesh.positions.data() + 3 * v).cast<double>();
    };
    int n_dropped = 0;
    for (size_t t = 0; t < raw_.triangles.size(); t += 3) {
      int v[3];
      for (int k = 0; k < 3; ++k) v[k] = render.template_vertex[raw_.triangles[t + k]];
      const double area = (point(v[1]) - point(v[0])).cross(point(v[2]) - point(v[0])).norm() / 2;
      if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0] || !(area > 1e-9)) {
        ++n_dropped;
        continue;
      }
      actor_.mesh.triangles.insert(actor_.mesh.triangles.end(), v, v + 3);
      for (int k = 0; k < 3; ++k) render.triangles.push_back(static_cast<int32_t>(raw_.triangles[t + k]));
    }
    if (actor_.mesh.n_triangles() == 0) file_.fail("has no triangles");
    if (n_dropped > 0) note(format("%d degenerate triangles dropped", n_dropped));
    const int components = connected_components(n, actor_.mesh.triangles);
    if (components > 1)
      note(format("%d connected components: loose parts are not held together by the surface terms", components));
  }

  void place_joints() {
    for (int j = 0; j < kRigJointCount; ++j) {
      found_[j] = node_of_joint_[j] >= 0;
      joints_[j] = found_[j] ? joint_world_[node_of_joint_[j]] : Eigen::Vector3d::Zero().eval();
    }
    for (int side = 0; side < 2; ++side) {
      const int clavicle = side == 0 ? kRigLeftClavicle : kRigRightClavicle;
      if (found_[clavicle]) continue;
      const int shoulder = side == 0 ? kRigLeftShoulder : kRigRightShoulder;
      joints_[clavicle] = joints_[kRigNeck] + 0.2 * (joints_[shoulder] - joints_[kRigNeck]);
      note(std::string(kRigJointNames[clavicle]) + ": no bone; placed between neck and shoulder");
    }
    for (const auto& [name, limits] : extras_.limits_deg) used_limits_.emplace(name, limits);
    actor_.skeleton = build_livecap_skeleton(joints_, used_limits_, actor_.notes);
    for (const auto& [name, limits] : used_limits_) {
      const bool known = std::any_of(actor_.skeleton.dofs.begin(), actor_.skeleton.dofs.end(),
                                     [&](const Dof& d) { return d.name == name; });
      if (!known) note("extras.livecap.limits: there is no joint angle \"" + name + "\"; ignored");
    }
  }

  // Every bone of the file follows its nearest mapped ancestor; the four strongest of those stay.
  void fold_skin() {
    std::vector<int> bone_of_node(model().nodes.size(), -1);
    for (int j = 0; j < kRigBoneCount; ++j) {
      if (node_of_joint_[j] >= 0) bone_of_node[node_of_joint_[j]] = j;
    }
    auto folded = [&](int node) {
      for (int i = node; i >= 0; i = file_.parents()[i]) {
        if (bone_of_node[i] >= 0) return bone_of_node[i];
      }
      return static_cast<int>(kRigRoot);
    };
    int n_unbound = 0;
    double lost = 0;
    for (size_t raw : first_raw_) {
      std::map<int, double> total;
      for (const auto& [node, weight] : raw_.influences[raw]) total[folded(node)] += weight;
      std::vector<std::pair<int, double>> sorted(total.begin(), total.end());
      std::stable_sort(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.second > b.second; });
      double all = 0, kept = 0;
      for (size_t k = 0; k < sorted.size(); ++k) {
        all += sorted[k].second;
        if (k < kMaxInfluences) kept += sorted[k].second;
      }
      if (!(kept > 0)) {
        sorted = {{kRigRoot, 1.0}};
        all = kept = 1;
        ++n_unbound;
      }
      lost = std::max(lost, 1 - kept / all);
      for (size_t k = 0; k < kMaxInfluences; ++k) {
        const bool used = k < sorted.size();
        actor_.skin.bones.push_back(used ? sorted[k].first : 0);
        actor_.skin.weights.push_back(used ? static_cast<float>(sorted[k].second / kept) : 0.f);
      }
    }
    if (n_unbound > 0) note(format("%d vertices have no bone weights; they follow the root", n_unbound));
    if (lost > 0.01)
      note(format("only the 4 strongest bones of a vertex are kept; up to %.0f %% of weight dropped", 100 * lost));
  }

  void color() {
    const int n = actor_.n_vertices();
    const bool has_vertex_colors =
        std::any_of(raw_.colors.begin(), raw_.colors.end(), [](const auto& c) { return c[0] >= 0; });
    if (has_image_ || (!has_vertex_colors && atlas_.n_tiles() > 0)) {
      actor_.texture = atlas_.build();
      if (atlas_.n_tiles() > 1)
        note(format("%d textures or colours packed into one %d x %d texture", atlas_.n_tiles(), actor_.texture.width,
                    actor_.texture.height));
      if (!has_image_) note("no texture; material colours are used");
      actor_.colors = vertex_colors_from_texture(actor_.texture, actor_.render.uvs, actor_.render.triangles,
                                                 actor_.render.template_vertex, actor_.mesh.positions);
      return;
    }
    actor_.colors.assign(3 * n, 0.5f);
    if (!has_vertex_colors) {
      note("no texture and no COLOR_0: every vertex is grey, colour cannot guide the surface");
      return;
    }
    for (int v = 0; v < n; ++v) {
      for (int k = 0; k < 3 && raw_.colors[first_raw_[v]][0] >= 0; ++k)
        actor_.colors[3 * v + k] = static_cast<float>(raw_.colors[first_raw_[v]][k]);
    }
    note("no texture; colours from COLOR_0");
  }

  void label() {
    // LIP class of what usually covers a bone.
    constexpr uint8_t kDefault[kRigBoneCount] = {5, 13, 5, 5, 14, 5, 5, 15, 9, 9, 18, 9, 9, 19};
    int n_defaulted = 0;
    for (int v = 0; v < actor_.n_vertices(); ++v) {
      int label = raw_.labels[first_raw_[v]];
      if (label < 0) {
        label = kDefault[actor_.skin.bones[4 * v]];
        ++n_defaulted;
      }
      actor_.labels.push_back(static_cast<uint8_t>(label));
      actor_.rigidity.push_back(rigidity_of_label(label));
    }
    if (n_defaulted > 0) note(format("%d vertices without _LABEL: material guessed from their bone", n_defaulted));
    if (n_bad_labels_ > 0)
      note(format("%d _LABEL values outside 0..%d count as background", n_bad_labels_, kLabelCount - 1));
  }

  void scale_and_finish() {
    AnchorInput input;
    input.joints_mm = joints_;
    input.joint_found = found_;
    for (const auto& [name, vertex] : extras_.markers) {
      if (vertex >= actor_.n_vertices())
        file_.fail(format("extras.livecap.markers.%s is %d, the welded template has %d vertices", name.c_str(), vertex,
                          actor_.n_vertices()));
      input.marker_vertices.emplace(name, vertex);
    }
    for (const auto& [name, offset] : extras_.keypoint_offsets_m)
      input.offsets_mm.emplace(name, offset * metres_to_mm_);
    actor_.keypoints = place_keypoints(input, actor_.mesh, actor_.skin, actor_.notes);
  }

  GltfReader file_;
  double height_mm_;
  Extras extras_;
  Actor actor_;
  std::vector<SkinBinding> skins_;
  std::array<int, kRigJointCount> node_of_joint_{};
  std::vector<Eigen::Vector3d> joint_world_;  // [n_nodes] bind position; NaN for nodes that are no joints
  RawVertices raw_;
  std::vector<size_t> first_raw_;  // [n_vertices] first file vertex of each
  std::map<int, int> tile_of_;
  TextureAtlas atlas_;
  bool has_image_ = false;
  int n_bad_labels_ = 0;
  double metres_to_mm_ = 1000;
  RigPositions joints_;
  std::array<bool, kRigJointCount> found_{};
  std::map<std::string, std::pair<double, double>> used_limits_;
};

}  // namespace

Actor load_actor_bytes(const std::string& bytes, const std::string& name, double height_mm) {
  return ActorBuilder(bytes, name, height_mm).build();
}

Actor load_actor(const std::filesystem::path& path, double height_mm) {
  Actor actor = load_actor_bytes(read_file(path), path.string(), height_mm);
  actor.name = path.stem().string();
  return actor;
}

}  // namespace livecap
