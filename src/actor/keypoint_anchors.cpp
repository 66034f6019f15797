#include "actor/keypoint_anchors.h"

#include <algorithm>
#include <limits>

namespace livecap {
namespace {

constexpr double kTopRegionMm = 10;
constexpr double kKnuckleShareOfHand = 0.5;  // wrist to knuckles, of wrist to finger tips
constexpr double kBallShareOfFoot = 0.75;    // ankle to ball of the foot, of ankle to toe tip

class Extremities {
 public:
  Extremities(const Mesh& mesh, const SkinWeights& skin) : mesh_(mesh), skin_(skin) {}

  Eigen::Vector3d point(int v) const {
    return Eigen::Map<const Eigen::Vector3f>(mesh_.positions.data() + 3 * v).cast<double>();
  }

  // Vertices that follow `bone` more than any other.
  std::vector<int> vertices_of(int bone) const {
    std::vector<int> found;
    for (int v = 0; v < mesh_.n_vertices(); ++v) {
      if (skin_.weights[4 * v] > 0 && skin_.bones[4 * v] == bone) found.push_back(v);
    }
    return found;
  }

  // The vertex of `bone` farthest along `direction`; `fallback` when there is none.
  Eigen::Vector3d farthest(int bone, const Eigen::Vector3d& direction, const Eigen::Vector3d& fallback) const {
    double best = -std::numeric_limits<double>::infinity();
    Eigen::Vector3d result = fallback;
    for (int v : vertices_of(bone)) {
      if (const double along = direction.dot(point(v)); along > best) {
        best = along;
        result = point(v);
      }
    }
    return result;
  }

 private:
  const Mesh& mesh_;
  const SkinWeights& skin_;
};

}  // namespace

std::array<KeypointAnchor, kKeypointCount> place_keypoints(const AnchorInput& input, const Mesh& mesh,
                                                           const SkinWeights& skin, std::vector<std::string>& notes) {
  const RigPositions& p = input.joints_mm;
  const Extremities body(mesh, skin);
  std::array<KeypointAnchor, kKeypointCount> anchors;
  auto set = [&](int keypoint, int bone, const Eigen::Vector3d& position) { anchors[keypoint] = {bone, position}; };

  set(kNeck, kRigNeck, p[kRigNeck]);
  set(kPelvis, kRigRoot, (p[kRigLeftHip] + p[kRigRightHip]) / 2);
  // Hips and shoulders are where a bone starts: they move with its parent, and the bone's own rotation leaves them.
  set(kLeftHip, kRigLeftHip, p[kRigLeftHip]);
  set(kRightHip, kRigRightHip, p[kRigRightHip]);
  set(kLeftShoulder, kRigLeftShoulder, p[kRigLeftShoulder]);
  set(kRightShoulder, kRigRightShoulder, p[kRigRightShoulder]);
  set(kLeftElbow, kRigLeftElbow, p[kRigLeftElbow]);
  set(kRightElbow, kRigRightElbow, p[kRigRightElbow]);
  set(kLeftWrist, kRigLeftElbow, p[kRigLeftWrist]);
  set(kRightWrist, kRigRightElbow, p[kRigRightWrist]);
  set(kLeftKnee, kRigLeftKnee, p[kRigLeftKnee]);
  set(kRightKnee, kRigRightKnee, p[kRigRightKnee]);
  set(kLeftAnkle, kRigLeftAnkle, p[kRigLeftAnkle]);
  set(kRightAnkle, kRigRightAnkle, p[kRigRightAnkle]);

  for (int side = 0; side < 2; ++side) {
    const int elbow = side == 0 ? kRigLeftElbow : kRigRightElbow;
    const int wrist = side == 0 ? kRigLeftWrist : kRigRightWrist;
    const int knuckle = side == 0 ? kRigLeftKnuckle : kRigRightKnuckle;
    const int hand = side == 0 ? kLeftHand : kRightHand;
    if (input.joint_found[knuckle]) {
      set(hand, elbow, p[knuckle]);
    } else {
      const Eigen::Vector3d along = (p[wrist] - p[elbow]).normalized();
      const double length = along.dot(body.farthest(elbow, along, p[wrist]) - p[wrist]);
      set(hand, elbow, p[wrist] + kKnuckleShareOfHand * std::max(length, 0.0) * along);
      notes.push_back(std::string(kKeypointNames[hand]) +
                      ": no middle finger bone; placed halfway to the farthest hand vertex");
    }
    const int ankle = side == 0 ? kRigLeftAnkle : kRigRightAnkle;
    const int toe_joint = side == 0 ? kRigLeftToe : kRigRightToe;
    const int toe = side == 0 ? kLeftToe : kRightToe;
    if (input.joint_found[toe_joint]) {
      set(toe, ankle, p[toe_joint]);
    } else {
      const Eigen::Vector3d tip =
          body.farthest(ankle, Eigen::Vector3d::UnitZ(), p[ankle] + Eigen::Vector3d(0, -60, 150));
      set(toe, ankle, p[ankle] + kBallShareOfFoot * (tip - p[ankle]));
      notes.push_back(std::string(kKeypointNames[toe]) + ": no toe bone; placed from the foot's front vertex");
    }
  }

  // Head: top region of what follows the neck bone, then the face relative to the head's box.
  const std::vector<int> head = body.vertices_of(kRigNeck);
  Eigen::Vector3d low = p[kRigNeck], high = p[kRigNeck] + Eigen::Vector3d(0, 250, 0);
  if (!head.empty()) {
    double top = -std::numeric_limits<double>::infinity();
    for (int v : head) top = std::max(top, body.point(v).y());
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int n = 0;
    const double chin_level =
        input.joint_found[kRigHead] ? p[kRigHead].y() : p[kRigNeck].y() + kChinHeight * (top - p[kRigNeck].y());
    low = Eigen::Vector3d::Constant(std::numeric_limits<double>::infinity());
    high = -low;
    for (int v : head) {
      const Eigen::Vector3d x = body.point(v);
      if (x.y() > top - kTopRegionMm) {
        sum += x;
        ++n;
      }
      if (x.y() < chin_level && x.y() < top - kTopRegionMm) continue;
      low = low.cwiseMin(x);
      high = high.cwiseMax(x);
    }
    set(kHeadTop, kRigNeck, sum / n);
  } else {
    set(kHeadTop, kRigNeck, high);
    notes.push_back("no vertex follows the neck bone; head keypoints are placed at default distances");
  }
  const Eigen::Vector3d box = high - low;
  const double middle = (low.x() + high.x()) / 2;
  struct FacePoint {
    int keypoint;
    double x, y;  // share of the head box: from its middle, from its bottom
  };
  bool guessed = false;
  for (const FacePoint& f : {FacePoint{kLeftEye, 0.2, 0.5}, FacePoint{kRightEye, -0.2, 0.5}, FacePoint{kNose, 0, 0.36},
                             FacePoint{kChin, 0, 0.08}}) {
    const auto marker = input.marker_vertices.find(std::string(kKeypointNames[f.keypoint]));
    if (marker != input.marker_vertices.end()) {
      set(f.keypoint, kRigNeck, body.point(marker->second));
      continue;
    }
    // The foremost head vertex near that place of the frontal view.
    const Eigen::Vector3d target(middle + f.x * box.x(), low.y() + f.y * box.y(), high.z());
    Eigen::Vector3d best = target;
    double best_z = -std::numeric_limits<double>::infinity();
    for (int v : head) {
      const Eigen::Vector3d x = body.point(v);
      if (std::abs(x.x() - target.x()) < 0.08 * box.x() && std::abs(x.y() - target.y()) < 0.06 * box.y() &&
          x.z() > best_z) {
        best_z = x.z();
        best = x;
      }
    }
    set(f.keypoint, kRigNeck, best);
    guessed = true;
  }
  if (guessed) notes.push_back("face markers guessed from the head's shape (extras.livecap.markers would be exact)");

  for (const auto& [name, offset] : input.offsets_mm) {
    const auto known = std::find(kKeypointNames.begin(), kKeypointNames.end(), name);
    if (known == kKeypointNames.end()) {
      notes.push_back("extras.livecap.keypoints: there is no keypoint \"" + name + "\"; ignored");
    } else {
      anchors[known - kKeypointNames.begin()].rest_position_mm += offset;
    }
  }
  return anchors;
}

}  // namespace livecap
