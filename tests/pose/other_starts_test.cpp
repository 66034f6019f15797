// The poses that stage I also tries when a pattern, or the other shoe, may have led it astray.
#include "pose/other_starts.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <string>
#include <vector>

#include "support/builtin_actor.h"
#include "support/pose_scene.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

PoseOptions as_detected() {
  PoseOptions options;
  options.rebone = false;
  return options;
}

double facing_rad(const Pose& from, const Pose& to) {
  return vector_from_rotation(to.root_rotation * from.root_rotation.transpose()).norm();
}

TEST(OtherStarts, ATrunkIsTurnedToWhereTheDetectionsFace) {
  const Actor actor = test::make_test_actor();
  const Camera camera = test::portrait_camera();
  for (const double facing : {-0.9, -0.3, 0.3, 2.9}) {
    const Pose truth = test::standing_pose(actor, facing);
    const Pose strayed = test::standing_pose(actor, facing + 0.35);
    const Detections detections = test::exact_detections(actor, camera, truth);
    const auto turned = turned_trunk(actor, strayed, detections, as_detected(), 0.21);
    ASSERT_TRUE(turned.has_value()) << facing;
    EXPECT_LT(facing_rad(*turned, truth), test::kTurnedTrunkRad) << facing;
    EXPECT_EQ(turned->root_translation_mm, strayed.root_translation_mm);
    EXPECT_FALSE(turned_trunk(actor, strayed, detections, as_detected(), 0.5).has_value()) << facing;
  }
}

// A twist between hips and shoulders is no trunk that faces elsewhere.
TEST(OtherStarts, ATwistedTrunkIsLeftAlone) {
  const Actor& actor = test::builtin_actor("trousers");
  Pose twisted = test::standing_pose(actor, 0.3);
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k)
    if (actor.skeleton.dofs[k].name == "chest_y") twisted.angles_rad[k] = 0.7;
  const Detections detections = test::exact_detections(actor, test::portrait_camera(), twisted);
  EXPECT_FALSE(turned_trunk(actor, twisted, detections, as_detected(), 0.1).has_value());
  Pose strayed = twisted;
  strayed.root_rotation = rotation_from_vector(Eigen::Vector3d(0, 0.3, 0)) * twisted.root_rotation;
  const auto turned = turned_trunk(actor, strayed, detections, as_detected(), 0.21);
  ASSERT_TRUE(turned.has_value());
  EXPECT_LT(facing_rad(*turned, twisted), test::kTurnedTrunkRad);
}

TEST(OtherStarts, APelvisTurnsBackUnderTheChestWhichStays) {
  const Actor& actor = test::builtin_actor("skirt");
  const auto dof = [&](const char* name) {
    const auto& dofs = actor.skeleton.dofs;
    return std::find_if(dofs.begin(), dofs.end(), [&](const Dof& d) { return d.name == name; }) - dofs.begin();
  };
  const auto rotation = [&](const Pose& pose, const char* bone) -> Eigen::Matrix3d {
    return forward_kinematics(actor.skeleton, pose).camera_from_bone[actor.skeleton.bone_index(bone)].linear();
  };
  for (const double twist : {-0.7, 0.5}) {
    Pose twisted = test::standing_pose(actor, 0.3);
    twisted.angles_rad[dof("chest_x")] = 0.4;
    twisted.angles_rad[dof("chest_z")] = -0.2;
    const Pose straight = twisted;
    twisted.angles_rad[dof("chest_y")] = twist;
    const auto untwisted = untwisted_pelvis(actor, twisted, 0.35);
    ASSERT_TRUE(untwisted.has_value()) << twist;
    EXPECT_EQ(untwisted->angles_rad, straight.angles_rad);
    EXPECT_EQ(untwisted->root_translation_mm, twisted.root_translation_mm);
    EXPECT_LT((rotation(*untwisted, "chest") - rotation(twisted, "chest")).norm(), test::kDoubleExact);
    EXPECT_GT(facing_rad(*untwisted, twisted), 0.9 * std::abs(twist));
    EXPECT_FALSE(untwisted_pelvis(actor, twisted, 0.75).has_value()) << twist;
  }
}

TEST(OtherStarts, WhoLeansTowardsTheCameraHasTheHeadNearer) {
  const Actor actor = test::make_test_actor();
  const Pose upright = test::standing_pose(actor, 0.4);
  const Pose leaning = leant(upright, 0.3);
  const auto neck = [&](const Pose& pose) -> Eigen::Vector3d {
    return keypoint_positions(actor, forward_kinematics(actor.skeleton, pose))[kNeck] - pose.root_translation_mm;
  };
  EXPECT_EQ(leaning.root_translation_mm, upright.root_translation_mm);
  const Eigen::Vector3d before = neck(upright), after = neck(leaning);
  EXPECT_NEAR(after.x(), before.x(), 1e-9);
  EXPECT_NEAR(after.norm(), before.norm(), 1e-9);
  EXPECT_NEAR(std::atan2(-after.z(), -after.y()) - std::atan2(-before.z(), -before.y()), 0.3, 1e-9);
}

TEST(OtherStarts, OtherLegsStandBelowTheBody) {
  const Actor& actor = test::builtin_actor("trousers");
  const Pose pose = test::standing_pose(actor, 0.3);
  Pose behind = pose;  // as legs that the network sees straight are found
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k)
    if (actor.skeleton.dofs[k].name.ends_with("_hip_x")) behind.angles_rad[k] = 0.4;
  const std::vector<Pose> starts = with_other_legs(actor.skeleton, behind);
  ASSERT_EQ(starts.size(), 4u);
  const Eigen::Vector3d down = Eigen::Vector3d::UnitY(), ahead = pose.root_rotation.col(2);
  struct LegKeypoint {
    const char* hip;
    Keypoint thigh, knee, ankle;
    bool is_other[4];  // in that start
  };
  for (const LegKeypoint& leg :
       {LegKeypoint{"left_hip", kLeftHip, kLeftKnee, kLeftAnkle, {true, true, true, false}},
        LegKeypoint{"right_hip", kRightHip, kRightKnee, kRightAnkle, {true, true, false, true}}}) {
    for (size_t i = 0; i < starts.size(); ++i) {
      SCOPED_TRACE(std::string(leg.hip) + ", start " + std::to_string(i));
      const auto points = keypoint_positions(actor, forward_kinematics(actor.skeleton, starts[i]));
      const Eigen::Vector3d thigh = points[leg.knee] - points[leg.thigh], whole = points[leg.ankle] - points[leg.thigh];
      if (!leg.is_other[i]) {
        for (int k = 0; k < actor.skeleton.n_dofs(); ++k)
          if (hangs_on(actor.skeleton, actor.skeleton.dofs[k].bone, actor.skeleton.bone_index(leg.hip)))
            EXPECT_EQ(starts[i].angles_rad[k], behind.angles_rad[k]);
        continue;
      }
      if (i > 0) EXPECT_GT(ahead.dot(thigh), 0.4 * thigh.norm()) << "knees bend forward";
      EXPECT_GT(down.dot(whole), 0.9 * whole.norm()) << "the foot is below the hip";
      const double leg_mm = thigh.norm() + (points[leg.ankle] - points[leg.knee]).norm();
      EXPECT_NEAR(whole.norm() / leg_mm, i == 0 ? 1 : i == 1 ? std::cos(0.8) : std::cos(0.45), 0.05);
    }
  }
}

// Network depth leans whole bodies; that is not what this is about.
TEST(OtherStarts, ALeanIsLeftAlone) {
  const Actor actor = test::make_test_actor();
  const Pose upright = test::standing_pose(actor, 0.4);
  Pose leaning = upright;
  leaning.root_rotation = rotation_from_vector(Eigen::Vector3d(0.5, 0, 0)) * upright.root_rotation;
  const Detections detections = test::exact_detections(actor, test::portrait_camera(), upright);
  EXPECT_FALSE(turned_trunk(actor, leaning, detections, as_detected(), 0.21).has_value());
  Detections nobody = detections;
  nobody.person = false;
  EXPECT_FALSE(turned_trunk(actor, test::standing_pose(actor, 1.4), nobody, as_detected(), 0.21).has_value());
}

TEST(OtherStarts, AnArmThatPointsAwayFromTheCameraIsBentTowardsIt) {
  const Actor& actor = test::builtin_actor("trousers");
  const Camera camera = test::portrait_camera();
  const auto reaching = [&](double rad) {
    Pose pose = test::standing_pose(actor, 0);
    for (int k = 0; k < actor.skeleton.n_dofs(); ++k)
      if (actor.skeleton.dofs[k].name == "right_shoulder_y") pose.angles_rad[k] = rad;
    return pose;
  };
  const auto elbow_mm = [&](const Pose& pose) {
    const auto points = keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
    return (points[kRightElbow] - points[kRightShoulder]).z();
  };
  const Pose truth = reaching(0.7), away = reaching(-0.5);
  ASSERT_GT(std::abs(elbow_mm(truth) - elbow_mm(away)), 200);
  Detections detections = test::exact_detections(actor, camera, truth);
  const auto all_bent = [&](const Pose& pose, double least_depth_mm) {
    std::vector<Pose> all;
    with_detected_arms(actor, camera, pose, detections, as_detected(), {1e6, least_depth_mm}, [&](const Pose& bent) {
      all.push_back(bent);
      return bent;
    });
    return all;
  };
  EXPECT_TRUE(all_bent(truth, 80).empty());
  EXPECT_TRUE(all_bent(reaching(0.2), 80).empty()) << "less far, but the same way";
  EXPECT_TRUE(all_bent(away, 1000).empty());
  const std::vector<Pose> bent = all_bent(away, 80);
  ASSERT_EQ(bent.size(), 1u);
  EXPECT_NEAR(elbow_mm(bent[0]), elbow_mm(truth), test::kInitializedMm);
  detections.keypoints[kRightElbow].confidence = 0.3f;
  EXPECT_TRUE(all_bent(away, 80).empty()) << "the network does not see it";
}

TEST(OtherStarts, AFootStandsOnItsEdgeWhereItIsTiltedAndStill) {
  const Actor& actor = test::builtin_actor("trousers");
  const Eigen::Vector3d up = -Eigen::Vector3d::UnitY();
  const auto pointing = [&](double rad) {
    Pose pose = test::standing_pose(actor, 0.2);
    for (int k = 0; k < actor.skeleton.n_dofs(); ++k)
      if (actor.skeleton.dofs[k].name == "left_ankle_x") pose.angles_rad[k] = rad;
    return pose;
  };
  const Pose flat = pointing(0), toes = pointing(0.7), heel = pointing(-0.6);
  EXPECT_FALSE(stands_on_edge(actor, flat, flat, up, 0.5));
  EXPECT_TRUE(stands_on_edge(actor, toes, toes, up, 0.5));
  EXPECT_TRUE(stands_on_edge(actor, heel, heel, up, 0.5));
  EXPECT_FALSE(stands_on_edge(actor, heel, heel, up, 0.65));
  EXPECT_FALSE(stands_on_edge(actor, pointing(0.4), pointing(0.4), up, 0.5));
  Pose before = toes, nearer = toes;
  before.root_translation_mm.x() += 30;
  nearer.root_translation_mm *= 1.02;
  EXPECT_FALSE(stands_on_edge(actor, toes, before, up, 0.5)) << "it is lifted";
  EXPECT_TRUE(stands_on_edge(actor, toes, nearer, up, 0.5)) << "along the line of sight";
  EXPECT_TRUE(stands_on_edge(actor, flat, flat, Eigen::Vector3d(0, -std::cos(0.7), -std::sin(0.7)), 0.5));
}

TEST(OtherStarts, OnlyALegFarFromItsAnkleIsBentAnew) {
  const Actor actor = test::make_test_actor();
  const Camera camera = test::portrait_camera();
  const Pose truth = test::standing_pose(actor, 0);
  const Detections detections = test::exact_detections(actor, camera, truth);
  Pose strayed = truth;
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
    const std::string& name = actor.skeleton.dofs[k].name;
    if (name == "left_hip_z") strayed.angles_rad[k] += 0.4;
    if (name == "right_knee_x" || name == "left_shoulder_z") strayed.angles_rad[k] += 0.05;
  }
  EXPECT_FALSE(with_detected_legs(actor, camera, truth, detections, as_detected(), 20).has_value());
  const auto bent = with_detected_legs(actor, camera, strayed, detections, as_detected(), 20);
  ASSERT_TRUE(bent.has_value());
  const auto keypoints = [&](const Pose& pose) {
    return keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  };
  EXPECT_GT((keypoints(strayed)[kLeftAnkle] - keypoints(truth)[kLeftAnkle]).norm(), 100);
  EXPECT_LT((keypoints(*bent)[kLeftAnkle] - keypoints(truth)[kLeftAnkle]).norm(), test::kInitializedMm);
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
    const std::string& name = actor.skeleton.dofs[k].name;
    if (name.starts_with("left_hip") || name.starts_with("left_knee") || name.starts_with("left_ankle")) continue;
    EXPECT_EQ(bent->angles_rad[k], strayed.angles_rad[k]) << name;
  }
  Detections unsure = detections;
  unsure.keypoints[kLeftAnkle].confidence = 0.3f;
  EXPECT_FALSE(with_detected_legs(actor, camera, strayed, unsure, as_detected(), 20).has_value());
}

TEST(OtherStarts, EachArmFarFromItsElbowOrWristIsBentAnew) {
  const Actor actor = test::make_test_actor();
  const Camera camera = test::portrait_camera();
  const Pose truth = test::standing_pose(actor, 0);
  const Detections detections = test::exact_detections(actor, camera, truth);
  const auto keypoints = [&](const Pose& pose) {
    return keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
  };
  const auto with_turned = [&](std::initializer_list<const char*> names) {
    Pose pose = truth;
    for (int k = 0; k < actor.skeleton.n_dofs(); ++k)
      for (const char* name : names)
        if (actor.skeleton.dofs[k].name == name) pose.angles_rad[k] += 0.5;
    return pose;
  };
  const auto all_bent = [&](const Pose& pose, const Detections& seen, bool are_better = false) {
    std::vector<Pose> all;
    with_detected_arms(actor, camera, pose, seen, as_detected(), {20, 1e6}, [&](const Pose& bent) {
      all.push_back(bent);
      return are_better ? bent : pose;
    });
    return all;
  };
  EXPECT_TRUE(all_bent(truth, detections).empty());
  const Pose left = with_turned({"left_shoulder_z", "left_hip_z"});
  const std::vector<Pose> bent = all_bent(left, detections);
  ASSERT_EQ(bent.size(), 1u);
  EXPECT_GT((keypoints(left)[kLeftWrist] - keypoints(truth)[kLeftWrist]).norm(), 100);
  EXPECT_LT((keypoints(bent[0])[kLeftWrist] - keypoints(truth)[kLeftWrist]).norm(), test::kInitializedMm);
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
    const std::string& name = actor.skeleton.dofs[k].name;
    if (name.starts_with("left_shoulder") || name.starts_with("left_elbow")) continue;
    EXPECT_EQ(bent[0].angles_rad[k], left.angles_rad[k]) << name;
  }
  const Pose both = with_turned({"left_shoulder_z", "right_shoulder_z"});
  const std::vector<Pose> alone = all_bent(both, detections), after = all_bent(both, detections, true);
  ASSERT_EQ(alone.size(), 2u);
  ASSERT_EQ(after.size(), 2u);
  EXPECT_EQ(after[0].angles_rad, alone[0].angles_rad);
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
    const std::string& name = actor.skeleton.dofs[k].name;
    const bool of_left = name.starts_with("left_shoulder") || name.starts_with("left_elbow");
    EXPECT_EQ(after[1].angles_rad[k], alone[of_left ? 0 : 1].angles_rad[k]) << name;
  }
  Detections nobody = detections;
  nobody.person = false;
  EXPECT_TRUE(all_bent(both, nobody).empty());
  for (const float confidence : {0.0f, NAN}) {
    Detections unknown = detections;
    unknown.keypoints[kLeftWrist].confidence = confidence;
    EXPECT_EQ(all_bent(both, unknown).size(), 2u) << "by its elbow";
    unknown.keypoints[kLeftElbow].confidence = confidence;
    EXPECT_EQ(all_bent(both, unknown).size(), 1u);
  }
}

}  // namespace
}  // namespace livecap
