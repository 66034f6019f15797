#include "synth/rig.h"

namespace livecap::synth {

namespace {

// How far a point is from the flesh one bone moves: limbs whose radii meet where two of them meet, so that the surface
// bends at the joint, however wide the clothes are around it.
double flesh_distance(const BodyShape& shape, int bone, const Vec3& p) {
  const auto& j = shape.joints();
  const auto limb = [&](const Vec3& a, const Vec3& b, double ra, double rb) {
    return std::max(tapered_capsule(p, a, b, ra, rb), 0.0);
  };
  const int first = bone >= kRightShoulder ? kRightShoulder : kLeftShoulder;
  switch (bone) {
    case kHips:
      return std::min(limb(j[kHips], j[kSpine], 110, 105), limb(j[kLeftUpLeg], j[kRightUpLeg], 72, 72));
    case kSpine:
      return limb(j[kSpine], j[kSpine1], 105, 105);
    case kSpine1:
      return limb(j[kSpine1], j[kSpine2], 105, 112);
    case kSpine2:
      return limb(j[kSpine2], j[kNeck], 112, 54);
    case kNeck:
      return limb(j[kNeck], j[kHead], 54, 54);
    case kHead:
      return limb(j[kHead] + Vec3(0, 40, 15), Vec3(0, 1650, 0), 80, 80);
    default:
      break;
  }
  switch (bone - first) {
    case 0:
      return limb(j[bone], j[bone + 1], 42, 46);
    case 1:
      return limb(j[bone], j[bone + 1], 46, 37);
    case 2:
      return limb(j[bone], j[bone + 1], 37, 30);
    case 3:
      return limb(j[bone], j[bone] + 150 * (j[bone] - j[bone - 1]).normalized(), 30, 30);
    case 4:
      return limb(j[bone], j[bone + 1], 72, 54);
    case 5:
      return limb(j[bone], j[bone + 1], 54, 36);
    case 6:  // with the heel
      return std::min(limb(j[bone], j[bone + 1], 36, 30), limb(j[bone], j[bone] + Vec3(0, -46, -36), 36, 36));
    default:
      return limb(j[bone], j[bone] + Vec3(0, 0, 55), 30, 30);
  }
}

// How strongly a bone may act on a part at all.
double permission(const BodyShape& shape, int bone, Part part, const Vec3& p) {
  const bool right = bone >= kRightShoulder;
  const int limb = bone < kLeftShoulder ? -1 : (bone - kLeftShoulder) % 8;
  const bool arm = limb >= 0 && limb < 4, leg = limb >= 4;
  const double side = right ? -p.x() : p.x();
  switch (part) {
    case kHairPart:
    case kFacePart:
      return bone == kHead || bone == kNeck ? 1 : 0;
    case kNeckPart:
      return bone == kHead || bone == kNeck || bone == kSpine2 || limb == 0 ? 1 : 0;
    case kTopPart:
      return leg ? (limb == 4 ? 0.3 : 0) : (limb >= 0 && side < 20) || limb == 3 || bone == kHead ? 0 : 1;
    case kArmPart:
    case kHandPart:
      return arm && side > 0 ? 1 : 0;
    case kBottomPart:
      if (shape.outfit() == Outfit::kSkirt) return bone == kHips || bone == kSpine ? 1 : limb == 4 ? 0.12 : 0;
      return bone == kHips || bone == kSpine || (limb >= 4 && limb <= 6 && side > -30) ? 1 : 0;
    default:
      return bone == kHips || (leg && side > -10) ? 1 : 0;
  }
}

struct DualQuaternion {
  Eigen::Vector4d real, dual;  // w, x, y, z
};

Eigen::Vector4d product(const Eigen::Vector4d& a, const Eigen::Vector4d& b) {
  Eigen::Vector4d c;
  c[0] = a[0] * b[0] - a.tail<3>().dot(b.tail<3>());
  c.tail<3>() = a[0] * b.tail<3>() + b[0] * a.tail<3>() + Vec3(a.tail<3>()).cross(Vec3(b.tail<3>()));
  return c;
}

DualQuaternion rigid(const Eigen::Quaterniond& rotation, const Vec3& translation) {
  DualQuaternion dq;
  dq.real = {rotation.w(), rotation.x(), rotation.y(), rotation.z()};
  dq.dual = 0.5 * product({0, translation.x(), translation.y(), translation.z()}, dq.real);
  return dq;
}

}  // namespace

std::vector<std::vector<int>> vertex_neighbors(const Surface& surface) {
  std::vector<std::vector<int>> neighbors(surface.vertices.size());
  for (const auto& t : surface.triangles)
    for (int i = 0; i < 3; ++i) neighbors[t[i]].push_back(t[(i + 1) % 3]);  // closed: each edge once from either side
  for (auto& list : neighbors) std::sort(list.begin(), list.end());
  return neighbors;
}

std::vector<Influences> make_skin_weights(const BodyShape& shape, const Surface& surface,
                                          const std::vector<Part>& parts) {
  constexpr double kSoftness = 20;  // mm: distance over which influence fades
  constexpr int kDiffusion = 4;
  using Row = Eigen::Matrix<double, kBoneCount, 1>;
  const size_t n = surface.vertices.size();
  std::vector<Row> weights(n), next(n);
  for (size_t i = 0; i < n; ++i) {
    const Vec3& p = surface.vertices[i];
    for (int bone = 0; bone < kBoneCount; ++bone) {
      const double allowed = permission(shape, bone, parts[i], p);
      weights[i][bone] = allowed > 0 ? allowed / std::pow(flesh_distance(shape, bone, p) + kSoftness, 3) : 0;
    }
    weights[i] /= weights[i].sum();
  }
  const auto neighbors = vertex_neighbors(surface);
  for (int step = 0; step < kDiffusion; ++step) {
    for (size_t i = 0; i < n; ++i) {
      Row mean = Row::Zero();
      for (int j : neighbors[i]) mean += weights[j];
      next[i] = 0.5 * weights[i] + 0.5 * mean / neighbors[i].size();
    }
    weights.swap(next);
  }
  std::vector<Influences> result(n);
  for (size_t i = 0; i < n; ++i) {
    double sum = 0;
    for (auto& slot : result[i]) {
      int bone;
      const double weight = weights[i].maxCoeff(&bone);
      if (weight < 0.01) break;
      slot = {bone, weight};
      sum += weight;
      weights[i][bone] = 0;
    }
    for (auto& slot : result[i]) slot.weight /= sum;
  }
  return result;
}

BonePose pose_bones(const std::array<Vec3, kBoneCount>& rest_joints,
                    const std::array<Eigen::Quaterniond, kBoneCount>& local, const Vec3& root_position) {
  BonePose pose;
  pose.rotations[0] = local[0];
  pose.origins[0] = root_position;
  for (int bone = 1; bone < kBoneCount; ++bone) {
    const int parent = kBones[bone].parent;
    pose.rotations[bone] = (pose.rotations[parent] * local[bone]).normalized();
    pose.origins[bone] = pose.origins[parent] + pose.rotations[parent] * (rest_joints[bone] - rest_joints[parent]);
  }
  return pose;
}

std::vector<Vec3> skin_vertices(const std::vector<Vec3>& rest, const std::vector<Influences>& weights,
                                const std::array<Vec3, kBoneCount>& rest_joints, const BonePose& pose) {
  std::array<DualQuaternion, kBoneCount> bones;
  for (int bone = 0; bone < kBoneCount; ++bone)
    bones[bone] = rigid(pose.rotations[bone], pose.origins[bone] - pose.rotations[bone] * rest_joints[bone]);
  std::vector<Vec3> posed(rest.size());
  for (size_t i = 0; i < rest.size(); ++i) {
    const Eigen::Vector4d& pivot = bones[weights[i][0].bone].real;
    Eigen::Vector4d real = Eigen::Vector4d::Zero(), dual = real;
    for (const auto& [bone, weight] : weights[i]) {
      const double signed_weight = bones[bone].real.dot(pivot) < 0 ? -weight : weight;  // the shorter way round
      real += signed_weight * bones[bone].real;
      dual += signed_weight * bones[bone].dual;
    }
    const double length = real.norm();
    real /= length;
    dual /= length;
    const Eigen::Quaterniond rotation(real[0], real[1], real[2], real[3]);
    const Vec3 translation = 2 * (real[0] * Vec3(dual.tail<3>()) - dual[0] * Vec3(real.tail<3>()) +
                                  Vec3(real.tail<3>()).cross(Vec3(dual.tail<3>())));
    posed[i] = rotation * rest[i] + translation;
  }
  return posed;
}

}  // namespace livecap::synth
