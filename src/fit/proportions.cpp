#include "fit/proportions.h"

#include <cmath>

#include "actor/bone_names.h"
#include "livecap/error.h"

namespace livecap {

const std::array<const char*, kProportionCount> kProportionNames = {
    "trunk length",    "trunk girth",    "head size",     "shoulder width", "upper arm length",
    "upper arm girth", "forearm length", "forearm girth", "thigh length",   "thigh girth",
    "shank length",    "shank girth",    "foot size"};

namespace {

struct Stretch {
  int along, across;
};

// Which numbers stretch a bone (index: RigJoint).
Stretch stretch_of(int bone) {
  switch (bone) {
    case kRigRoot:
    case kRigChest:
      return {kTrunkLength, kTrunkGirth};
    case kRigNeck:
      return {kHeadSize, kHeadSize};
    case kRigLeftClavicle:
    case kRigRightClavicle:
      return {kShoulderWidth, kShoulderWidth};
    case kRigLeftShoulder:
    case kRigRightShoulder:
      return {kUpperArmLength, kUpperArmGirth};
    case kRigLeftElbow:
    case kRigRightElbow:
      return {kForearmLength, kForearmGirth};
    case kRigLeftHip:
    case kRigRightHip:
      return {kThighLength, kThighGirth};
    case kRigLeftKnee:
    case kRigRightKnee:
      return {kShankLength, kShankGirth};
    default:
      return {kFootSize, kFootSize};
  }
}

Eigen::Vector3d rest_point(const Actor& actor, int vertex) {
  return Eigen::Map<const Eigen::Vector3f>(actor.mesh.positions.data() + 3 * static_cast<size_t>(vertex))
      .cast<double>();
}

}  // namespace

Reshaper::Reshaper(const Actor& actor) : actor_(actor) {
  const Skeleton& skeleton = actor.skeleton;
  if (skeleton.n_bones() != kRigBoneCount) throw LogicError("reshaper: the actor has no LiveCap-32 skeleton");
  const PosedSkeleton rest = forward_kinematics(skeleton, rest_pose(skeleton));
  for (const auto& bone : rest.camera_from_bone) {
    joints_.push_back(bone.translation());
    rest_from_bone_.push_back(bone.linear());
  }
  axes_.assign(kRigBoneCount, Eigen::Vector3d::Zero());
  axes_[kRigRoot] = axes_[kRigChest] = Eigen::Vector3d::UnitY();
  for (const auto& [from, to] :
       {std::pair{kRigLeftShoulder, kRigLeftElbow}, std::pair{kRigRightShoulder, kRigRightElbow},
        std::pair{kRigLeftHip, kRigLeftKnee}, std::pair{kRigRightHip, kRigRightKnee},
        std::pair{kRigLeftKnee, kRigLeftAnkle}, std::pair{kRigRightKnee, kRigRightAnkle}})
    axes_[from] = (joints_[to] - joints_[from]).normalized();
  for (const auto& [from, to] : {std::pair<int, int>{kRigLeftElbow, kLeftWrist}, {kRigRightElbow, kRightWrist}})
    if (actor.keypoints[to].bone >= 0)
      axes_[from] = (actor.keypoints[to].rest_position_mm - joints_[from]).normalized();
}

Shape Reshaper::shape(const Proportions& proportions) const {
  Shape shape;
  shape.skeleton = actor_.skeleton;
  for (int bone = 0; bone < kRigBoneCount; ++bone) {
    const Stretch s = stretch_of(bone);
    const double along = std::exp(proportions[s.along]), across = std::exp(proportions[s.across]);
    shape.stretch.push_back(across * Eigen::Matrix3d::Identity() +
                            (along - across) * axes_[bone] * axes_[bone].transpose());
    const int parent = actor_.skeleton.bones[bone].parent;
    shape.joints.push_back(
        parent < 0 ? joints_[bone]
                   : Eigen::Vector3d(shape.joints[parent] + shape.stretch[parent] * (joints_[bone] - joints_[parent])));
    if (parent >= 0)
      shape.skeleton.bones[bone].offset_mm =
          rest_from_bone_[parent].transpose() * (shape.joints[bone] - shape.joints[parent]);
  }
  return shape;
}

Eigen::Vector3d Reshaper::attached(const Shape& shape, int bone, const Eigen::Vector3d& point) const {
  return shape.joints[bone] + shape.stretch[bone] * (point - joints_[bone]);
}

Eigen::Vector3d Reshaper::vertex(const Shape& shape, int index) const {
  const Eigen::Vector3d p = rest_point(actor_, index);
  Eigen::Vector3d moved = Eigen::Vector3d::Zero();
  for (int k = 0; k < kMaxInfluences; ++k) {
    const float weight = actor_.skin.weights[4 * static_cast<size_t>(index) + k];
    if (weight > 0) moved += weight * attached(shape, actor_.skin.bones[4 * static_cast<size_t>(index) + k], p);
  }
  return moved;
}

}  // namespace livecap
