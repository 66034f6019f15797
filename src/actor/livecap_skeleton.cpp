#include "actor/livecap_skeleton.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/text.h"

namespace livecap {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;

constexpr int kParents[kRigBoneCount] = {
    -1,        kRigRoot,          kRigChest,         kRigChest, kRigLeftClavicle, kRigLeftShoulder,
    kRigChest, kRigRightClavicle, kRigRightShoulder, kRigRoot,  kRigLeftHip,      kRigLeftKnee,
    kRigRoot,  kRigRightHip,      kRigRightKnee};

struct DofRow {
  int bone;
  char axis;
  double min_deg, max_deg;
  double rest_share = 0;
};

// The network does not see collarbones turn: without a rest they turn with what the pictures of the chest tell of a
// twisted spine, and of weights that are not a person's. Raised arms lift them. A chest without a rest bends where hips
// and legs are wrong in depth.
constexpr double kShrug = 1.0 / 3;
// A foot hardly turns about its shin: where the toes point, the knee does. Without a rest a bent knee that a skirt
// hides goes aside, and the leg turns back below it. Feet tilt sideways, as far as the legs are apart.
constexpr double kToesOut = 10, kTilt = 3;
// Which way a forearm points tells how the upper arm is twisted, but hardly where it points straight on. Without a rest
// an arm that hangs almost straight is as good bent backwards, the shoulder twisted.
constexpr double kTwist = 0.05;

// docs/formats.md, in its order.
constexpr DofRow kDofs[] = {
    {kRigChest, 'x', -40, 70, 1},
    {kRigChest, 'y', -45, 45, 1},
    {kRigChest, 'z', -35, 35, 1},
    {kRigNeck, 'x', -60, 50},
    {kRigNeck, 'y', -75, 75},
    {kRigNeck, 'z', -40, 40},
    {kRigLeftClavicle, 'y', -30, 25, 1},
    {kRigLeftClavicle, 'z', -10, 40, kShrug},
    {kRigRightClavicle, 'y', -25, 30, 1},
    {kRigRightClavicle, 'z', -40, 10, kShrug},
    {kRigLeftShoulder, 'z', -95, 95},
    {kRigLeftShoulder, 'y', -135, 45},
    {kRigLeftShoulder, 'x', -120, 120, kTwist},
    {kRigLeftElbow, 'y', -150, 2},
    {kRigRightShoulder, 'z', -95, 95},
    {kRigRightShoulder, 'y', -45, 135},
    {kRigRightShoulder, 'x', -120, 120, kTwist},
    {kRigRightElbow, 'y', -2, 150},
    {kRigLeftHip, 'x', -135, 35},
    {kRigLeftHip, 'y', -45, 45},
    {kRigLeftHip, 'z', -40, 70},
    {kRigRightHip, 'x', -135, 35},
    {kRigRightHip, 'y', -45, 45},
    {kRigRightHip, 'z', -70, 40},
    {kRigLeftKnee, 'x', -5, 150},
    {kRigRightKnee, 'x', -5, 150},
    {kRigLeftAnkle, 'x', -40, 50},
    {kRigLeftAnkle, 'y', -35, 35, kToesOut},
    {kRigLeftAnkle, 'z', -35, 20, kTilt},
    {kRigRightAnkle, 'x', -40, 50},
    {kRigRightAnkle, 'y', -35, 35, kToesOut},
    {kRigRightAnkle, 'z', -20, 35, kTilt},
};

Eigen::Matrix3d turn(char axis, double angle) {
  return Eigen::AngleAxisd(angle, Eigen::Vector3d::Unit(axis - 'x')).toRotationMatrix();
}

Eigen::Vector3d direction(const RigPositions& p, int from, int to) {
  const Eigen::Vector3d d = p[to] - p[from];
  return d.norm() > 1e-9 ? d.normalized() : d;
}

}  // namespace

Skeleton build_livecap_skeleton(const RigPositions& p, bool bends,
                                const std::map<std::string, std::pair<double, double>>& limits_deg,
                                std::vector<std::string>& notes) {
  Skeleton skeleton;
  skeleton.root_rest_mm = p[kRigRoot];
  for (int b = 0; b < kRigBoneCount; ++b)
    skeleton.bones.push_back({std::string(kRigJointNames[b]), kParents[b], {0, 0, 0}});
  for (const DofRow& row : kDofs) {
    if (row.bone == kRigChest && !bends) continue;
    Dof dof;
    dof.name = std::string(kRigJointNames[row.bone]) + "_" + row.axis;
    dof.bone = row.bone;
    dof.axis = Eigen::Vector3d::Unit(row.axis - 'x');
    dof.min_rad = row.min_deg * kRadPerDeg;
    dof.max_rad = row.max_deg * kRadPerDeg;
    dof.rest_share = row.rest_share;
    if (const auto own = limits_deg.find(dof.name); own != limits_deg.end()) {
      dof.min_rad = own->second.first * kRadPerDeg;
      dof.max_rad = own->second.second * kRadPerDeg;
    }
    skeleton.dofs.push_back(dof);
  }
  auto dof_named = [&](int bone, char axis) -> Dof& {
    const std::string name = std::string(kRigJointNames[bone]) + "_" + axis;
    return *std::find_if(skeleton.dofs.begin(), skeleton.dofs.end(), [&](const Dof& d) { return d.name == name; });
  };
  auto set_ball = [&](int bone, char axis, double angle) {
    Dof& dof = dof_named(bone, axis);
    dof.rest_rad = angle;
    if (angle < dof.min_rad || angle > dof.max_rad) {
      notes.push_back(format("%s: rest angle %.1f deg is outside its limits %.0f..%.0f; limit widened",
                             dof.name.c_str(), angle / kRadPerDeg, dof.min_rad / kRadPerDeg, dof.max_rad / kRadPerDeg));
      dof.min_rad = std::min(dof.min_rad, angle);
      dof.max_rad = std::max(dof.max_rad, angle);
    }
  };
  auto set_hinge = [&](int bone, char axis, double angle) {
    Dof& dof = dof_named(bone, axis);
    dof.rest_rad = std::clamp(angle, dof.min_rad, dof.max_rad);
  };

  // Arms: upper arm = Rz(a) Ry(b) (+-1,0,0), then the hinge angle of the forearm in the upper arm's frame.
  for (int side : {1, -1}) {
    const int shoulder = side > 0 ? kRigLeftShoulder : kRigRightShoulder;
    const int elbow = side > 0 ? kRigLeftElbow : kRigRightElbow;
    const int wrist = side > 0 ? kRigLeftWrist : kRigRightWrist;
    const Eigen::Vector3d upper = direction(p, shoulder, elbow) * side;  // the direction of local +X
    const double b = -std::asin(std::clamp(upper.z(), -1.0, 1.0));
    const double a = std::atan2(upper.y(), upper.x());
    set_ball(shoulder, 'z', a);
    set_ball(shoulder, 'y', b);
    const Eigen::Vector3d fore = (turn('z', a) * turn('y', b)).transpose() * direction(p, elbow, wrist) * side;
    set_hinge(elbow, 'y', std::atan2(-fore.z(), fore.x()));
  }
  // Legs: thigh = Rx(a) Rz(c) (0,-1,0), then the hinge angle of the shin.
  for (int side : {1, -1}) {
    const int hip = side > 0 ? kRigLeftHip : kRigRightHip;
    const int knee = side > 0 ? kRigLeftKnee : kRigRightKnee;
    const int ankle = side > 0 ? kRigLeftAnkle : kRigRightAnkle;
    const Eigen::Vector3d thigh = direction(p, hip, knee);
    const double c = std::asin(std::clamp(thigh.x(), -1.0, 1.0));
    const double a = std::atan2(-thigh.z(), -thigh.y());
    set_ball(hip, 'x', a);
    set_ball(hip, 'z', c);
    const Eigen::Vector3d shin = (turn('x', a) * turn('z', c)).transpose() * direction(p, knee, ankle);
    set_hinge(knee, 'x', std::atan2(-shin.z(), -shin.y()));
  }
  for (Dof& dof : skeleton.dofs) {  // the other joints rest at zero
    if (dof.rest_rad == 0) set_ball(dof.bone, dof.name.back(), 0);
  }

  // Offsets in the rested parent frames, so that rest reproduces the given joints whatever the angles left over.
  std::array<Eigen::Matrix3d, kRigBoneCount> frame;
  for (int b = 0; b < kRigBoneCount; ++b) {
    frame[b] = Eigen::Matrix3d::Identity();
    if (b > 0) {
      skeleton.bones[b].offset_mm = frame[kParents[b]].transpose() * (p[b] - p[kParents[b]]);
      frame[b] = frame[kParents[b]];
    }
    for (const Dof& dof : skeleton.dofs) {
      if (dof.bone == b) frame[b] = frame[b] * turn(dof.name.back(), dof.rest_rad);
    }
  }
  skeleton.validate();
  return skeleton;
}

}  // namespace livecap
