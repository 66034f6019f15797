// The centre of mass against the mesh's own, and what balance says of feet over a while.
#include "pose/balance.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <utility>

#include "livecap/error.h"
#include "support/builtin_actor.h"
#include "support/pose_scene.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using Positions = std::array<Eigen::Vector3d, kKeypointCount>;

const Eigen::Vector3d kUpright = -Eigen::Vector3d::UnitY();

// Of the volume that the mesh encloses, mm: tetrahedra from the origin.
Eigen::Vector3d centre_of_volume(const Actor& actor) {
  const auto vertex = [&](int i) {
    return Eigen::Vector3d(Eigen::Map<const Eigen::Vector3f>(&actor.mesh.positions[3 * size_t(i)]).cast<double>());
  };
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  double volume = 0;
  for (size_t t = 0; t + 2 < actor.mesh.triangles.size(); t += 3) {
    const Eigen::Vector3d a = vertex(actor.mesh.triangles[t]), b = vertex(actor.mesh.triangles[t + 1]),
                          c = vertex(actor.mesh.triangles[t + 2]);
    const double v = a.dot(b.cross(c)) / 6;
    sum += v * (a + b + c) / 4;
    volume += v;
  }
  return sum / volume;
}

Positions positions_of(const Actor& actor, const Pose& pose) {
  return keypoint_positions(actor, forward_kinematics(actor.skeleton, pose));
}

// Sitting on a chair, thighs level.
Pose sitting(const Actor& actor) {
  return test::with_bent_legs(actor, test::standing_pose(actor, 0), -1.5, 1.5);
}

TEST(Balance, TheCentreOfMassIsNearTheBodysVolumes) {
  const Actor actor = test::builtin_actor("trousers");
  const auto mass = centre_of_mass(actor, positions_of(actor, rest_pose(actor.skeleton)));
  ASSERT_TRUE(mass.has_value());
  const Eigen::Vector3d volume = centre_of_volume(actor);
  EXPECT_NEAR(mass->x(), volume.x(), test::kCentreOfMassAcrossMm);
  EXPECT_NEAR(mass->z(), volume.z(), test::kCentreOfMassAcrossMm);
  EXPECT_NEAR(mass->y(), volume.y(), test::kCentreOfMassUpMm);
}

TEST(Balance, ABodyInOnePlaceHasItsMassThere) {
  const Actor actor = test::make_test_actor();
  Positions positions;
  positions.fill({120, -40, 3100});
  EXPECT_LT((*centre_of_mass(actor, positions) - positions[0]).norm(), test::kDoubleExact) << "the shares sum to 1";
  Actor no_neck = actor;
  no_neck.keypoints[kNeck].bone = -1;
  EXPECT_FALSE(centre_of_mass(no_neck, positions).has_value());
  Actor no_elbow = actor;
  no_elbow.keypoints[kLeftElbow].bone = -1;
  EXPECT_FALSE(centre_of_mass(no_elbow, positions).has_value());
}

TEST(Balance, ALegReachesDownWhereOneStands) {
  const Actor actor = test::make_test_actor();
  const Positions stands = positions_of(actor, test::standing_pose(actor, 0.4));
  EXPECT_GT(leg_reach(actor, stands, kUpright), 0.95);
  EXPECT_LT(leg_reach(actor, stands, -kUpright), 0.05);
  const double seated = leg_reach(actor, positions_of(actor, sitting(actor)), kUpright);
  EXPECT_GT(seated, 0.3);
  EXPECT_LT(seated, 0.7);
}

// Standing, and where both ankles and the middle of the soles would have to be to bear the mass.
struct Stand {
  Positions positions;
  Eigen::Vector3d soles_mm;
};

// With ankles and soles `farther_mm` away along the floor from below the centre of mass.
Stand standing(const Actor& actor, double farther_mm) {
  Stand stand{positions_of(actor, test::standing_pose(actor, 0)), {}};
  const Eigen::Vector3d mass = *centre_of_mass(actor, stand.positions);
  const Eigen::Vector3d ankles = (stand.positions[kLeftAnkle] + stand.positions[kRightAnkle]) / 2;
  // What bears the weight is half way between them.
  stand.soles_mm = 2 * (mass + Eigen::Vector3d(0, 0, farther_mm)) - ankles;
  return stand;
}

TEST(Balance, OnlyWhatIsBeyondItCounts) {
  const Actor actor = test::make_test_actor();
  BalanceOptions options;
  options.most_mm = 75;
  const auto excess = [&](double farther_mm) {
    Balance balance(options);
    const Stand stand = standing(actor, farther_mm);
    for (int frame = 0; frame < 5; ++frame)
      EXPECT_TRUE(balance.learn(actor, stand.positions, stand.soles_mm, kUpright));
    return balance.excess_mm();
  };
  EXPECT_DOUBLE_EQ(excess(0), 0);
  EXPECT_DOUBLE_EQ(excess(-70), 0);
  EXPECT_NEAR(excess(-200), -125, test::kDoubleExact);
  EXPECT_NEAR(excess(200), 125, test::kDoubleExact);
}

TEST(Balance, ASoleIsWhereItWouldBearTheMass) {
  const Actor actor = test::make_test_actor();
  BalanceOptions options;
  options.middle_mm = -10;
  const Eigen::Vector3d lowest_mm(200, 1100, 3400);
  SoleInBalance sole(options);
  EXPECT_FALSE(sole.place_mm().has_value());
  for (const auto& [farther_mm, weight] : {std::pair(60.0, 0.6), {500.0, 0.0}, {120.0, 0.6}}) {
    const Stand stand = standing(actor, farther_mm);
    sole.learn(actor, stand.positions, stand.soles_mm, lowest_mm, kUpright, weight);
  }
  const Eigen::Vector3d place_mm = *sole.place_mm();
  EXPECT_NEAR(place_mm.cross(lowest_mm).norm(), 0, test::kDoubleExact * lowest_mm.squaredNorm()) << "seen as before";
  EXPECT_NEAR(lowest_mm.z() - place_mm.z(), 90 + 10, test::kHandComputed);
  const Stand stand = standing(actor, 180);
  sole.learn(actor, stand.positions, stand.soles_mm, lowest_mm, kUpright, 0.3);
  EXPECT_NEAR(lowest_mm.z() - sole.place_mm()->z(), (90 * 1.2 + 180 * 0.3) / 1.5 + 10, test::kHandComputed);
  const Positions seated = positions_of(actor, sitting(actor));
  SoleInBalance none(options);
  none.learn(actor, seated, lowest_mm, lowest_mm, kUpright, 1);
  EXPECT_FALSE(none.place_mm().has_value()) << "who sits tells nothing";
  sole.forget();
  EXPECT_FALSE(sole.place_mm().has_value());
}

TEST(Balance, StepsAreNotItAndItIsForgotten) {
  const Actor actor = test::make_test_actor();
  const Stand before = standing(actor, 250), behind = standing(actor, -250), far = standing(actor, 300);
  BalanceOptions options;
  options.most_mm = 75;
  Balance balance(options);
  for (int frame = 0; frame < 200; ++frame) {  // to and fro
    const Stand& stand = frame % 2 == 0 ? before : behind;
    balance.learn(actor, stand.positions, stand.soles_mm, kUpright);
    if (frame > 10) EXPECT_DOUBLE_EQ(balance.excess_mm(), 0) << frame;
  }
  for (int frame = 0; frame < 400; ++frame) balance.learn(actor, far.positions, far.soles_mm, kUpright);
  EXPECT_NEAR(balance.excess_mm(), 225, 1) << "what was 400 frames ago has a say of exp(-400 / 60)";
  balance.forget();
  EXPECT_DOUBLE_EQ(balance.excess_mm(), 0);
}

TEST(Balance, WhoSitsTellsNothing) {
  const Actor actor = test::make_test_actor();
  const Positions sits = positions_of(actor, sitting(actor));
  const Eigen::Vector3d feet = (sits[kLeftAnkle] + sits[kRightAnkle]) / 2;
  Balance balance{BalanceOptions{}};
  for (int frame = 0; frame < 60; ++frame) EXPECT_FALSE(balance.learn(actor, sits, feet, kUpright));
  EXPECT_DOUBLE_EQ(balance.excess_mm(), 0);
  BalanceOptions all;
  all.least_reach = 0;
  Balance any(all);
  any.learn(actor, sits, feet, kUpright);
  EXPECT_LT(any.excess_mm(), -100) << "the feet of who sits are before the body";
}

// A camera that looks down by 0.3 rad.
TEST(Balance, TheFloorGoesAwayFromTheCamera) {
  const Eigen::Vector3d up(0, -std::cos(0.3), -std::sin(0.3));
  const Eigen::Vector3d away = away_along_floor(up);
  EXPECT_NEAR(away.dot(up), 0, test::kDoubleExact);
  EXPECT_NEAR(away.norm(), 1, test::kDoubleExact);
  EXPECT_GT(away.z(), 0.9);
  EXPECT_LT(away.y(), 0) << "the far floor is higher in the picture";
}

TEST(Balance, BadOptionsAreNamed) {
  for (const auto& [field, member] :
       {std::pair("most_mm", &BalanceOptions::most_mm), std::pair("frames", &BalanceOptions::frames),
        std::pair("least_reach", &BalanceOptions::least_reach), std::pair("share", &BalanceOptions::share),
        std::pair("sole_frames", &BalanceOptions::sole_frames)}) {
    for (double bad : {-1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      BalanceOptions options;
      options.*member = bad;
      try {
        Balance balance(options);
        FAIL() << field << " " << bad;
      } catch (const ConfigError& e) {
        EXPECT_NE(std::string(e.what()).find(std::string("balance: ") + field), std::string::npos) << e.what();
      }
    }
  }
  BalanceOptions nowhere;
  nowhere.middle_mm = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(SoleInBalance{nowhere}, ConfigError);
}

}  // namespace
}  // namespace livecap
