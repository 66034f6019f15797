// actor.glb -> Actor: bring the skinned primitives to the rest frame, weld, fold bones, build the chain.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "actor/actor.h"
#include "actor/actor_extras.h"
#include "actor/bone_names.h"
#include "actor/gltf_reader.h"
#include "actor/keypoint_anchors.h"
#include "actor/labels.h"
#include "actor/livecap_skeleton.h"
#include "actor/rest_axes.h"
#include "actor/skinned_mesh.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

class ActorBuilder {
 public:
  ActorBuilder(const std::string& bytes, const std::string& name, double height_mm)
      : file_(bytes, name), height_mm_(height_mm), extras_(read_actor_extras(file_)) {
    actor_.name = name;
    actor_.guessed_weights = extras_.guessed_weights;
    actor_.rough_shape = extras_.rough_shape;
  }

  Actor build() {
    const std::vector<SkinBinding> skins = read_skins(file_);
    match_bones(skins);
    raw_ = read_skinned_mesh(file_, skins, node_of_joint_[kRigRoot], actor_.notes);
    orient();
    weld();
    fold_skin();
    place_joints();
    color();
    label();
    scale_and_finish();
    for (std::string& note : actor_.notes) note = one_line(note);  // names from the file
    return std::move(actor_);
  }

 private:
  const tinygltf::Model& model() const { return file_.model(); }
  void note(const std::string& text) { actor_.notes.push_back(text); }

  void match_bones(const std::vector<SkinBinding>& skins) {
    std::vector<int> nodes;  // joints of all skins, first occurrence
    std::vector<std::string> names;
    std::vector<char> is_known(model().nodes.size(), 0);
    for (const SkinBinding& skin : skins) {
      for (int node : skin.joints) {
        if (is_known[node]) continue;
        is_known[node] = 1;
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

  // Turns the subject to +X left, +Y up, +Z front when the file has it otherwise.
  void orient() {
    RigPositions at{};
    for (int j = 0; j < kRigJointCount; ++j) {
      if (node_of_joint_[j] < 0) continue;
      at[j] = raw_.joint_world[node_of_joint_[j]];
      if (!at[j].allFinite()) file_.fail("bone \"" + model().nodes[node_of_joint_[j]].name + "\" has no bind pose");
    }
    const std::optional<Eigen::Matrix3d> axes = rest_from_file_axes(at);
    if (!axes) file_.fail("hips, shoulders and neck coincide: the bind pose has no orientation");
    const Eigen::Matrix3d& turn = *axes;
    if (!turn.isIdentity(1e-9)) {
      note("the subject does not stand upright facing +Z; turned by a multiple of 90 degrees");
      for (Eigen::Vector3d& x : raw_.positions) x = turn * x;
      for (Eigen::Vector3d& x : raw_.joint_world) x = turn * x;
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
    for (std::vector<Eigen::Vector3d>* points : {&raw_.positions, &raw_.joint_world}) {
      for (Eigen::Vector3d& x : *points) x *= mm_per_unit;
    }
    for (const Eigen::Vector3d& x : raw_.positions) require_near(x, "a vertex");
    for (int node : node_of_joint_) {
      if (node >= 0) require_near(raw_.joint_world[node], "bone \"" + model().nodes[node].name + "\"");
    }
  }

  // Transforms of large numbers, one behind the other, leave what a float can hold, and then that there are numbers.
  void require_near(const Eigen::Vector3d& mm, const std::string& what) const {
    constexpr double kFarthestMm = 1e7;
    if (!mm.allFinite() || mm.cwiseAbs().maxCoeff() >= kFarthestMm)
      file_.fail(what +
                 format(" is at %g, %g, %g m, must be within 10 km", mm.x() / 1000, mm.y() / 1000, mm.z() / 1000));
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
                          : raw_.atlas.place(raw_.tiles[i], raw_.uvs[i][0], raw_.uvs[i][1]);
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
      joints_[j] = found_[j] ? raw_.joint_world[node_of_joint_[j]] : Eigen::Vector3d::Zero().eval();
    }
    if (!found_[kRigChest])
      joints_[kRigChest] = (1 - kChestHeight) * joints_[kRigRoot] + kChestHeight * joints_[kRigNeck];
    bool bends = false;  // else the arms would turn and the skin of the chest stay behind
    for (size_t k = 0; k < actor_.skin.bones.size(); ++k)
      bends = bends || (actor_.skin.bones[k] == kRigChest && actor_.skin.weights[k] > 0);
    if (!bends) note("chest: no bone with skin between pelvis and neck; the trunk does not bend");
    for (int side = 0; side < 2; ++side) {
      const int clavicle = side == 0 ? kRigLeftClavicle : kRigRightClavicle;
      if (found_[clavicle]) continue;
      const int shoulder = side == 0 ? kRigLeftShoulder : kRigRightShoulder;
      joints_[clavicle] = joints_[kRigNeck] + 0.2 * (joints_[shoulder] - joints_[kRigNeck]);
      note(std::string(kRigJointNames[clavicle]) + ": no bone; placed between neck and shoulder");
    }
    for (const auto& [name, limits] : extras_.limits_deg) used_limits_.emplace(name, limits);
    actor_.skeleton = build_livecap_skeleton(joints_, bends, used_limits_, actor_.notes);
    for (const auto& [name, limits] : used_limits_) {
      const bool known = std::any_of(actor_.skeleton.dofs.begin(), actor_.skeleton.dofs.end(),
                                     [&name = name](const Dof& d) { return d.name == name; });
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
    if (raw_.has_image || (!has_vertex_colors && raw_.atlas.n_tiles() > 0)) {
      actor_.texture = raw_.atlas.build();
      if (raw_.atlas.n_tiles() > 1)
        note(format("%d textures or colours packed into one %d x %d texture", raw_.atlas.n_tiles(),
                    actor_.texture.width, actor_.texture.height));
      if (!raw_.has_image) note("no texture; material colours are used");
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
    constexpr uint8_t kDefault[kRigBoneCount] = {5, 5, 13, 5, 5, 14, 5, 5, 15, 9, 9, 18, 9, 9, 19};
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
    if (raw_.n_bad_labels > 0)
      note(format("%d _LABEL values outside 0..%d count as background", raw_.n_bad_labels, kLabelCount - 1));
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
  ActorExtras extras_;
  Actor actor_;
  std::array<int, kRigJointCount> node_of_joint_{};
  SkinnedMesh raw_;
  std::vector<size_t> first_raw_;  // [n_vertices] first file vertex of each
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
