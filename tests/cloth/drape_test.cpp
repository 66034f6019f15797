#include "cloth/drape.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <random>

#include "cloth/hanging_cloth.h"
#include "cloth/scene.h"
#include "livecap/error.h"
#include "match/layout.h"
#include "support/kernel_bodies.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using Told = std::array<float, LC_DRAPE_TOLD>;

constexpr float kLimp = 1;
constexpr double kSeconds = 1 / 30.0;

DrapeOptions sure() {
  DrapeOptions options;
  options.clings_doubt_mm = options.narrows_doubt_mm = 1e-3f;
  options.independent_parts = 1e9f;
  return options;
}

// Weight 2, ways of 30 and 20 mm at right angles, matches 12 mm along the first and 2 along the second.
constexpr Told kSeen = {2 * 900, 0, 2 * 400, 2 * 360, 2 * 40, 2 * 148, 2, 0};

TEST(Drape, NothingSeenMovesNothing) {
  const DrapeEvidence evidence{DrapeOptions()};
  EXPECT_EQ(evidence.shares().clings, 0);
  EXPECT_EQ(evidence.shares().narrows, 0);
}

TEST(Drape, SharesAreThoseOfTheEquations) {
  DrapeEvidence evidence(sure());
  evidence.add(kSeen, {}, kSeconds);
  EXPECT_NEAR(evidence.shares().clings, 0.4, test::kDrapeShare);
  EXPECT_NEAR(evidence.shares().narrows, 0.1, test::kDrapeShare);
}

// One frame whose places are as far apart as the doubt: half of what it shows.
TEST(Drape, DoubtHalves) {
  DrapeOptions options = sure();
  options.clings_doubt_mm = 30;
  options.narrows_doubt_mm = 20;
  DrapeEvidence evidence(options);
  evidence.add(kSeen, {}, kSeconds);
  EXPECT_NEAR(evidence.shares().clings, 0.2, test::kDrapeShare);
  EXPECT_NEAR(evidence.shares().narrows, 0.05, test::kDrapeShare);
}

// 148 mm^2, of which 0.4^2 * 900 + 0.1^2 * 400 = 148 are explained; 100 more are not: 1 - 100 / (4 * 148).
TEST(Drape, WhatExplainsLittleIsShrunk) {
  DrapeOptions options = sure();
  options.independent_parts = 4;
  Told seen = kSeen;
  seen[5] += 2 * 100;
  DrapeEvidence evidence(options);
  evidence.add(seen, {}, kSeconds);
  EXPECT_NEAR(evidence.shares().clings, 0.4 * (1 - 100 / (4 * 148.0)), test::kDrapeShare);
  seen[5] = 2 * 10000;
  DrapeEvidence unsure(options);
  unsure.add(seen, {}, kSeconds);
  EXPECT_EQ(unsure.shares().clings, 0);
}

// Seen from where it was moved to already, the same is left of it.
TEST(Drape, CountsFromTheSimulatedPlace) {
  DrapeEvidence evidence(sure());
  const double by = 0.3;
  Told left = kSeen;
  left[3] = float(2 * (12 - 30 * by) * 30);
  left[5] = float(2 * (std::pow(12 - 30 * by, 2) + 4));
  evidence.add(left, {by, 0}, kSeconds);
  EXPECT_NEAR(evidence.shares().clings, 0.4, test::kDrapeShare);
  EXPECT_NEAR(evidence.shares().narrows, 0.1, test::kDrapeShare);
}

// After 1 s a frame counts by 1 / e of the same seen now.
TEST(Drape, ForgetsByTime) {
  DrapeEvidence evidence(sure());
  Told nothing = kSeen;
  nothing[3] = nothing[4] = nothing[5] = 0;
  evidence.add(kSeen, {}, kSeconds);
  evidence.add(nothing, {}, 1.0);
  EXPECT_NEAR(evidence.shares().clings, 0.4 / (1 + std::exp(1.0)), test::kDrapeShare);
}

TEST(Drape, SharesHaveBounds) {
  DrapeEvidence clinging(sure()), swinging(sure());
  clinging.add({900, 0, 400, 9e4f, 9e4f, 1e7f, 1, 0}, {}, kSeconds);
  EXPECT_NEAR(clinging.shares().clings, 1, test::kDrapeShare);
  EXPECT_NEAR(clinging.shares().narrows, sure().narrows_to, test::kDrapeShare);
  swinging.add({900, 0, 400, -9e4f, -9e4f, 1e7f, 1, 0}, {}, kSeconds);
  EXPECT_EQ(swinging.shares().clings, 0);
  EXPECT_NEAR(swinging.shares().narrows, sure().narrows_from, test::kDrapeShare);
}

// A frame in which nothing is matched changes nothing, and neither does one whose sums are none.
TEST(Drape, WhatIsNotSeenIsNotForgotten) {
  DrapeOptions options = sure();
  options.clings_doubt_mm = 30;
  options.narrows_doubt_mm = 20;
  DrapeEvidence evidence(options);
  evidence.add(kSeen, {}, kSeconds);
  evidence.add({}, {}, kSeconds);
  Told none{};
  none[3] = NAN;
  evidence.add(none, {}, kSeconds);
  EXPECT_NEAR(evidence.shares().clings, 0.2, test::kDrapeShare);
  EXPECT_NEAR(evidence.shares().narrows, 0.05, test::kDrapeShare);
}

// Ways that are not at right angles: with one share at its bound the other is the best there. 20 mm along the second of
// ways (30, 0) and (20, 20): without bounds -0.67 and 1.
TEST(Drape, TheOtherShareIsTheBestAtABound) {
  DrapeOptions options = sure();
  options.narrows_to = 0.5f;
  DrapeEvidence evidence(options);
  evidence.add({900, 600, 800, 0, 400, 400, 1, 0}, {}, kSeconds);
  EXPECT_EQ(evidence.shares().clings, 0);
  EXPECT_NEAR(evidence.shares().narrows, 0.5, test::kDrapeShare);
  DrapeOptions narrow = sure();
  narrow.narrows_to = 0;
  DrapeEvidence bounded(narrow);
  bounded.add({900, 600, 800, 300, 400, 200, 1, 0}, {}, kSeconds);  // 10 mm along both axes
  EXPECT_NEAR(bounded.shares().clings, 1 / 3.0, test::kDrapeShare);
  EXPECT_EQ(bounded.shares().narrows, 0);
}

// A skirt before a camera, hanging straight down its negative y, whose simulated place is beside its skinned one.
class DrapeScene {
 public:
  explicit DrapeScene(ocl::DeviceContext& device, double left_hip_rad = 0)
      : actor_(test::skirt_actor()),
        graph_(make_cloth_graph(actor_, 0.15f)),
        posed_(forward_kinematics(actor_.skeleton, pose())),
        device_(device),
        drape_(device, actor_, graph_, kLimp, camera(), sure()) {
    if (left_hip_rad != 0) {
      Pose lifted = pose();
      lifted.angles_rad[0] = left_hip_rad;
      posed_ = forward_kinematics(actor_.skeleton, lifted);
    }
    std::mt19937 random(5);
    std::normal_distribution<float> aside(0, 15);
    const Eigen::Vector3d at = middle();
    for (size_t k = 0; k < actor_.mesh.positions.size(); ++k) {
      simulated_.push_back(actor_.mesh.positions[k] + float(at[int(k % 3)]));
      skinned_.push_back(simulated_.back() + 20 + aside(random));
    }
  }

  static Camera camera() {
    Camera camera;
    camera.width = 600, camera.height = 800, camera.fx = camera.fy = 900, camera.cx = 299.5, camera.cy = 399.5;
    return camera;
  }
  static Eigen::Vector3d middle() { return {40, -20, 2500}; }
  static Eigen::Vector3d up() { return Eigen::Vector3d::UnitY(); }
  Pose pose() const {
    Pose pose = test::pose_of(actor_.skeleton);
    pose.root_translation_mm = middle();
    return pose;
  }

  // Where a vertex is that goes so far, from the definition.
  Eigen::Vector3d draped(int i, const DrapeShares& shares, double trusted = 1) const {
    const Eigen::Vector3d at = point(simulated_, i), from = at - middle();
    const double hem = -test::kRingMm * (test::kRings - 1) + test::kSeamAboveHipsMm;
    const double level = std::clamp(actor_.mesh.positions[3 * i + 1] / hem, 0.0, 1.0);
    return at + trusted * shares.clings * (point(skinned_, i) - at) -
           shares.narrows * level * Eigen::Vector3d(from.x(), 0, from.z());
  }

  struct Moved {
    std::vector<float> skinned, start, start_before;
  };

  // One frame, in which matches show cloth draped by `shares`. Returns where it was moved to before.
  Moved see(const DrapeShares& shares) {
    const int n = actor_.n_vertices();
    std::vector<float> matches(size_t(LC_MATCH) * n, 0.0f);
    for (int i = 0; i < n; ++i) {
      const Eigen::Vector3d p = draped(i, shares);
      const Camera c = camera();
      matches[LC_MATCH * i] = float(c.fx * p.x() / p.z() + c.cx);
      matches[LC_MATCH * i + 1] = float(c.fy * p.y() / p.z() + c.cy);
      matches[LC_MATCH * i + 2] = matches[LC_MATCH * i + 4] = 1;
      matches[LC_MATCH * i + LC_MATCH_WEIGHT_PX] = i % 5 == 0 ? 0.0f : float(1 + i % 3);
      if (i % 4 == 0) {  // certain across alone
        matches[LC_MATCH * i + 1] += 100;
        matches[LC_MATCH * i + 4] = 0;
      }
      if (i % 7 == 0) matches[LC_MATCH * i] += 1000;  // not visible: does not count
    }
    std::vector<int32_t> visible(n);
    for (int i = 0; i < n; ++i) visible[i] = i % 7 != 0;
    ocl::Buffer<float> skinned(device_, skinned_), start(device_, simulated_), before(device_, simulated_);
    drape_.keep(skinned);
    skinned.write(simulated_);
    drape_.move(posed_, up(), skinned, start, before);
    drape_.look({device_, visible}, skinned, {device_, matches});
    const Moved moved{skinned.read_all(), start.read_all(), before.read_all()};
    drape_.learn(kSeconds);
    return moved;
  }

  void expect_draped(const std::vector<float>& got, const DrapeShares& shares, double trusted = 1) const {
    int n_moved = 0;
    for (int p = 0; p < graph_.n_particles(); ++p) {
      const int i = graph_.vertices[p];
      const Eigen::Vector3d expected = graph_.held[p] ? point(simulated_, i) : draped(i, shares, trusted);
      EXPECT_NEAR((point(got, i) - expected).norm(), 0, test::kMillimetreFloat) << i;
      n_moved += !graph_.held[p];
    }
    EXPECT_GT(n_moved, 100);
  }

  Drape& drape() { return drape_; }

 private:
  static Eigen::Vector3d point(const std::vector<float>& points, int i) {
    return {points[3 * i], points[3 * i + 1], points[3 * i + 2]};
  }

  Actor actor_;
  ClothGraph graph_;
  PosedSkeleton posed_;
  ocl::DeviceContext& device_;
  Drape drape_;
  std::vector<float> simulated_, skinned_;
};

TEST(Drape, LearnsFromMatchesAndMovesSo) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    DrapeScene scene(device);
    const DrapeShares truth{0.4, 0.15};
    scene.expect_draped(scene.see(truth).skinned, {});
    std::array<DrapeShares, 2> before;
    for (int frame = 0; frame < 3; ++frame) {
      EXPECT_NEAR(scene.drape().shares().clings, truth.clings, test::kDrapeMatched);
      EXPECT_NEAR(scene.drape().shares().narrows, truth.narrows, test::kDrapeMatched);
      const DrapeShares known = scene.drape().shares();
      const auto moved = scene.see(truth);
      scene.expect_draped(moved.skinned, known);
      scene.expect_draped(moved.start, before[0]);
      scene.expect_draped(moved.start_before, before[1]);
      before = {known, before[0]};
    }
    scene.drape().reset();
    const auto anew = scene.see(truth);
    scene.expect_draped(anew.skinned, {});
    scene.expect_draped(anew.start, {});
  });
}

// Where a thigh is lifted halfway from what is trusted to what is not.
TEST(Drape, SkinningIsNotTrustedOnLiftedThighs) {
  const DrapeOptions options = sure();
  const double halfway = (options.lifted_from_deg + options.lifted_to_deg) / 2 * M_PI / 180;
  test::on_every_device([&](ocl::DeviceContext& device) {
    DrapeScene lifted(device, halfway), folded(device, 1.2);
    lifted.see({0.2, 0});
    const DrapeShares known = lifted.drape().shares();
    EXPECT_NEAR(known.clings, 0.4, test::kDrapeMatched) << "of a way that is half as long";
    lifted.expect_draped(lifted.see({0.2, 0}).skinned, known, 0.5);
    folded.see({0.4, 0});
    EXPECT_EQ(folded.drape().shares().clings, 0);
  });
}

TEST(Drape, RefusesWhatMakesNoSense) {
  const auto refused = [](auto&& change) {
    DrapeOptions options;
    change(options);
    EXPECT_THROW(options.validate(), ConfigError);
  };
  refused([](DrapeOptions& o) { o.memory_s = 0; });
  refused([](DrapeOptions& o) { o.clings_doubt_mm = NAN; });
  refused([](DrapeOptions& o) { o.narrows_doubt_mm = -1; });
  refused([](DrapeOptions& o) { o.independent_parts = 0; });
  refused([](DrapeOptions& o) { o.narrows_from = 0.1f; });
  refused([](DrapeOptions& o) { o.narrows_to = 1; });
  refused([](DrapeOptions& o) { o.lifted_from_deg = 60; });
  refused([](DrapeOptions& o) { o.lifted_to_deg = 200; });
  EXPECT_NO_THROW(DrapeOptions().validate());
}

TEST(Drape, RefusesBuffersOfAnotherMesh) {
  test::on_every_device([](ocl::DeviceContext& device) {
    DrapeScene scene(device);
    ocl::Buffer<float> few(device, size_t(6)), matches(device, size_t(2 * LC_MATCH));
    ocl::Buffer<int32_t> visible(device, size_t(2));
    ocl::Buffer<float> all(device, test::skirt_actor().mesh.positions);
    EXPECT_THROW(scene.drape().look(visible, few, matches), LogicError);
    EXPECT_THROW(scene.drape().look(visible, all, matches), LogicError);
    EXPECT_THROW(scene.drape().move({}, Eigen::Vector3d::UnitY(), all, few, all), LogicError);
  });
}

}  // namespace
}  // namespace livecap
