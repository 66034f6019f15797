// A built-in actor as the data sets publish their templates: Skeletool skeleton and skin beside a textured .obj, with
// the names and the tree of DeepCap's skeletons, in a world of its own (mm, z up). Posed by hand, not by the program.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "base/text.h"
#include "image/image_io.h"
#include "synth/actor_model.h"

namespace livecap::test {

struct SkeletoolJoint {
  std::string name;
  bool revolute = true;
  int parent = -1;
  Eigen::Vector3d offset = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
};

class SkeletoolTemplate {
 public:
  explicit SkeletoolTemplate(const std::string& name = "trousers") : model(synth::build_actor(name, 1700, 3000)) {
    world_from_model.linear() << 1, 0, 0, 0, 0, -1, 0, 1, 0;
    world_from_model.translation() = Eigen::Vector3d(200, -50, 30);
    add_bones();
    bind();
  }

  // Every joint's frame in the world: the lines of the file multiplied out. value: [n_joints] angle or way.
  std::vector<Eigen::Isometry3d> frames(const std::vector<double>& value) const {
    std::vector<Eigen::Isometry3d> result;
    for (size_t i = 0; i < joints.size(); ++i) {
      const SkeletoolJoint& joint = joints[i];
      Eigen::Isometry3d frame = joint.parent < 0 ? Eigen::Isometry3d::Identity() : result[joint.parent];
      frame.translate(joint.offset);
      if (joint.revolute)
        frame.rotate(Eigen::AngleAxisd(value[i], joint.axis));
      else
        frame.translate(value[i] * joint.axis);
      result.push_back(frame);
    }
    return result;
  }

  // The value of each joint for the file's parameters: two joints of the trunk share one.
  std::vector<double> joint_values(const std::vector<double>& parameters) const {
    std::vector<double> value(joints.size(), 0);
    for (size_t p = 0; p < dofs.size(); ++p)
      for (const auto& [joint, weight] : dofs[p]) value[joint] += weight * parameters[p];
    return value;
  }

  // Dual quaternion skinning of a vertex of the model, world, by the joints that the skin's bones end in.
  Eigen::Vector3d posed(int vertex, const std::vector<Eigen::Isometry3d>& frame) const {
    const std::vector<Eigen::Isometry3d>& rest = zero_frames_;
    Eigen::Vector4d real = Eigen::Vector4d::Zero(), dual = real, first = real;
    for (const auto& [bone, weight] : weights[vertex]) {
      const int joint = last_joint.at(bones[bone]);
      const Eigen::Isometry3d motion = frame[joint] * rest[joint].inverse();
      const Eigen::Quaterniond q(motion.linear());
      const Eigen::Vector3d t = motion.translation();
      const Eigen::Quaterniond d = Eigen::Quaterniond(0, t.x() / 2, t.y() / 2, t.z() / 2) * q;
      Eigen::Vector4d r(q.w(), q.x(), q.y(), q.z()), s(d.w(), d.x(), d.y(), d.z());
      if (first.isZero()) first = r;
      const double sign = first.dot(r) < 0 ? -1 : 1;
      real += sign * weight * r;
      dual += sign * weight * s;
    }
    dual /= real.norm();
    real /= real.norm();
    const Eigen::Quaterniond q(real[0], real[1], real[2], real[3]), d(dual[0], dual[1], dual[2], dual[3]);
    return q * (world_from_model * model.surface.vertices[vertex]) + 2 * (d * q.conjugate()).vec();
  }

  std::string skeleton() const {
    std::string text = format("Skeletool Skeleton Definition V1.0\njoints: %zu\n", joints.size());
    for (const SkeletoolJoint& joint : joints)
      text += format("  %-20s %s %-20s %.9g %.9g %.9g %.9g %.9g %.9g 1.0\n", joint.name.c_str(),
                     joint.revolute ? "revolute " : "prismatic",
                     joint.parent < 0 ? "none" : joints[joint.parent].name.c_str(), joint.offset.x(), joint.offset.y(),
                     joint.offset.z(), joint.axis.x(), joint.axis.y(), joint.axis.z());
    text += markers_ + "scaling joints: 0\n" + format("dofs: %zu\n", dofs.size());
    for (size_t p = 0; p < dofs.size(); ++p) {
      text += format("  dof_%zu %zu\n      %s\n", p, dofs[p].size(), p < 3 ? "nolimits" : "limits -2 2");
      for (const auto& [joint, weight] : dofs[p]) text += format("      %s %g\n", joints[joint].name.c_str(), weight);
    }
    return text;
  }

  // The file's vertices: one that no triangle uses, the model's first one twice, and the others.
  size_t n_file_vertices() const { return model.surface.vertices.size() + 2; }
  int model_vertex(size_t file_vertex) const { return std::max(static_cast<int>(file_vertex) - 2, 0); }

  std::string skin() const {
    std::string text = "Skeletool character skinning file V1.0\nbones:\n   ";
    for (const std::string& bone : bones) text += " " + bone;
    text += "\nvertex weights:\n";
    for (size_t i = 0; i < n_file_vertices(); ++i) {
      text += format("  %5zu  ", i);
      for (const auto& [bone, weight] : weights[model_vertex(i)]) text += format(" %3d %.9g", bone, weight);
      text += "\n";
    }
    return text;
  }

  std::string obj() const {
    std::string text = "mtllib template.mtl\n";
    for (size_t i = 0; i < n_file_vertices(); ++i) {
      const Eigen::Vector3d p =
          world_from_model * model.surface.vertices[model_vertex(i)] + Eigen::Vector3d(i == 0 ? 0.5 : 0, 0, 0);
      text += format("v %.9g %.9g %.9g\n", p.x(), p.y(), p.z());
    }
    for (const Eigen::Vector2d& uv : model.atlas.uvs) text += format("vt %.9g %.9g\n", uv.x(), 1 - uv.y());
    bool doubled = false;
    for (const auto& t : model.atlas.triangles) {
      text += "f";
      for (int k = 0; k < 3; ++k) {
        int vertex = model.atlas.vertex[t[k]] + 3;  // in the file, from 1
        if (vertex == 3 && !doubled) {
          vertex = 2;
          doubled = true;
        }
        text += format(" %d/%d", vertex, t[k] + 1);
      }
      text += "\n";
    }
    return text;
  }

  std::string labels() const {
    std::string text;
    for (size_t i = 0; i < n_file_vertices(); ++i) text += format("%d\n", model.labels[model_vertex(i)]);
    return text;
  }

  static std::string motion(const std::vector<int>& numbers, const std::vector<std::vector<double>>& parameters) {
    std::string text = "Skeletool Motion File V1.0\n";
    for (size_t i = 0; i < numbers.size(); ++i) {
      text += format("%d", numbers[i]);
      for (double p : parameters[i]) text += format(" %.12g", p);
      text += "\n";
    }
    return text;
  }

  // Writes template.skeleton, .skin, .obj, .mtl, .png and segmentation.txt.
  void write(const std::filesystem::path& folder) const {
    std::filesystem::create_directories(folder);
    write_file_atomically(folder / "template.skeleton", skeleton());
    write_file_atomically(folder / "template.skin", skin());
    write_file_atomically(folder / "template.obj", obj());
    write_file_atomically(folder / "template.mtl", "newmtl body\nmap_Kd template.png\n");
    write_png(model.texture, folder / "template.png");
    write_file_atomically(folder / "segmentation.txt", labels());
  }

  synth::ActorModel model;
  Eigen::Isometry3d world_from_model = Eigen::Isometry3d::Identity();
  std::vector<SkeletoolJoint> joints;
  std::vector<std::vector<std::pair<int, double>>> dofs;     // joint, weight
  std::vector<std::string> bones;                            // of the skin
  std::map<std::string, int> last_joint;                     // of each bone
  std::vector<std::vector<std::pair<int, double>>> weights;  // [n_vertices] of the model; bone, weight

 private:
  Eigen::Vector3d at(const std::string& mixamo) const { return world_from_model * model.joints[model_bone(mixamo)]; }
  static int model_bone(const std::string& mixamo) {
    for (int i = 0; i < synth::kBoneCount; ++i)
      if (synth::kBones[i].name == mixamo) return i;
    return -1;
  }

  // axes: of its joints, in order; "t" and "e": one joint about x, called as twists and end effectors are.
  void add_bone(const std::string& name, const std::string& parent, const Eigen::Vector3d& place,
                const std::string& axes) {
    int above = parent.empty() ? -1 : last_joint.at(parent);
    Eigen::Vector3d offset = parent.empty() ? place : Eigen::Vector3d(place - place_.at(parent));
    for (char axis : axes) {
      const bool end = axis == 't' || axis == 'e';
      const int k = end ? 0 : axis - 'x';
      const std::string suffix = axis == 't' ? "_twist" : axis == 'e' ? "_ee" : std::string("_r") + axis;
      joints.push_back({name + suffix, true, above, offset, Eigen::Vector3d::Unit(k)});
      above = static_cast<int>(joints.size()) - 1;
      offset.setZero();
    }
    bones.push_back(name);
    place_[name] = place;
    last_joint[name] = above;
  }

  void add_bones() {
    const Eigen::Vector3d up = world_from_model.linear() * Eigen::Vector3d(0, 1, 0);
    for (int k = 0; k < 3; ++k)
      joints.push_back({std::string("root_t") + "xyz"[k], false, k - 1,
                        k == 0 ? at("Spine1") : Eigen::Vector3d(0, 0, 0), Eigen::Vector3d::Unit(k)});
    for (int k = 0; k < 3; ++k)
      joints.push_back({std::string("root_r") + "zyx"[k], true, k + 2, {0, 0, 0}, Eigen::Vector3d::Unit(2 - k)});
    bones.push_back("root");
    place_["root"] = at("Spine1");
    last_joint["root"] = 5;
    add_bone("spine_3", "root", at("Spine1"), "yzx");
    add_bone("spine_4", "spine_3", at("Spine2"), "yzx");
    add_bone("neck_1", "spine_4", at("Neck"), "yzx");
    add_bone("neck_2", "neck_1", at("Head"), "x");
    add_bone("head_ee", "neck_2", at("Head") + 180 * up, "y");
    for (const auto& [side, mixamo] : {std::pair{std::string("left_"), std::string("Left")}, {"right_", "Right"}}) {
      const Eigen::Vector3d elbow = at(mixamo + "ForeArm"), wrist = at(mixamo + "Hand");
      add_bone(side + "clavicle", "spine_4", at(mixamo + "Shoulder"), "yz");
      add_bone(side + "shoulder", side + "clavicle", at(mixamo + "Arm"), "zxy");
      add_bone(side + "elbow", side + "shoulder", elbow, "x");
      add_bone(side + "lowarm", side + "elbow", elbow, "t");  // at one place with the elbow
      add_bone(side + "hand", side + "lowarm", wrist, "xy");
      add_bone(side + "ee", side + "hand", wrist + 0.4 * (wrist - elbow), "x");
    }
    add_bone("spine_2", "root", at("Spine"), "yzx");
    add_bone("spine_1", "spine_2", at("Hips"), "yzx");
    for (const auto& [side, mixamo] : {std::pair{std::string("left_"), std::string("Left")}, {"right_", "Right"}}) {
      add_bone(side + "hip", "spine_1", at(mixamo + "UpLeg"), "xzy");
      add_bone(side + "knee", side + "hip", at(mixamo + "Leg"), "x");
      add_bone(side + "ankle", side + "knee", at(mixamo + "Foot"), "xy");
      add_bone(side + "toes", side + "ankle", at(mixamo + "ToeBase"), "x");
      add_bone(side + "foot", side + "toes", at(mixamo + "ToeBase") + Eigen::Vector3d(0, -60, 0), "e");
    }
    std::map<std::string, int> index;
    for (size_t i = 0; i < joints.size(); ++i) index[joints[i].name] = static_cast<int>(i);
    for (size_t i = 0; i < joints.size(); ++i)
      if (joints[i].name != "spine_4_rx") dofs.push_back({{static_cast<int>(i), 1.0}});
    for (auto& dof : dofs)
      if (joints[dof[0].first].name == "spine_3_rx") dof = {{index["spine_3_rx"], 0.4}, {index["spine_4_rx"], 0.6}};
    zero_frames_ = frames(std::vector<double>(joints.size(), 0));

    const auto marker = [&](const char* name, int vertex) {
      const Eigen::Vector3d p = world_from_model * model.surface.vertices[vertex] - place_.at("neck_2");
      return format("  %s neck_2_rx point %.9g %.9g %.9g 10 1 0 0\n", name, p.x(), p.y(), p.z());
    };
    markers_ = "markers: 4\n" + marker("nose", model.nose) + marker("left_eye", model.left_eye) +
               marker("right_eye", model.right_eye) + marker("mouth", model.chin);
  }

  // The model's weights; the farther half of a forearm follows its twist.
  void bind() {
    std::map<std::string, std::string> named = {{"Hips", "spine_1"},   {"Spine", "spine_2"}, {"Spine1", "spine_3"},
                                                {"Spine2", "spine_4"}, {"Neck", "neck_1"},   {"Head", "neck_2"}};
    for (const auto& [side, mixamo] : {std::pair{std::string("left_"), std::string("Left")}, {"right_", "Right"}}) {
      const std::pair<const char*, const char*> limbs[] = {
          {"Shoulder", "clavicle"}, {"Arm", "shoulder"}, {"ForeArm", "elbow"}, {"Hand", "hand"},
          {"UpLeg", "hip"},         {"Leg", "knee"},     {"Foot", "ankle"},    {"ToeBase", "toes"}};
      for (const auto& [theirs, ours] : limbs) named[mixamo + theirs] = side + ours;
    }
    for (size_t i = 0; i < model.surface.vertices.size(); ++i) {
      weights.emplace_back();
      for (const auto& [bone, weight] : model.weights[i]) {
        if (weight <= 0) continue;
        std::string name = named.at(synth::kBones[bone].name);
        if (name.ends_with("elbow")) {
          const std::string side = name.substr(0, name.find('_') + 1);
          const Eigen::Vector3d p = world_from_model * model.surface.vertices[i];
          if ((p - place_.at(side + "hand")).norm() < (p - place_.at(side + "elbow")).norm()) name = side + "lowarm";
        }
        const auto found = std::find(bones.begin(), bones.end(), name);
        weights.back().emplace_back(static_cast<int>(found - bones.begin()), weight);
      }
    }
  }

  std::map<std::string, Eigen::Vector3d> place_;  // of each bone at zero angles, world
  std::vector<Eigen::Isometry3d> zero_frames_;
  std::string markers_;
};

}  // namespace livecap::test
