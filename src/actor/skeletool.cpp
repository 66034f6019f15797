#include "actor/skeletool.h"

#include <algorithm>
#include <map>
#include <numbers>

#include "actor/skeletool_lines.h"

namespace livecap {
namespace {

// More than kMaxDofs, because the root may have any number; every name is looked for among all others.
constexpr int kMaxJoints = 1024;

struct Joint {
  std::string name, parent_name;
  bool revolute = false;
  double scale = 1;  // of the offset
  int parent = -1;
  Eigen::Vector3d offset_mm = Eigen::Vector3d::Zero();
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();
};

std::vector<Joint> read_joints(SkeletoolLines& lines) {
  std::vector<Joint> joints;
  const int n = lines.section("joints");
  if (n > kMaxJoints) lines.fail(format("%d joints, at most %d", n, kMaxJoints));
  for (int i = 0; i < n; ++i) {
    lines.require(format("joint %d of %d", i + 1, n));
    if (lines.size() != 10) lines.fail("a joint needs name, type, parent, offset (3), axis (3) and scale");
    Joint joint;
    joint.name = lines.word(0);
    joint.parent_name = lines.word(2);
    if (lines.word(1) != "revolute" && lines.word(1) != "prismatic")
      lines.fail("joint type \"" + lines.word(1) + "\" is not revolute or prismatic");
    joint.revolute = lines.word(1) == "revolute";
    joint.offset_mm = {lines.number(3), lines.number(4), lines.number(5)};
    joint.scale = lines.number(9);
    joint.offset_mm *= joint.scale;
    joint.axis = {lines.number(6), lines.number(7), lines.number(8)};
    if (joint.axis.norm() < 1e-9) lines.fail("the axis of joint \"" + joint.name + "\" is zero");
    if (joint.revolute) joint.axis.normalize();
    for (const Joint& other : joints)
      if (other.name == joint.name) lines.fail("a second joint is called \"" + joint.name + "\"");
    joints.push_back(joint);
  }
  // The chain is walked in file order, as everywhere here: parents first.
  int n_roots = 0;
  for (size_t i = 0; i < joints.size(); ++i) {
    for (size_t p = 0; p < joints.size(); ++p) {
      if (joints[p].name == joints[i].parent_name) joints[i].parent = static_cast<int>(p);
    }
    if (joints[i].parent >= static_cast<int>(i))
      lines.fail("joint \"" + joints[i].name + "\" stands before its parent");
    n_roots += joints[i].parent < 0;
  }
  if (n_roots != 1) lines.fail(format("%d joints have no parent, there must be one root", n_roots));
  return joints;
}

// "left_shoulder_rx" -> "left_shoulder".
std::string bone_name(const std::string& joint) {
  const size_t size = joint.size();
  if (size > 3 && joint[size - 3] == '_' && (joint[size - 2] == 'r' || joint[size - 2] == 't') &&
      joint[size - 1] >= 'x' && joint[size - 1] <= 'z')
    return joint.substr(0, size - 3);
  return joint;
}

// Joints of one name at one place become one bone with several angles; a joint with an offset, or one that branches
// off, starts the next bone. So does one with another name: skins bind to bones by name, and a forearm's twist does not
// turn the elbow.
void build_chain(const std::vector<Joint>& joints, SkeletoolSkeleton& out, std::vector<int>& dof_of_joint,
                 std::vector<int>& root_of_joint, const SkeletoolLines& lines) {
  const int n = static_cast<int>(joints.size());
  out.bone_of_joint.assign(n, 0);
  dof_of_joint.assign(n, -1);
  root_of_joint.assign(n, -1);
  std::vector<int> last_joint;  // of each bone
  std::vector<int> n_children(n, 0);
  for (const Joint& joint : joints) {
    if (joint.parent >= 0) ++n_children[joint.parent];
  }
  bool in_root = true;
  for (int i = 0; i < n; ++i) {
    const Joint& joint = joints[i];
    out.joint_names.push_back(joint.name);
    in_root = in_root && (i == 0 || (joint.parent == i - 1 && n_children[i - 1] == 1 && joint.offset_mm.norm() == 0));
    if (in_root) {
      if (i == 0) {
        out.skeleton.bones.push_back({bone_name(joint.name), -1, {0, 0, 0}});
        out.skeleton.root_rest_mm = joint.offset_mm;
        last_joint.push_back(0);
      }
      root_of_joint[i] = static_cast<int>(out.root_joints.size());
      out.root_joints.push_back({joint.revolute, joint.offset_mm, joint.axis});
      last_joint[0] = i;
      continue;
    }
    if (!joint.revolute) lines.fail("joint \"" + joint.name + "\" is prismatic; only the root may slide");
    const int parent_bone = out.bone_of_joint[joint.parent];
    const bool same_place = joint.offset_mm.norm() == 0 && parent_bone > 0 && last_joint[parent_bone] == joint.parent &&
                            n_children[joint.parent] == 1 &&
                            bone_name(joint.name) == bone_name(joints[joint.parent].name);
    if (same_place) {
      out.bone_of_joint[i] = parent_bone;
      last_joint[parent_bone] = i;
    } else {
      out.bone_of_joint[i] = out.skeleton.n_bones();
      std::string name = bone_name(joint.name);
      if (out.skeleton.bone_index(name) >= 0) name = joint.name;
      out.skeleton.bones.push_back({name, parent_bone, joint.offset_mm});
      last_joint.push_back(i);
    }
    dof_of_joint[i] = out.skeleton.n_dofs();
    out.skeleton.dofs.push_back({joint.name, out.bone_of_joint[i], joint.axis, -std::numbers::pi, std::numbers::pi, 0});
  }
}

}  // namespace

SkeletoolSkeleton load_skeletool_skeleton(const std::filesystem::path& path) {
  SkeletoolLines lines(path, "Skeletool Skeleton Definition V1.0");
  SkeletoolSkeleton result;
  const std::vector<Joint> joints = read_joints(lines);
  std::vector<int> dof_of_joint, root_of_joint;
  build_chain(joints, result, dof_of_joint, root_of_joint, lines);
  for (const Joint& joint : joints)
    if (result.scaled_joint.empty() && joint.scale != 1) result.scaled_joint = joint.name;
  if (result.skeleton.n_dofs() > kMaxDofs)
    lines.fail(format("%d joints below the root, at most %d", result.skeleton.n_dofs(), kMaxDofs));
  // The joint of this name; as in Skeletool, a bone's name means its first one.
  auto joint_named = [&](const std::string& name) {
    int first = -1;
    for (size_t i = 0; i < joints.size(); ++i) {
      if (joints[i].name == name) return static_cast<int>(i);
      if (first < 0 && joints[i].name.starts_with(name)) first = static_cast<int>(i);
    }
    if (first < 0) lines.fail("there is no joint \"" + name + "\"");
    return first;
  };
  const PosedSkeleton rest = forward_kinematics(result.skeleton, rest_pose(result.skeleton));

  const int n_markers = lines.section("markers");
  for (int i = 0; i < n_markers; ++i) {
    lines.require(format("marker %d of %d", i + 1, n_markers));
    if (lines.size() < 6) lines.fail("a marker needs name, joint, type and offset (3)");
    const int bone = result.bone_of_joint[joint_named(lines.word(1))];
    result.markers.push_back(
        {lines.word(0), bone,
         rest.camera_from_bone[bone] * Eigen::Vector3d(lines.number(3), lines.number(4), lines.number(5))});
  }
  const int n_scaling =
      lines.section("scaling joints");  // groups that were scaled together; the scale is in the joints
  for (int i = 0; i < n_scaling; ++i) {
    lines.require(format("scaling joint %d of %d", i + 1, n_scaling));
    if (lines.size() != 2) lines.fail("a scaling joint needs name and count");
    const int n_members = lines.integer(1);
    for (int k = 0; k < n_members; ++k) lines.require("a scaled joint");
  }

  const int n_parameters = lines.section("dofs");
  if (n_parameters > static_cast<int>(joints.size()))
    lines.fail(format("%d dofs for %zu joints", n_parameters, joints.size()));
  result.angles_from_parameters = Eigen::MatrixXd::Zero(result.skeleton.n_dofs(), n_parameters);
  result.root_from_parameters = Eigen::MatrixXd::Zero(static_cast<int>(result.root_joints.size()), n_parameters);
  for (int i = 0; i < n_parameters; ++i) {
    lines.require(format("dof %d of %d", i + 1, n_parameters));
    if (lines.size() != 2) lines.fail("a dof needs name and number of joints");
    result.parameter_names.push_back(lines.word(0));
    const int n_members = lines.integer(1);
    lines.require("\"limits MIN MAX\" or \"nolimits\"");
    const bool limited = lines.word(0) == "limits" && lines.size() == 3;
    if (!limited && lines.word(0) != "nolimits") lines.fail("expected \"limits MIN MAX\" or \"nolimits\"");
    const double low = limited ? lines.number(1) : 0, high = limited ? lines.number(2) : 0;
    if (low > high) lines.fail(format("limits %g and %g are reversed", low, high));
    for (int k = 0; k < n_members; ++k) {
      lines.require("a joint and its weight");
      if (lines.size() != 2) lines.fail("expected joint name and weight");
      const int joint = joint_named(lines.word(0));
      const double weight = lines.number(1);
      if (root_of_joint[joint] >= 0) {
        result.root_from_parameters(root_of_joint[joint], i) += weight;
        continue;
      }
      Dof& dof = result.skeleton.dofs[dof_of_joint[joint]];
      result.angles_from_parameters(dof_of_joint[joint], i) += weight;
      if (limited) {
        dof.min_rad = std::min(weight * low, weight * high);
        dof.max_rad = std::max(weight * low, weight * high);
      }
    }
    if (n_members > 1)
      result.notes.push_back(format("%s turns %d joints together; here each turns by itself",
                                    result.parameter_names.back().c_str(), n_members));
  }
  for (Dof& dof : result.skeleton.dofs) {
    if (dof.min_rad <= 0 && dof.max_rad >= 0) continue;
    result.notes.push_back(dof.name + ": the bind pose (0) is outside its limits; limit widened");
    dof.min_rad = std::min(dof.min_rad, 0.0);
    dof.max_rad = std::max(dof.max_rad, 0.0);
  }
  result.skeleton.validate();
  return result;
}

Pose SkeletoolSkeleton::pose(const Eigen::VectorXd& parameters) const {
  if (parameters.size() != n_parameters())
    throw LogicError(format("SkeletoolSkeleton::pose: %d values for %d parameters", static_cast<int>(parameters.size()),
                            n_parameters()));
  const Eigen::VectorXd root = root_from_parameters * parameters;
  Eigen::Isometry3d frame = Eigen::Isometry3d::Identity();
  for (size_t i = 0; i < root_joints.size(); ++i) {
    frame.translate(root_joints[i].offset_mm);
    if (root_joints[i].revolute)
      frame.rotate(Eigen::AngleAxisd(root[i], root_joints[i].axis));
    else
      frame.translate(root[i] * root_joints[i].axis);
  }
  Pose pose;
  pose.root_rotation = frame.linear();
  pose.root_translation_mm = frame.translation();
  pose.angles_rad = angles_from_parameters * parameters;
  return pose;
}

SkinWeights load_skeletool_skin(const std::filesystem::path& path, const SkeletoolSkeleton& skeleton,
                                std::vector<std::string>& notes) {
  SkeletoolLines lines(path, "Skeletool character skinning file V1.0");
  lines.require("\"bones:\"");
  if (lines.word(0) != "bones:") lines.fail("expected \"bones:\"");
  lines.require("the bone names");
  std::vector<int> bones;
  for (size_t i = 0; i < lines.size(); ++i) {
    int bone = -1;
    for (size_t j = 0; j < skeleton.joint_names.size(); ++j) {
      if (skeleton.joint_names[j].rfind(lines.word(i), 0) == 0) bone = skeleton.bone_of_joint[j];
    }
    if (bone < 0) lines.fail("the skeleton has no joint for bone \"" + lines.word(i) + "\"");
    bones.push_back(bone);
  }
  lines.require("\"vertex weights:\"");
  if (lines.size() != 2 || lines.word(0) != "vertex" || lines.word(1) != "weights:")
    lines.fail("expected \"vertex weights:\"");
  SkinWeights skin;
  double lost = 0;
  while (lines.next()) {
    const int vertex = static_cast<int>(skin.bones.size()) / kMaxInfluences;
    if (lines.integer(0) != vertex)
      lines.fail(format("vertex %s where %d was expected", lines.word(0).c_str(), vertex));
    if (lines.size() < 3 || lines.size() % 2 != 1) lines.fail("expected vertex index and pairs of bone and weight");
    std::map<int, double> total;
    for (size_t i = 1; i < lines.size(); i += 2) {
      const int bone = lines.integer(i);
      if (bone >= static_cast<int>(bones.size())) lines.fail(format("bone %d, there are %zu", bone, bones.size()));
      total[bones[bone]] += std::max(lines.number(i + 1), 0.0);
    }
    std::vector<std::pair<double, int>> sorted;
    for (const auto& [bone, weight] : total) sorted.push_back({-weight, bone});
    std::sort(sorted.begin(), sorted.end());
    double all = 0, kept = 0;
    for (const auto& [weight, bone] : sorted) all -= weight;
    sorted.resize(std::min<size_t>(sorted.size(), kMaxInfluences));
    for (const auto& [weight, bone] : sorted) kept -= weight;
    if (!(kept > 0)) lines.fail(format("vertex %d has no weight", vertex));
    lost = std::max(lost, 1 - kept / all);
    for (size_t k = 0; k < kMaxInfluences; ++k) {
      const bool used = k < sorted.size() && sorted[k].first < 0;
      skin.bones.push_back(used ? sorted[k].second : 0);
      skin.weights.push_back(used ? static_cast<float>(-sorted[k].first / kept) : 0.f);
    }
  }
  if (lost > 0.01)
    notes.push_back(path.string() +
                    format(": only the %d strongest bones of a vertex are kept; up to %.0f %% of its weight dropped",
                           kMaxInfluences, 100 * lost));
  return skin;
}

SkeletoolMotion load_skeletool_motion(const std::filesystem::path& path, int n_parameters) {
  SkeletoolLines lines(path, "Skeletool Motion File V1.0");
  SkeletoolMotion motion;
  while (lines.next()) {
    if (static_cast<int>(lines.size()) != 1 + n_parameters)
      lines.fail(
          format("%zu values for the skeleton's %d degrees of freedom, a frame number and one of each are needed",
                 lines.size() - 1, n_parameters));
    const int frame = lines.integer(0);
    if (!motion.frames.empty() && frame <= motion.frames.back())
      lines.fail(format("frame %d after frame %d; they must ascend", frame, motion.frames.back()));
    motion.frames.push_back(frame);
    Eigen::VectorXd values(n_parameters);
    for (int i = 0; i < n_parameters; ++i) values[i] = lines.number(1 + i);
    motion.parameters.push_back(values);
  }
  if (motion.frames.empty()) lines.fail("the file ends where a frame was expected");
  return motion;
}

std::vector<SkeletoolCamera> load_skeletool_cameras(const std::filesystem::path& path) {
  SkeletoolLines lines(path, "Skeletool Camera Calibration File V1.0");
  std::vector<SkeletoolCamera> cameras;
  bool has_size = false, has_intrinsic = false, has_extrinsic = false;
  auto check_complete = [&] {
    if (!cameras.empty() && !(has_size && has_intrinsic && has_extrinsic))
      lines.fail("camera \"" + cameras.back().name + "\" needs size, intrinsic and extrinsic");
    has_size = has_intrinsic = has_extrinsic = false;
  };
  while (lines.next()) {
    const std::string& field = lines.word(0);
    auto expect = [&](size_t n) {
      if (lines.size() != n + 1) lines.fail(field + format(" needs %zu values", n));
    };
    if (field == "name") {
      expect(1);
      check_complete();
      cameras.emplace_back();
      cameras.back().name = lines.word(1);
      continue;
    }
    if (cameras.empty()) lines.fail("expected \"name\"");
    Camera& camera = cameras.back().camera;
    if (field == "size") {
      expect(2);
      camera.width = lines.integer(1);
      camera.height = lines.integer(2);
      has_size = true;
    } else if (field == "animated") {
      expect(1);
      if (lines.integer(1) != 0) lines.fail("an animated camera; only static ones are supported");
    } else if (field == "intrinsic") {
      expect(16);
      camera.fx = lines.number(1);
      camera.cx = lines.number(3);
      camera.fy = lines.number(6);
      camera.cy = lines.number(7);
      if (std::abs(lines.number(2)) > 1e-6 * std::abs(camera.fx))
        lines.fail(format("skew %g is not supported", lines.number(2)));
      has_intrinsic = true;
    } else if (field == "extrinsic") {
      expect(16);
      Eigen::Matrix4d m;
      for (int i = 0; i < 16; ++i) m(i / 4, i % 4) = lines.number(1 + i);
      const Eigen::Matrix3d r = m.topLeftCorner<3, 3>();
      if ((r * r.transpose() - Eigen::Matrix3d::Identity()).norm() > 1e-3 || r.determinant() < 0)
        lines.fail("the extrinsic is no rotation");
      cameras.back().camera_from_world.linear() = Eigen::Quaterniond(r).normalized().toRotationMatrix();
      cameras.back().camera_from_world.translation() = m.topRightCorner<3, 1>();
      has_extrinsic = true;
    } else if (field == "radial") {
      for (size_t i = 1; i < lines.size(); ++i) {
        if (lines.number(i) != 0) lines.fail("radial distortion is not supported; undistort the pictures");
      }
    } else if (field != "sensor") {
      lines.fail("unknown field \"" + field + "\"");
    }
  }
  check_complete();
  if (cameras.empty()) lines.fail("the file ends where \"name\" was expected");
  for (const SkeletoolCamera& camera : cameras) {
    try {
      camera.camera.validate();
    } catch (const ConfigError& e) {
      throw IoError(path.string() + ": camera \"" + camera.name + "\": " + e.what());
    }
  }
  return cameras;
}

}  // namespace livecap
