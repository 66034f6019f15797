// A capsule man with a skeleton like LiveCap-32 whose trunk is one bone and whose feet do not tilt: a small procedural
// actor for tests that need skinning, keypoints and contours but no file. 1.76 m, about 700 vertices, blended near the
// joints.
#pragma once

#include <cmath>
#include <numbers>
#include <string>

#include "actor/actor.h"
#include "geometry/skeleton.h"

namespace livecap::test {

namespace test_actor_detail {

inline void add_bone(Actor& actor, const std::string& name, int parent, Eigen::Vector3d offset_mm) {
  actor.skeleton.bones.push_back({name, parent, offset_mm});
}

inline void add_dof(Actor& actor, const std::string& name, const std::string& bone, Eigen::Vector3d axis,
                    double min_deg, double max_deg) {
  const double rad = std::numbers::pi / 180;
  actor.skeleton.dofs.push_back({name, actor.skeleton.bone_index(bone), axis, min_deg * rad, max_deg * rad, 0});
}

// A closed tube from a to b bound to `bone`, the first part of it blended with `parent`.
inline void add_capsule(Actor& actor, Eigen::Vector3d a, Eigen::Vector3d b, double radius_mm, int bone, int parent) {
  constexpr int kRings = 7;
  constexpr int kSegments = 8;
  const int first = actor.n_vertices();
  const Eigen::Vector3d along = (b - a).normalized();
  const Eigen::Vector3d side = along.unitOrthogonal();
  const Eigen::Vector3d front = along.cross(side);
  const auto add_vertex = [&](const Eigen::Vector3d& p, double t) {
    for (int i = 0; i < 3; ++i) actor.mesh.positions.push_back(float(p[i]));
    const double other = parent < 0 ? 0 : std::max(0.0, 0.4 - 1.2 * t);
    for (int bone_index : {bone, other > 0 ? parent : 0, 0, 0}) actor.skin.bones.push_back(bone_index);
    for (double weight : {1 - other, other, 0.0, 0.0}) actor.skin.weights.push_back(float(weight));
  };
  const auto add_triangle = [&](int i, int j, int k) {
    for (int index : {i, j, k}) actor.mesh.triangles.push_back(first + index);
  };
  for (int ring = 0; ring < kRings; ++ring) {
    const double t = double(ring) / (kRings - 1);
    const double r = radius_mm * (ring == 0 || ring == kRings - 1 ? 0.7 : 1.0);
    for (int s = 0; s < kSegments; ++s) {
      const double angle = 2 * std::numbers::pi * s / kSegments;
      add_vertex(a + t * (b - a) + r * (std::cos(angle) * side + std::sin(angle) * front), t);
    }
  }
  add_vertex(a - 0.5 * radius_mm * along, 0);
  add_vertex(b + 0.5 * radius_mm * along, 1);
  const int start = kRings * kSegments;
  for (int s = 0; s < kSegments; ++s) {
    const int next = (s + 1) % kSegments;
    for (int ring = 0; ring + 1 < kRings; ++ring) {
      const int low = ring * kSegments;
      add_triangle(low + s, low + next, low + kSegments + s);
      add_triangle(low + next, low + kSegments + next, low + kSegments + s);
    }
    add_triangle(start, next, s);
    add_triangle(start + 1, start - kSegments + s, start - kSegments + next);
  }
}

// Rebinds a T-pose actor with both arms lowered by this angle.
inline void bind_in_a_pose(Actor& actor, double arms_down_rad) {
  Pose pose = rest_pose(actor.skeleton);
  for (Dof& dof : actor.skeleton.dofs) {
    const int k = int(&dof - actor.skeleton.dofs.data());
    if (dof.name == "left_shoulder_z") pose.angles_rad[k] = -arms_down_rad;
    if (dof.name == "right_shoulder_z") pose.angles_rad[k] = arms_down_rad;
  }
  const PosedSkeleton posed = forward_kinematics(actor.skeleton, pose);
  for (int i = 0; i < actor.n_vertices(); ++i) {
    const Eigen::Vector3d p = Eigen::Map<Eigen::Vector3f>(&actor.mesh.positions[3 * i]).cast<double>();
    const Eigen::Vector3d moved = posed.camera_from_rest[actor.skin.bones[4 * i]] * p;
    for (int j = 0; j < 3; ++j) actor.mesh.positions[3 * i + j] = float(moved[j]);
  }
  for (KeypointAnchor& anchor : actor.keypoints)
    anchor.rest_position_mm = posed.camera_from_rest[anchor.bone] * anchor.rest_position_mm;
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k) actor.skeleton.dofs[k].rest_rad = pose.angles_rad[k];
}

}  // namespace test_actor_detail

// arms_down_rad: 0 binds in the T-pose, more in an A-pose.
inline Actor make_test_actor(double arms_down_rad = 0) {
  using namespace test_actor_detail;
  const Eigen::Vector3d x = Eigen::Vector3d::UnitX();
  const Eigen::Vector3d y = Eigen::Vector3d::UnitY();
  const Eigen::Vector3d z = Eigen::Vector3d::UnitZ();
  Actor actor;
  actor.name = "capsule man";
  actor.skeleton.root_rest_mm = {0, 950, 0};
  add_bone(actor, "pelvis", -1, {0, 0, 0});
  add_bone(actor, "neck", 0, {0, 500, 0});
  add_bone(actor, "left_clavicle", 0, {20, 440, 10});
  add_bone(actor, "left_shoulder", 2, {160, 20, -10});
  add_bone(actor, "left_elbow", 3, {280, 0, 0});
  add_bone(actor, "right_clavicle", 0, {-20, 440, 10});
  add_bone(actor, "right_shoulder", 5, {-160, 20, -10});
  add_bone(actor, "right_elbow", 6, {-280, 0, 0});
  add_bone(actor, "left_hip", 0, {95, -40, 0});
  add_bone(actor, "left_knee", 8, {0, -420, 0});
  add_bone(actor, "left_ankle", 9, {0, -410, 0});
  add_bone(actor, "right_hip", 0, {-95, -40, 0});
  add_bone(actor, "right_knee", 11, {0, -420, 0});
  add_bone(actor, "right_ankle", 12, {0, -410, 0});

  add_dof(actor, "neck_x", "neck", x, -60, 50);
  add_dof(actor, "neck_y", "neck", y, -75, 75);
  add_dof(actor, "neck_z", "neck", z, -40, 40);
  add_dof(actor, "left_clavicle_y", "left_clavicle", y, -30, 25);
  add_dof(actor, "left_clavicle_z", "left_clavicle", z, -10, 40);
  add_dof(actor, "right_clavicle_y", "right_clavicle", y, -25, 30);
  add_dof(actor, "right_clavicle_z", "right_clavicle", z, -40, 10);
  add_dof(actor, "left_shoulder_z", "left_shoulder", z, -95, 95);
  add_dof(actor, "left_shoulder_y", "left_shoulder", y, -135, 45);
  add_dof(actor, "left_shoulder_x", "left_shoulder", x, -120, 120);
  add_dof(actor, "left_elbow_y", "left_elbow", y, -150, 2);
  add_dof(actor, "right_shoulder_z", "right_shoulder", z, -95, 95);
  add_dof(actor, "right_shoulder_y", "right_shoulder", y, -45, 135);
  add_dof(actor, "right_shoulder_x", "right_shoulder", x, -120, 120);
  add_dof(actor, "right_elbow_y", "right_elbow", y, -2, 150);
  add_dof(actor, "left_hip_x", "left_hip", x, -135, 35);
  add_dof(actor, "left_hip_y", "left_hip", y, -45, 45);
  add_dof(actor, "left_hip_z", "left_hip", z, -40, 70);
  add_dof(actor, "right_hip_x", "right_hip", x, -135, 35);
  add_dof(actor, "right_hip_y", "right_hip", y, -45, 45);
  add_dof(actor, "right_hip_z", "right_hip", z, -70, 40);
  add_dof(actor, "left_knee_x", "left_knee", x, -5, 150);
  add_dof(actor, "right_knee_x", "right_knee", x, -5, 150);
  add_dof(actor, "left_ankle_x", "left_ankle", x, -25, 50);
  add_dof(actor, "left_ankle_y", "left_ankle", y, -35, 35);
  add_dof(actor, "right_ankle_x", "right_ankle", x, -25, 50);
  add_dof(actor, "right_ankle_y", "right_ankle", y, -35, 35);

  const PosedSkeleton rest = forward_kinematics(actor.skeleton, rest_pose(actor.skeleton));
  const auto place = [&](const char* bone, Eigen::Vector3d local_mm) -> Eigen::Vector3d {
    return rest.camera_from_bone[actor.skeleton.bone_index(bone)] * local_mm;
  };
  const auto anchor = [&](int keypoint, const char* bone, Eigen::Vector3d local_mm) {
    actor.keypoints[keypoint] = {actor.skeleton.bone_index(bone), place(bone, local_mm)};
  };
  anchor(kHeadTop, "neck", {0, 270, 20});
  anchor(kNeck, "pelvis", {0, 500, 0});
  anchor(kPelvis, "pelvis", {0, -40, 0});
  anchor(kLeftEye, "neck", {32, 150, 90});
  anchor(kRightEye, "neck", {-32, 150, 90});
  anchor(kNose, "neck", {0, 120, 110});
  anchor(kChin, "neck", {0, 60, 85});
  for (int side : {0, 1}) {
    const std::string name = side == 0 ? "left_" : "right_";
    const double sign = side == 0 ? 1 : -1;
    anchor(kLeftHip + side, (name + "hip").c_str(), {0, 0, 0});
    anchor(kLeftShoulder + side, (name + "shoulder").c_str(), {0, 0, 0});
    anchor(kLeftElbow + side, (name + "elbow").c_str(), {0, 0, 0});
    anchor(kLeftWrist + side, (name + "elbow").c_str(), {sign * 260, 0, 0});
    anchor(kLeftHand + side, (name + "elbow").c_str(), {sign * 350, 0, 0});
    anchor(kLeftKnee + side, (name + "knee").c_str(), {0, 0, 0});
    anchor(kLeftAnkle + side, (name + "ankle").c_str(), {0, 0, 0});
    anchor(kLeftToe + side, (name + "ankle").c_str(), {0, -50, 150});
  }

  const auto capsule = [&](const char* bone, Eigen::Vector3d to_mm, double radius_mm) {
    const int index = actor.skeleton.bone_index(bone);
    add_capsule(actor, place(bone, {0, 0, 0}), place(bone, to_mm), radius_mm, index,
                actor.skeleton.bones[index].parent);
  };
  capsule("pelvis", {0, 440, 0}, 120);
  capsule("neck", {0, 230, 10}, 80);
  for (int side : {0, 1}) {
    const std::string name = side == 0 ? "left_" : "right_";
    const double sign = side == 0 ? 1 : -1;
    capsule((name + "clavicle").c_str(), {sign * 160, 20, -10}, 60);
    capsule((name + "shoulder").c_str(), {sign * 280, 0, 0}, 50);
    capsule((name + "elbow").c_str(), {sign * 340, 0, 0}, 40);
    capsule((name + "hip").c_str(), {0, -420, 0}, 75);
    capsule((name + "knee").c_str(), {0, -410, 0}, 55);
    capsule((name + "ankle").c_str(), {0, -50, 150}, 40);
  }
  actor.colors.assign(actor.mesh.positions.size(), 0.5f);
  actor.labels.assign(actor.n_vertices(), 10);
  actor.rigidity.assign(actor.n_vertices(), 1.0f);
  if (arms_down_rad != 0) bind_in_a_pose(actor, arms_down_rad);
  return actor;
}

}  // namespace livecap::test
