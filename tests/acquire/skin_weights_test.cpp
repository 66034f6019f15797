#include "acquire/skin_weights.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "acquire/true_actor.h"
#include "eval/compare_actors.h"
#include "meshing/actor_glb.h"
#include "scan/mesh_volume.h"
#include "support/data_dir.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using acquire::BodyJoints;
using Eigen::Vector3d;

// The actor's mesh and joints with weights of our own, folded onto the 15 bones as a loader does.
SkinWeights own_weights(const Actor& actor) {
  meshing::ActorFile file;
  file.surface = test::surface_of(actor);
  const BodyJoints joints = test::true_joints(actor);
  file.weights = acquire::heat_weights(file.surface, joints, volume_of(file.surface, 8));
  for (int bone = 0; bone < acquire::kBodyBoneCount; ++bone)
    file.bones.push_back({acquire::kBodyBones[bone].name, acquire::kBodyBones[bone].parent, joints[bone]});
  file.labels = actor.labels;
  for (int i = 0; i < actor.n_vertices(); ++i) {
    file.atlas.vertex.push_back(i);
    file.atlas.uvs.emplace_back(0.5, 0.5);
  }
  file.atlas.triangles = file.surface.triangles;
  file.texture = {8, 8, std::vector<uint8_t>(192, 128)};
  return load_actor_bytes(meshing::actor_glb(file), "own").skin;
}

struct PosedError {
  double mean = 0, body_mean = 0;                // mm; body: without skirt
  double collarbones = 0, true_collarbones = 0;  // their share of the upper clothes; ours and the rig's
  double stretch = 0, true_stretch = 0;  // the most an edge of over 5 mm grows, times its length; ours and the rig's
};

PosedError posed_error(const Actor& actor, const SkinWeights& own) {
  PosedError error;
  int64_t n = 0, n_body = 0;
  for (const Eigen::VectorXd& angles : test_poses(actor.skeleton, 20)) {
    const auto a = pose_actor(actor, actor.skeleton, own, angles),
               b = pose_actor(actor, actor.skeleton, actor.skin, angles);
    for (int i = 0; i < actor.n_vertices(); ++i) {
      error.mean += (a[i] - b[i]).norm(), ++n;
      if (actor.labels[i] != 12) error.body_mean += (a[i] - b[i]).norm(), ++n_body;
    }
    for (size_t t = 0; t < actor.mesh.triangles.size(); ++t) {
      const int i = actor.mesh.triangles[t], j = actor.mesh.triangles[t / 3 * 3 + (t + 1) % 3];
      const auto rest = [&](int v) {
        return Eigen::Map<const Eigen::Vector3f>(&actor.mesh.positions[3 * v]).cast<double>().eval();
      };
      if (const double length = (rest(i) - rest(j)).norm(); length > 5) {
        error.stretch = std::max(error.stretch, (a[i] - a[j]).norm() / length);
        error.true_stretch = std::max(error.true_stretch, (b[i] - b[j]).norm() / length);
      }
    }
  }
  int n_upper = 0;
  for (int i = 0; i < actor.n_vertices(); ++i) {
    if (actor.labels[i] != 5) continue;
    ++n_upper;
    for (int k = 4 * i; k < 4 * i + 4; ++k) {
      const auto share = [&](const SkinWeights& skin) {
        return actor.skeleton.bones[skin.bones[k]].name.ends_with("clavicle") ? skin.weights[k] : 0;
      };
      error.collarbones += share(own);
      error.true_collarbones += share(actor.skin);
    }
  }
  error.collarbones /= n_upper;
  error.true_collarbones /= n_upper;
  error.mean /= static_cast<double>(n);
  error.body_mean /= static_cast<double>(n_body);
  return error;
}

void check(const Actor& actor, const std::string& name, double mean_bound) {
  const PosedError error = posed_error(actor, own_weights(actor));
  std::printf(
      "%s: %.1f mm, without skirt %.1f mm, collarbones %.3f of the upper clothes (true rig: %.3f), "
      "longest edge x %.1f (x %.1f)\n",
      name.c_str(), error.mean, error.body_mean, error.collarbones, error.true_collarbones, error.stretch,
      error.true_stretch);
  EXPECT_LT(error.mean, mean_bound) << name;
  EXPECT_LT(error.body_mean, test::kPosedBodyMm) << name;
  EXPECT_LT(std::abs(error.collarbones - error.true_collarbones), test::kCollarboneShare) << name;
  EXPECT_LT(error.stretch, test::kStretchRatio * error.true_stretch) << name;
}

// A rig is one author's choice: how much a skirt follows the legs differs most (built-in: by half, recorded: wholly).
TEST(SkinWeights, PoseLikeTheTrueRig) {
  check(test::builtin_actor("trousers"), "trousers", test::kPosedMm);
  check(test::builtin_actor("skirt"), "skirt", test::kPosedMm);
}

TEST(SkinWeights, PoseLikeTheRecordedRig) {
  LIVECAP_DATA_OR_SKIP(path, "skirt_dance/actor.glb");
  check(load_actor(path), "recorded", test::kPosedMm);
}

// The sum of a vertex' weights on bones whose name ends so.
double share_of(const Actor& actor, const SkinWeights& skin, int vertex, std::initializer_list<const char*> endings) {
  double sum = 0;
  for (int k = 4 * vertex; k < 4 * vertex + 4; ++k) {
    const std::string& bone = actor.skeleton.bones[skin.bones[k]].name;
    if (std::any_of(endings.begin(), endings.end(), [&](const char* end) { return bone.ends_with(end); }))
      sum += skin.weights[k];
  }
  return sum;
}

// Between the hips and the middle of the trunk no author lets an arm move what is not an arm or a sleeve.
TEST(SkinWeights, TheBellyIsNotTheArms) {
  for (const char* name : {"trousers", "skirt"}) {
    const Actor actor = test::builtin_actor(name);
    const SkinWeights own = own_weights(actor);
    const BodyJoints joints = test::true_joints(actor);
    const double hips = joints[acquire::kHipsBone].y(), neck = joints[acquire::kNeckBone].y();
    double mean = 0;
    int n = 0;
    for (int i = 0; i < actor.n_vertices(); ++i) {
      const Vector3d p = Eigen::Map<const Eigen::Vector3f>(&actor.mesh.positions[3 * i]).cast<double>();
      const double up = (p.y() - hips) / (neck - hips);
      if (actor.labels[i] != 5 || up < 0.1 || up > 0.5 || std::abs(p.x()) > joints[acquire::kLeftArmBone].x()) continue;
      mean += share_of(actor, own, i, {"clavicle", "shoulder", "elbow"}), ++n;
    }
    ASSERT_GT(n, 100) << name;
    mean /= n;
    std::printf("%s: arms and collarbones %.4f of the belly\n", name, mean);
    EXPECT_LT(mean, test::kArmsOnBelly) << name;
  }
}

// An arm turns far from where it is in the pictures: what little of it reaches the middle of the chest is a lean of the
// trunk in every frame of a capture.
TEST(SkinWeights, TheMiddleOfTheChestIsNotTheArms) {
  for (const char* name : {"trousers", "skirt"}) {
    const Actor actor = test::builtin_actor(name);
    const SkinWeights own = own_weights(actor);
    const BodyJoints joints = test::true_joints(actor);
    const double hips = joints[acquire::kHipsBone].y(), neck = joints[acquire::kNeckBone].y();
    double mean = 0;
    int n = 0;
    for (int i = 0; i < actor.n_vertices(); ++i) {
      const Vector3d p = Eigen::Map<const Eigen::Vector3f>(&actor.mesh.positions[3 * i]).cast<double>();
      const double up = (p.y() - hips) / (neck - hips);
      if (actor.labels[i] != 5 || up < 0.5 || up > 0.85 || std::abs(p.x()) > 0.5 * joints[acquire::kLeftArmBone].x())
        continue;
      mean += share_of(actor, own, i, {"shoulder", "elbow"}), ++n;
    }
    ASSERT_GT(n, 50) << name;
    mean /= n;
    std::printf("%s: arms %.4f of the middle of the chest\n", name, mean);
    EXPECT_LT(mean, test::kArmsOnChest) << name;
  }
}

// Halfway down a thigh the hips have no more of trousers than the author lets them.
TEST(SkinWeights, ThighsAreNotTheHips) {
  const Actor actor = test::builtin_actor("trousers");
  const SkinWeights own = own_weights(actor);
  const BodyJoints joints = test::true_joints(actor);
  double mean = 0;
  int n = 0;
  for (int i = 0; i < actor.n_vertices(); ++i) {
    const Vector3d p = Eigen::Map<const Eigen::Vector3f>(&actor.mesh.positions[3 * i]).cast<double>();
    const int thigh = p.x() > 0 ? acquire::kLeftUpLegBone : acquire::kRightUpLegBone;
    const Vector3d along = joints[thigh + 1] - joints[thigh];
    const double down = (p - joints[thigh]).dot(along) / along.squaredNorm();
    if (down < 0.35 || down > 0.8 || std::abs(p.x() - joints[thigh].x()) > along.norm() / 2) continue;
    mean += std::abs(share_of(actor, own, i, {"root"}) - share_of(actor, actor.skin, i, {"root"})), ++n;
  }
  ASSERT_GT(n, 100);
  EXPECT_LT(mean / n, test::kHipsOnThigh);
}

// Flesh and cloth bend over a length around a knee: how much of them the thigh moves, against the author's rig, in the
// mean of what lies up to a third of the thigh's length from the knee along the leg.
TEST(SkinWeights, KneesBendAsFarAsTheTrueRigs) {
  for (const char* name : {"trousers", "skirt"}) {
    const Actor actor = test::builtin_actor(name);
    const SkinWeights own = own_weights(actor);
    const BodyJoints joints = test::true_joints(actor);
    double mean = 0;
    int n = 0;
    for (int i = 0; i < actor.n_vertices(); ++i) {
      const Vector3d p = Eigen::Map<const Eigen::Vector3f>(&actor.mesh.positions[3 * i]).cast<double>();
      const int thigh = p.x() > 0 ? acquire::kLeftUpLegBone : acquire::kRightUpLegBone;
      const Vector3d along = joints[thigh] - joints[thigh + 1];
      const double up = (p - joints[thigh + 1]).dot(along) / along.squaredNorm();
      if (actor.labels[i] == 12 || std::abs(up) > 1.0 / 3 || std::abs(p.x() - joints[thigh + 1].x()) > along.norm() / 2)
        continue;
      mean += std::abs(share_of(actor, own, i, {"hip"}) - share_of(actor, actor.skin, i, {"hip"})), ++n;
    }
    ASSERT_GT(n, 100) << name;
    mean /= n;
    EXPECT_LT(mean, test::kThighAtKnee) << name;
  }
}

// The least girth left of an upper arm or forearm whose bone is twisted to its limits: 1 keeps it. A candy wrapper is
// where a limb's vertices fall onto its axis.
double twisted_girth(const Actor& actor, const SkinWeights& skin) {
  double least = 1;
  for (const char* side : {"left_", "right_"}) {
    int twist = 0;
    while (actor.skeleton.dofs.at(twist).name != std::string(side) + "shoulder_x") ++twist;
    const int shoulder = actor.skeleton.bone_index(std::string(side) + "shoulder");
    const int elbow = actor.skeleton.bone_index(std::string(side) + "elbow");
    const PosedSkeleton rest = forward_kinematics(actor.skeleton, rest_pose(actor.skeleton));
    const Vector3d a = rest.camera_from_bone[shoulder].translation(), b = rest.camera_from_bone[elbow].translation();
    const Vector3d axis = (b - a).normalized();
    // The twist's own axis stays in place: the arm turns about its line, whatever the rest angles are.
    for (const double angle : {actor.skeleton.dofs[twist].min_rad, actor.skeleton.dofs[twist].max_rad}) {
      Eigen::VectorXd angles = Eigen::VectorXd::Zero(actor.skeleton.n_dofs());
      angles[twist] = angle;
      Pose pose = rest_pose(actor.skeleton);
      pose.angles_rad = angles;
      const PosedSkeleton posed = forward_kinematics(actor.skeleton, pose);
      const Vector3d a1 = posed.camera_from_bone[shoulder].translation();
      const Vector3d axis1 = (posed.camera_from_bone[elbow].translation() - a1).normalized();
      const auto moved = pose_actor(actor, actor.skeleton, skin, angles);
      for (int i = 0; i < actor.n_vertices(); ++i) {
        const Vector3d p = Eigen::Map<const Eigen::Vector3f>(&actor.mesh.positions[3 * i]).cast<double>();
        const double along = (p - a).dot(axis), off = (p - a).cross(axis).norm();
        // Round the upper arm, not the chest.
        if (along < 0.3 * (b - a).norm() || along > (b - a).norm() || off < 20 || off > 90) continue;
        least = std::min(least, (moved[i] - a1).cross(axis1).norm() / off);
      }
    }
  }
  return least;
}

TEST(SkinWeights, TwistWithoutCandyWrappers) {
  for (const char* name : {"trousers", "skirt"}) {
    const Actor& actor = test::builtin_actor(name);
    const double girth = twisted_girth(actor, own_weights(actor));
    std::printf("%s: twisted upper arms keep %.2f of their girth\n", name, girth);
    EXPECT_GT(girth, test::kTwistedGirth) << name;
  }
}

// What lies in front of the head's joint or behind the ankle is nearer to the neck's and the shank's line.
TEST(SkinWeights, ChinAndHeelBelongToHeadAndFoot) {
  for (const char* name : {"trousers", "skirt"}) {
    const Actor& actor = test::builtin_actor(name);
    const meshing::Surface surface = test::surface_of(actor);
    const auto weights = acquire::heat_weights(surface, test::true_joints(actor), volume_of(surface, 8));
    const auto share = [&](int vertex, int of) {
      double sum = 0;
      for (const auto& [bone, weight] : weights[vertex]) sum += bone == of ? weight : 0;
      return sum;
    };
    int chin = 0;
    const auto to_chin = [&](int v) { return (surface.vertices[v] - actor.keypoints[kChin].rest_position_mm).norm(); };
    for (int i = 0; i < actor.n_vertices(); ++i)
      if (to_chin(i) < to_chin(chin)) chin = i;
    EXPECT_GT(share(chin, acquire::kHeadBone), test::kChinAndHeelShare) << name;
    int heels[] = {-1, -1};  // the rearmost vertex near the floor, left and right
    for (int i = 0; i < static_cast<int>(surface.vertices.size()); ++i) {
      const Vector3d& p = surface.vertices[i];
      int& heel = heels[p.x() < 0];
      if (p.y() < 40 && (heel < 0 || p.z() < surface.vertices[heel].z())) heel = i;
    }
    EXPECT_GT(share(heels[0], acquire::kLeftFootBone), test::kChinAndHeelShare) << name;
    EXPECT_GT(share(heels[1], acquire::kRightFootBone), test::kChinAndHeelShare) << name;
  }
}

// A tube of cloth around two legs, from above the hips to below the knees, closed above and below.
std::vector<meshing::Influences> tube_weights(double side, double depth) {
  const double low = -150, high = 520;
  const meshing::DistanceField field = [&](const Vector3d& p) {
    const double round = (std::hypot(p.x() / side, p.z() / depth) - 1) * std::min(side, depth);
    return std::max({round, low - p.y(), p.y() - high});
  };
  const meshing::Surface surface = meshing::extract_surface(field, {-500, -200, -500}, {500, 570, 500}, 16);
  BodyJoints joints;
  joints.fill(Vector3d(0, 20000, 0));  // out of reach
  joints[acquire::kHipsBone] = {0, 430, 0};
  joints[acquire::kSpineBone] = {0, 600, 0};
  for (const auto& [thigh, x] : {std::pair{acquire::kLeftUpLegBone, 90.0}, {acquire::kRightUpLegBone, -90.0}}) {
    joints[thigh] = {x, 400, 0};
    joints[thigh + 1] = {x, 0, 0};
    joints[thigh + 2] = {x, -400, 0};
    joints[thigh + 3] = {x, -400, 100};
  }
  auto weights = acquire::heat_weights(surface, joints, volume_of(surface, 10));
  // Only the cloth beside the thighs is looked at.
  for (size_t i = weights.size(); i-- > 0;)
    if (surface.vertices[i].y() < 100 || surface.vertices[i].y() > 200) weights.erase(weights.begin() + i);
  return weights;
}

double mean_share_of_legs(const std::vector<meshing::Influences>& weights) {
  double share = 0;
  for (const auto& row : weights)
    for (const auto& [bone, weight] : row) share += bone >= acquire::kLeftUpLegBone ? weight : 0;
  return share / static_cast<double>(weights.size());
}

TEST(SkinWeights, ATubeFollowsTheLegsByItsGap) {
  // The swing at 200 to 300 mm below the hips is 285 to 430 mm; a thigh is 60 to 83 mm thick.
  const double close = mean_share_of_legs(tube_weights(165, 70)), wide = mean_share_of_legs(tube_weights(480, 480));
  const double middle = mean_share_of_legs(tube_weights(290, 200));
  std::printf("share of the legs: %.2f close, %.2f, %.2f wide\n", close, middle, wide);
  EXPECT_GT(close, test::kClingingShare);
  EXPECT_LT(wide, 1 - test::kHangingShare);
  EXPECT_GT(middle, 0.35);
  EXPECT_LT(middle, 0.75);
}

// Independent of any rig: on a cylinder around two bones in line the heat equation is one-dimensional.
TEST(SkinWeights, OfACapsuleFollowTheHeatEquation) {
  const double half = 300, radius = 50;
  const meshing::DistanceField field = [&](const Vector3d& p) {
    return (p - Vector3d(0, std::clamp(p.y(), -half, half), 0)).norm() - radius;
  };
  const meshing::Surface surface = meshing::extract_surface(field, {-90, -390, -90}, {90, 390, 90}, 13);
  BodyJoints joints;
  joints.fill(Vector3d(0, 0, 20000));  // out of reach
  // An arm: around knees contact is weaker.
  joints[acquire::kLeftArmBone] = {0, half, 0};
  joints[acquire::kLeftForeArmBone] = {0, 6.5, 0};  // between two layers of vertices
  joints[acquire::kLeftHandBone] = {0, -half, 0};
  joints[acquire::kLeftKnuckleBone] = {0, -half, 0};
  for (int bone = acquire::kRightArmBone; bone < acquire::kLeftUpLegBone; ++bone) joints[bone] = {-2000, half, 0};
  const auto weights = acquire::heat_weights(surface, joints, volume_of(surface, 10));
  int n_middle = 0;
  for (size_t i = 0; i < weights.size(); ++i) {
    double upper = 0, lower = 0, sum = 0;
    for (const auto& [bone, weight] : weights[i]) {
      sum += weight;
      const bool is_lower = bone > acquire::kLeftArmBone && bone <= acquire::kLeftKnuckleBone;
      (is_lower ? lower : upper) += weight;
    }
    const double y = surface.vertices[i].y() - 6.5;
    EXPECT_NEAR(sum, 1, test::kWeightSum);
    if (std::abs(y) > 240) continue;
    // -u'' + c/r^2 u = c/r^2 on one side: an exponential with the length r / sqrt(c).
    const double expected = 0.5 * std::exp(-std::sqrt(acquire::kContactHeat) * std::abs(y) / radius);
    EXPECT_NEAR(y > 0 ? lower : upper, expected, test::kHeatProfile) << y;
    n_middle += expected > 0.1;
  }
  EXPECT_GT(n_middle, 10);
}

}  // namespace
}  // namespace livecap
