#include "acquire/skin_weights.h"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "acquire/leg_line.h"
#include "geometry/segment.h"
#include "livecap/error.h"
#include "meshing/surface_parts.h"

namespace livecap::acquire {

namespace {

using Eigen::Vector3d;
using Sparse = Eigen::SparseMatrix<double>;

constexpr int kBonesOfAnArm = kLeftKnuckleBone - kLeftArmBone + 1;
constexpr int kBonesOfTheLegs = kRightToeBone - kLeftUpLegBone + 1;

struct Segment {
  int bone;
  Vector3d a, b;
};

// The line of flesh each bone moves. The chest is a cage, not a line: without the ribs out to the sides the collarbones
// and upper arms own up to half of it (the nearest lines), and a twist of the trunk is taken for one of theirs. Below
// the joint of the spine it is the hips'.
std::vector<Segment> bone_segments(const BodyJoints& j) {
  // Below the neck, of neck to hips: under the collarbones, at the armpits, above the waist.
  constexpr double kRibsDown[] = {0.15, 0.3, 0.5};
  constexpr double kRibsWide = 0.7;  // of the way to the shoulder joints
  constexpr double kFree = 0.3;      // of collarbone and neck: the inner part is the cage's
  constexpr double kJaw = 0.8;       // of the neck's length in front of the head's joint: else it is the neck's
  constexpr double kHeel = 0.3;      // of the foot's length behind the ankle: else half of it is the shank's
  const double head = (j[kHeadBone] - j[kNeckBone]).norm();
  const Vector3d crown = j[kHeadBone] + 1.2 * head * Vector3d::UnitY();
  std::vector<Segment> segments = {{kHipsBone, j[kHipsBone], j[kSpineBone]},
                                   {kHipsBone, j[kLeftUpLegBone], j[kRightUpLegBone]},
                                   {kSpineBone, j[kSpineBone], j[kNeckBone]},
                                   {kNeckBone, j[kNeckBone] + kFree * (j[kHeadBone] - j[kNeckBone]), j[kHeadBone]},
                                   {kHeadBone, j[kHeadBone], crown},
                                   {kHeadBone, j[kHeadBone], j[kHeadBone] + kJaw * head * Vector3d::UnitZ()}};
  const double waist = (j[kNeckBone] - j[kSpineBone]).norm() / (j[kNeckBone] - j[kHipsBone]).norm();
  for (double down : kRibsDown) {
    const Vector3d middle = j[kNeckBone] + down * (j[kHipsBone] - j[kNeckBone]);
    const Vector3d half = 0.5 * kRibsWide * (j[kLeftArmBone] - j[kRightArmBone]);
    segments.push_back({down < waist ? kSpineBone : kHipsBone, middle - half, middle + half});
  }
  for (int first : {kLeftClavicleBone, kRightClavicleBone}) {
    segments.push_back({first, j[first] + kFree * (j[first + 1] - j[first]), j[first + 1]});
    for (int i = 1; i < 3; ++i) segments.push_back({first + i, j[first + i], j[first + i + 1]});
    const Vector3d hand = j[first + 4] - j[first + 3];
    segments.push_back({first + 3, j[first + 3], Vector3d(j[first + 4] + 0.6 * hand)});
  }
  for (int first : {kLeftUpLegBone, kRightUpLegBone}) {
    for (int i = 0; i < 3; ++i) segments.push_back({first + i, j[first + i], j[first + i + 1]});
    const Vector3d along = j[first + 3] - j[first + 2];
    segments.push_back(
        {first + 2, j[first + 2], j[first + 2] + Vector3d(-kHeel * along.x(), along.y(), -kHeel * along.z())});
    segments.push_back({first + 3, j[first + 3], Vector3d(j[first + 3] + 0.4 * Vector3d(along.x(), 0, along.z()))});
  }
  return segments;
}

Vector3d nearest_on(const Segment& s, const Vector3d& p) {
  return s.a + segment_parameter(p, s.a, s.b) * (s.b - s.a);
}

// True when the straight way from a vertex to the bone stays in the body.
bool sees(const Volume& volume, const Vector3d& vertex, const Vector3d& normal, const Vector3d& target) {
  const Vector3d from = vertex - std::min(6.0, 0.5 * (target - vertex).norm()) * normal;
  const double length = (target - from).norm();
  const int steps = std::max(2, static_cast<int>(length / (0.7 * volume.step)));
  for (int i = 0; i < steps; ++i)
    if (volume.at(from + (static_cast<double>(i) / steps) * (target - from)) > 0.25 * volume.step) return false;
  return true;
}

// How much of a leg's motion a ring around both legs takes over at p; the rest of the way it hangs from the hips. Cloth
// that hangs off the leg by a gap is moved only once the swinging leg has closed the gap, so of a swing of s it takes
// (s - gap) / s.
double followed_share(const BodyJoints& joints, int thigh, const Vector3d& p) {
  constexpr double kSwing = 1.43;  // tan 55 degrees: between a step (30) and a squat (90)
  const double gap = leg_line(joints, thigh).gap_to(p);
  const double swing = kSwing * (joints[thigh].y() - p.y());
  if (gap <= 0) return 1;
  return swing > gap ? 1 - gap / swing : 0;
}

// What counts of a leg's contact at p: half of it at the knee, where skin and cloth slide over both bones and authors
// let the bend reach farther than heat does.
double knee_share(const BodyJoints& joints, int thigh, const Vector3d& p) {
  constexpr double kReach = 0.3;  // of the thigh's length
  const Vector3d &hip = joints[thigh], &knee = joints[thigh + 1], &ankle = joints[thigh + 2];
  const double along = (p - knee).dot((hip - ankle).normalized()) / std::max((hip - knee).norm(), 1e-9);
  return std::exp2(-std::exp(-0.5 * (along / kReach) * (along / kReach)));
}

// What an arm keeps at p: heat fades slowly over a chest, which is wide, and an arm that hangs turns by half a radian
// from A-pose. With a few hundredths of it the middle of the chest would rise by 3 mm, and where the picture does not
// show that a capture leans the trunk by a degree. No author lets an arm reach there.
double arm_share(const BodyJoints& joints, const Vector3d& p) {
  constexpr double kInner = 0.37, kOuter = 0.9;  // of the way from the middle of the chest out to the shoulder joint
  const Vector3d middle = (joints[kLeftArmBone] + joints[kRightArmBone]) / 2;
  const Vector3d out = (joints[kLeftArmBone] - joints[kRightArmBone]) / 2;
  const double way = std::abs((p - middle).dot(out)) / std::max(out.squaredNorm(), 1e-9);
  return std::clamp((way - kInner) / (kOuter - kInner), 0.0, 1.0);
}

// How much of the hips' weight at p is a tail that heat leaves on legs, down to the knees, where the legs' weights sum
// to `legs`: a thigh's flesh follows the thigh alone, and what stays behind as it is raised tilts the hips of a
// capture. Cloth that hangs off the legs keeps it: it hangs from the hips.
double hips_tail(const BodyJoints& joints, const Vector3d& p, double legs) {
  constexpr double kTail = 0.07;
  constexpr double kClose = 0.1;  // of the thigh's length
  const double length = (joints[kLeftLegBone] - joints[kLeftUpLegBone]).norm();
  const double gap = std::min(leg_line(joints, kLeftUpLegBone).gap_to(p), leg_line(joints, kRightUpLegBone).gap_to(p));
  const double close = std::clamp(1 - gap / std::max(kClose * length, 1e-9), 0.0, 1.0);
  return kTail * close * std::clamp((legs - 0.5) / 0.3, 0.0, 1.0);
}

// Cotangent Laplacian (positive semidefinite) and lumped vertex areas.
Sparse cotangent_laplacian(const meshing::Surface& surface, Eigen::VectorXd& areas) {
  const int n = static_cast<int>(surface.vertices.size());
  areas = Eigen::VectorXd::Zero(n);
  std::vector<Eigen::Triplet<double>> entries;
  for (const auto& t : surface.triangles)
    for (int k = 0; k < 3; ++k) {
      const int i = t[k], a = t[(k + 1) % 3], b = t[(k + 2) % 3];
      const Vector3d u = surface.vertices[a] - surface.vertices[i], v = surface.vertices[b] - surface.vertices[i];
      const double cross = u.cross(v).norm();
      // Obtuse corners and slivers would make it indefinite: each cotangent is clamped.
      const double weight = std::clamp(0.5 * u.dot(v) / std::max(cross, 1e-9), 0.0, 10.0);
      entries.emplace_back(a, b, -weight);
      entries.emplace_back(b, a, -weight);
      entries.emplace_back(a, a, weight);
      entries.emplace_back(b, b, weight);
      areas[i] += cross / 6;
    }
  Sparse laplacian(n, n);
  laplacian.setFromTriplets(entries.begin(), entries.end());
  return laplacian;
}

// The four largest entries, sum 1.
meshing::Influences strongest(Eigen::VectorXd row) {
  meshing::Influences result;
  double sum = 0;
  for (auto& slot : result) {
    int bone;
    const double weight = row.maxCoeff(&bone);
    if (weight < 0.01) break;
    slot = {bone, weight};
    sum += weight;
    row[bone] = 0;
  }
  for (auto& slot : result) slot.weight = sum > 0 ? slot.weight / sum : 0;
  if (!(sum > 0)) result[0] = {kHipsBone, 1.0};
  return result;
}

}  // namespace

std::vector<meshing::Influences> heat_weights(const meshing::Surface& surface, const BodyJoints& joints,
                                              const Volume& volume) {
  const int n = static_cast<int>(surface.vertices.size());
  const auto segments = bone_segments(joints);
  const LegLine left = leg_line(joints, kLeftUpLegBone), right = leg_line(joints, kRightUpLegBone);
  const auto normals = meshing::vertex_normals(surface);
  Eigen::VectorXd areas;
  Sparse system = cotangent_laplacian(surface, areas);
  Eigen::MatrixXd source = Eigen::MatrixXd::Zero(n, kBodyBoneCount);
  for (int i = 0; i < n; ++i) {
    const Vector3d& p = surface.vertices[i];
    std::vector<std::pair<double, int>> order;  // distance, segment
    for (size_t s = 0; s < segments.size(); ++s)
      order.emplace_back((nearest_on(segments[s], p) - p).norm(), static_cast<int>(s));
    std::sort(order.begin(), order.end());
    std::pair<double, int> contact = order.front();
    for (const auto& candidate : order)
      if (sees(volume, p, normals[i], nearest_on(segments[candidate.second], p))) {
        contact = candidate;
        break;
      }
    const double distance = std::max(contact.first, 1.0);
    const int bone = segments[contact.second].bone;
    const int thigh = bone >= kRightUpLegBone ? kRightUpLegBone : kLeftUpLegBone;
    const bool on_leg = bone == thigh || bone == thigh + 1;
    const double knee = on_leg ? knee_share(joints, thigh, p) : 1;
    const double strength = knee * kContactHeat / (distance * distance) * areas[i];
    system.coeffRef(i, i) += strength;
    const double share = on_leg && around_both_legs(left, right, volume, p.y(), 0.5 * volume.step)
                             ? followed_share(joints, thigh, p)
                             : 1;
    source(i, kHipsBone) = (1 - share) * strength;
    source(i, bone) += share * strength;
  }
  const Eigen::SimplicialLDLT<Sparse> factor(system);
  if (factor.info() != Eigen::Success) throw LogicError("skin weights: the heat system cannot be factored");
  const Eigen::MatrixXd weights = factor.solve(source);

  std::vector<meshing::Influences> result(n);
  for (int i = 0; i < n; ++i) {
    const Vector3d& p = surface.vertices[i];
    Eigen::VectorXd row = weights.row(i).cwiseMax(0);
    for (int first : {kLeftArmBone, kRightArmBone}) row.segment(first, kBonesOfAnArm) *= arm_share(joints, p);
    const double legs = row.segment(kLeftUpLegBone, kBonesOfTheLegs).sum();
    row[kHipsBone] = std::max(0.0, row[kHipsBone] - hips_tail(joints, p, legs));
    result[i] = strongest(row);
  }
  return result;
}

}  // namespace livecap::acquire
