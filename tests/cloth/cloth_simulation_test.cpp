#include "cloth/cloth_simulation.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "cloth/scene.h"
#include "livecap/error.h"
#include "support/kernel_bodies.h"
#include "support/launched_kernels.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using Vector3 = Eigen::Vector3d;

constexpr double kFrame = 1 / 30.0;
constexpr float kTaut = 0, kLoose = 1;

Vector3 vertex(const std::vector<float>& positions, int i) {
  return {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
}

std::vector<float> moved(std::vector<float> positions, const Vector3& by) {
  for (size_t k = 0; k < positions.size(); ++k) positions[k] += float(by[k % 3]);
  return positions;
}

// The device's simulation with host vectors.
class Simulation {
 public:
  Simulation(ocl::DeviceContext& device, const Actor& actor, const ClothOptions& options, float looseness = kTaut)
      : cloth_(device, actor, options, looseness),
        skinned_(device, actor.mesh.positions),
        start_(device, actor.mesh.positions),
        before_(device, actor.mesh.positions) {}

  std::vector<float> step(const PosedSkeleton& posed, const std::vector<float>& skinned, double seconds = kFrame) {
    std::vector<float> out, start, before;
    do {
      skinned_.write(skinned);
      start_.write(moved(skinned, {1, 2, 3}));
      before_.write(moved(skinned, {0, 0, -5}));
      cloth_.step(posed, seconds, up, skinned_, start_, before_);
      out = skinned_.read_all();
      start = start_.read_all();
      before = before_.read_all();
    } while (cloth_.gave_up());
    const std::vector<float> expected_start = moved(out, {1, 2, 3}), expected_before = moved(out, {0, 0, -5});
    for (size_t k = 0; k < out.size(); ++k) {
      EXPECT_NEAR(start[k], expected_start[k], test::kMillimetreFloat);
      EXPECT_NEAR(before[k], expected_before[k], test::kMillimetreFloat);
    }
    return out;
  }
  ClothSimulation& operator*() { return cloth_; }

  Vector3 up = -Vector3::UnitY();

 private:
  ClothSimulation cloth_;
  ocl::Buffer<float> skinned_, start_, before_;
};

// The same in double from the equations, particle by particle over the graph.
class Reference {
 public:
  Reference(const Actor& actor, const ClothOptions& options, float looseness = kTaut)
      : actor_(actor),
        options_(options),
        graph_(make_cloth_graph(actor, options.fabric(looseness).max_held_leg_weight)) {
    for (double* value : {&stiffness_, &damping_, &steps_}) *value = 0;
    for (const auto& [fabric, share] : {std::pair{options.taut, 1 - looseness}, {options.loose, looseness}}) {
      stiffness_ += share * fabric.stiffness;
      damping_ += share * fabric.damping;
      steps_ += share * fabric.steps;
    }
    steps_ = std::round(steps_);
    const PosedSkeleton rest = forward_kinematics(actor.skeleton, rest_pose(actor.skeleton));
    const std::vector<Limb> limbs = limbs_of(rest);
    for (const int i : graph_.vertices) {
      reach_.emplace_back();
      for (const Limb& limb : limbs) reach_.back().push_back(distance(limb, vertex(actor.mesh.positions, i)).norm());
    }
  }

  Vector3 up = -Vector3::UnitY();

  std::vector<float> step(const PosedSkeleton& posed, const std::vector<float>& skinned, double seconds = kFrame) {
    const std::vector<Limb> limbs = limbs_of(posed);
    const int n_settling = options_.settling_frames;
    if (x_.empty() && n_settling == 0) start(limbs, skinned);
    if (x_.empty()) {
      // From the rest pose at the hips; the legs go from there to where they are.
      const Eigen::Isometry3d& hips = posed.camera_from_rest[0];
      std::vector<float> hung = actor_.mesh.positions;
      for (size_t i = 0; i < hung.size(); i += 3)
        Eigen::Map<Eigen::Vector3f>{&hung[i]} = (hips * vertex(actor_.mesh.positions, int(i / 3))).cast<float>();
      std::vector<Limb> straight = limbs_of(forward_kinematics(actor_.skeleton, rest_pose(actor_.skeleton)));
      for (Limb& limb : straight) limb.from = hips * limb.from, limb.to = hips * limb.to;
      start(straight, hung);
      advance(straight, hung, 1 / 30.0);
      for (int k = 1; k <= n_settling; ++k) {
        std::vector<Limb> bent = straight;
        for (size_t i = 0; i < bent.size(); ++i) {
          bent[i].from += double(k) / n_settling * (limbs[i].from - bent[i].from);
          bent[i].to += double(k) / n_settling * (limbs[i].to - bent[i].to);
        }
        advance(bent, skinned, 1 / 30.0);
      }
    }
    return advance(limbs, skinned, seconds);
  }

  // How deep the deepest free particle is in a limb, mm.
  double depth(const PosedSkeleton& posed, const std::vector<float>& positions) const {
    double deepest = 0;
    const std::vector<Limb> limbs = limbs_of(posed);
    for (size_t i = 0; i < graph_.vertices.size(); ++i)
      for (size_t k = 0; k < limbs.size() && !graph_.held[i]; ++k) {
        const Vector3 p = vertex(positions, graph_.vertices[i]);
        deepest = std::max(deepest, std::min(radius_at(limbs[k], p), reach_[i][k]) - distance(limbs[k], p).norm());
      }
    return deepest;
  }
  // Of the edges: by how much the mean one differs from its rest length, as a share of it.
  double mean_stretch(const std::vector<float>& positions) const {
    double sum = 0;
    for (size_t i = 0; i < graph_.vertices.size(); ++i)
      for (int at = graph_.links.offsets[i]; at < graph_.links.offsets[i + 1]; ++at) {
        const int j = graph_.links.neighbors[at];
        const double rest = (rest_of(int(i)) - rest_of(j)).norm();
        sum +=
            std::abs((vertex(positions, graph_.vertices[i]) - vertex(positions, graph_.vertices[j])).norm() / rest - 1);
      }
    return sum / double(graph_.links.neighbors.size());
  }

 private:
  struct Limb {
    Vector3 from, to;
    double radius_from, radius_to;
  };
  void start(const std::vector<Limb>& limbs, const std::vector<float>& skinned) {
    for (const int i : graph_.vertices) x_.push_back(vertex(skinned, i));
    before_ = x_;
    v_.assign(x_.size(), Vector3::Zero());
    limbs_before_ = limbs;
  }
  std::vector<float> advance(const std::vector<Limb>& limbs, const std::vector<float>& skinned, double seconds) {
    const size_t n = graph_.vertices.size();
    std::vector<Vector3> target(n);
    for (size_t i = 0; i < n; ++i) target[i] = vertex(skinned, graph_.vertices[i]);
    const double dt = seconds / steps_;
    for (int s = 1; s <= steps_; ++s) {
      const double t = double(s) / steps_;
      std::vector<Vector3> ahead(n), next(n);
      for (size_t i = 0; i < n; ++i) {
        const Vector3 goal = before_[i] + t * (target[i] - before_[i]), carried = (target[i] - before_[i]) / seconds;
        v_[i] = carried + std::exp(-damping_ * dt) * (v_[i] - carried);
        Vector3 stretched = goal - x_[i];
        if (stretched.norm() > options_.spring_reach) stretched = options_.spring_reach * stretched.normalized();
        v_[i] = std::exp(-options_.air_drag * dt) * v_[i] + stiffness_ * dt * stretched;
        v_[i] -= options_.gravity * dt * up;
        ahead[i] = graph_.held[i] ? goal : Vector3(x_[i] + dt * v_[i]);
      }
      for (size_t i = 0; i < n; ++i) {
        next[i] = ahead[i];
        if (graph_.held[i]) continue;
        Vector3 sum = Vector3::Zero();
        double shares = 0;
        for (int at = graph_.links.offsets[i]; at < graph_.links.offsets[i + 1]; ++at) {
          const int j = graph_.links.neighbors[at];
          const double share = graph_.across[at] ? options_.bending_share : 1;
          const double rest = (rest_of(int(i)) - rest_of(j)).norm();
          const Vector3 link = ahead[j] - ahead[i];
          sum += share * (link.norm() - rest) * link.normalized() * (graph_.held[j] ? 1.0 : 0.5);
          shares += share;
        }
        next[i] += options_.relaxation / shares * sum;
        for (size_t k = 0; k < limbs.size(); ++k) {
          Limb limb = limbs[k];
          limb.from = limbs_before_[k].from + t * (limb.from - limbs_before_[k].from);
          limb.to = limbs_before_[k].to + t * (limb.to - limbs_before_[k].to);
          const Vector3 out = distance(limb, next[i]);
          const double radius = std::min(radius_at(limb, next[i]), reach_[i][k]);
          if (out.norm() < radius) next[i] += (radius - out.norm()) * out.normalized();
        }
      }
      for (size_t i = 0; i < n; ++i) v_[i] = (next[i] - x_[i]) / dt;
      x_ = next;
    }
    before_ = target;
    limbs_before_ = limbs;
    std::vector<Vector3> away(n);
    for (size_t i = 0; i < n; ++i) away[i] = x_[i] - target[i];
    for (int k = 0; k < smoothings(); ++k) {
      const std::vector<Vector3> rough = away;
      for (size_t i = 0; i < n; ++i) {
        const int begin = graph_.links.offsets[i], end = graph_.links.offsets[i + 1];
        for (int at = begin; at < end && !graph_.held[i]; ++at)
          away[i] += (rough[graph_.links.neighbors[at]] - rough[i]) / (2 * (end - begin));
      }
    }
    std::vector<float> out = skinned;
    for (size_t i = 0; i < n; ++i)
      for (int a = 0; a < 3; ++a) out[3 * graph_.vertices[i] + a] = float(target[i][a] + away[i][a]);
    return out;
  }
  static double along(const Limb& limb, const Vector3& p) {
    const Vector3 axis = limb.to - limb.from;
    return std::clamp((p - limb.from).dot(axis) / axis.squaredNorm(), 0.0, 1.0);
  }
  static Vector3 distance(const Limb& limb, const Vector3& p) {
    return p - limb.from - along(limb, p) * (limb.to - limb.from);
  }
  static double radius_at(const Limb& limb, const Vector3& p) {
    return limb.radius_from + along(limb, p) * (limb.radius_to - limb.radius_from);
  }
  std::vector<Limb> limbs_of(const PosedSkeleton& posed) const {
    const auto at = [&](const char* name) {
      return Vector3(posed.camera_from_bone[actor_.skeleton.bone_index(name)].translation());
    };
    const auto& r = options_.limb_radii;
    constexpr double kThigh = 400;
    const Vector3 middle = (at("left_hip") + at("right_hip")) / 2;
    std::vector<Limb> limbs;
    for (const std::string side : {"left_", "right_"}) {
      const Vector3 hip = at((side + "hip").c_str()), knee = at((side + "knee").c_str()),
                    ankle = at((side + "ankle").c_str());
      limbs.push_back({hip, knee, r[1] * kThigh, r[2] * kThigh});
      limbs.push_back({knee, ankle, r[2] * kThigh, r[3] * kThigh});
      limbs.push_back({middle, hip, r[0] * kThigh, r[0] * kThigh});
    }
    return limbs;
  }
  // As a random walk of as many steps goes about as far.
  int smoothings() const {
    double sum = 0;
    for (size_t i = 0; i < graph_.vertices.size(); ++i)
      for (int at = graph_.links.offsets[i]; at < graph_.links.offsets[i + 1]; ++at)
        sum += (rest_of(int(i)) - rest_of(graph_.links.neighbors[at])).norm();
    return int(std::pow(options_.smoothing_mm * double(graph_.links.neighbors.size()) / sum, 2));
  }
  Vector3 rest_of(int particle) const { return vertex(actor_.mesh.positions, graph_.vertices[particle]); }

  const Actor& actor_;
  ClothOptions options_;
  double stiffness_, damping_, steps_;
  ClothGraph graph_;
  std::vector<std::vector<double>> reach_;
  std::vector<Vector3> x_, v_, before_;
  std::vector<Limb> limbs_before_;
};

PosedSkeleton posed(const Actor& actor, double left_hip_rad) {
  return forward_kinematics(actor.skeleton, test::pose_of(actor.skeleton, left_hip_rad));
}

TEST(ClothSimulation, RestStaysAtRestWithoutGravity) {
  const Actor actor = test::skirt_actor();
  test::on_every_device_and_body([&](ocl::DeviceContext& device) {
    for (const float hips : {0.3f, 0.9f}) {  // the second is wider than the skirt, which is not blown up by it
      ClothOptions options;
      options.limb_radii[0] = hips;
      options.gravity = 0;
      Simulation cloth(device, actor, options);
      ASSERT_TRUE((*cloth).has_cloth());
      for (int frame = 0; frame < 10; ++frame) {
        const std::vector<float> out = cloth.step(posed(actor, 0), actor.mesh.positions);
        for (size_t k = 0; k < out.size(); ++k)
          EXPECT_NEAR(out[k], actor.mesh.positions[k], 20 * test::kMillimetreFloat);
      }
    }
  });
}

TEST(ClothSimulation, FollowsTheEquations) {
  const Actor actor = test::skirt_actor();
  const auto check = [&](ocl::DeviceContext& device, float looseness) {
    ClothOptions options;
    options.bending_share = 0.7f;
    options.smoothing_mm = 300;
    options.loose.steps = 51;  // with 80 what buckles takes the rounding of floats to 0.1 mm
    options.settling_frames = 2;
    Simulation cloth(device, actor, options, looseness);
    Reference reference(actor, options, looseness);
    cloth.up = reference.up = Vector3(0.05, -1, -0.15).normalized();  // of a camera that looks down
    for (int frame = 0; frame < 3; ++frame) {
      // The body sways, turns its skirt a little out of shape and lifts a leg.
      std::vector<float> skinned = moved(actor.mesh.positions, {20.0 * frame, -5.0 * frame * frame, 10.0});
      for (int i = 0; i < actor.n_vertices(); ++i) skinned[3 * i + 2] += 0.02f * float(frame) * skinned[3 * i];
      Pose pose = test::pose_of(actor.skeleton, -0.4 * frame);
      pose.root_translation_mm += Vector3(20.0 * frame, -5.0 * frame * frame, 10.0);
      // Upright in the camera frame, whose y is down: what falls upwards buckles, and rounding with it.
      for (size_t k = 0; k < skinned.size(); ++k)
        if (k % 3 != 0) skinned[k] = -skinned[k];
      pose.root_translation_mm = pose.root_translation_mm.cwiseProduct(Vector3(1, -1, -1));
      pose.root_rotation = Vector3(1, -1, -1).asDiagonal();
      const PosedSkeleton legs = forward_kinematics(actor.skeleton, pose);
      const double seconds = frame == 2 ? 0.05 : kFrame;
      const std::vector<float> got = cloth.step(legs, skinned, seconds),
                               expected = reference.step(legs, skinned, seconds);
      double worst = 0, furthest = 0;
      for (size_t k = 0; k < got.size(); ++k) {
        worst = std::max(worst, double(std::abs(got[k] - expected[k])));
        furthest = std::max(furthest, double(std::abs(expected[k] - skinned[k])));
      }
      EXPECT_LT(worst, test::kClothMm) << frame;
      if (frame > 0) EXPECT_GT(furthest, 5) << frame;
    }
  };
  test::on_every_device_and_body([&](ocl::DeviceContext& device) {
    for (const float looseness : {kTaut, 0.4f, kLoose}) check(device, looseness);
    if (device.is_cpu()) return;
    for (const uint32_t units : {1, 3}) {  // several particles a work-item; groups that wait for each other, or cannot
      ocl::DeviceInfo info = device.info();
      info.compute_units = units;
      ocl::DeviceContext with_units(info);
      check(with_units, kLoose);
    }
  });
}

// Without links and limbs a particle is an oscillator: x'' = stiffness (goal - x) + gravity - air_drag x'
// - damping (x' - goal').
TEST(ClothSimulation, SpringsGravityAndDragAreThoseOfTheOscillator) {
  const Actor actor = test::skirt_actor();
  ClothOptions options;
  options.smoothing_mm = 0;
  options.relaxation = 1e-9f;
  options.limb_radii = {0, 0, 0, 0};
  options.taut.steps = options.loose.steps = 200;
  options.settling_frames = 0;
  const auto check = [&](ocl::DeviceContext& device, float looseness, double reach) {
    options.spring_reach = float(reach);
    const auto between = [&](float taut, float loose) { return taut + double(looseness) * (loose - taut); };
    const double k = between(options.taut.stiffness, options.loose.stiffness),
                 c = between(options.taut.damping, options.loose.damping), g = options.gravity, air = options.air_drag;
    Simulation cloth(device, actor, options, looseness);
    double x = 0, v = 0, before = 0;
    for (const double goal : {0.0, 100.0, 100.0, 40.0, 40.0, 40.0}) {
      const double carried = (goal - before) / kFrame;
      constexpr int kFine = 20000;  // midpoint rule
      for (int s = 0; s < kFine; ++s) {
        const double dt = kFrame / kFine;
        const auto acceleration = [&](double at, double velocity, double t) {
          const double stretched = before + t * (goal - before) - at;
          return k * std::clamp(stretched, -reach, reach) + g - air * velocity - c * (velocity - carried);
        };
        const double v_mid = v + dt / 2 * acceleration(x, v, double(s) / kFine), x_mid = x + dt / 2 * v;
        x += dt * v_mid;
        v += dt * acceleration(x_mid, v_mid, (s + 0.5) / kFine);
      }
      before = goal;
      const std::vector<float> out = cloth.step(posed(actor, 0), moved(actor.mesh.positions, {0, goal, 0}));
      constexpr int kFree = 2 * test::kAround;  // near y = 0, where a float is finest
      EXPECT_NEAR(out[3 * kFree + 1] - actor.mesh.positions[3 * kFree + 1], x, test::kOscillatorMm) << looseness;
      EXPECT_NEAR(out[1] - actor.mesh.positions[1], goal, test::kMillimetreFloat) << "the seam is held";
    }
    if (looseness == kLoose) EXPECT_GT(x, 150);
  };
  test::on_every_device_and_body([&](ocl::DeviceContext& device) {
    for (const float looseness : {kTaut, 0.3f, kLoose})
      for (const double reach : {15.0, 1000.0}) check(device, looseness, reach);
  });
}

TEST(ClothSimulation, AThighLiftsTheSkirtAndEdgesKeepTheirLengths) {
  const Actor actor = test::skirt_actor();
  test::on_every_device_and_body([&](ocl::DeviceContext& device) {
    ClothOptions options;
    options.smoothing_mm = 0;
    Simulation cloth(device, actor, options);
    cloth.up = Vector3::UnitY();  // of the rest frame
    const Reference reference(actor, {});
    std::vector<float> out;
    const PosedSkeleton kneeling = posed(actor, -1.2);
    for (int frame = 0; frame <= 20; ++frame)
      out = cloth.step(posed(actor, -1.2 * std::min(frame, 10) / 10), actor.mesh.positions);
    EXPECT_GT(reference.depth(kneeling, actor.mesh.positions), 60) << "the skinned skirt is in the way";
    EXPECT_LT(reference.depth(kneeling, out), 0.1);
    EXPECT_LT(reference.mean_stretch(out), 0.05);
    // In front of the left leg the hem is forward and up; behind the right one it is drawn along by half as much at
    // most.
    const int hem = (test::kRings - 1) * test::kAround;
    EXPECT_GT(out[3 * (hem + 2) + 2] - actor.mesh.positions[3 * (hem + 2) + 2], 100);
    EXPECT_GT(out[3 * (hem + 2) + 1] - actor.mesh.positions[3 * (hem + 2) + 1], 20);
    const int behind = hem + test::kAround / 2 + 2;
    EXPECT_LT((vertex(out, behind) - vertex(actor.mesh.positions, behind)).norm(), 50);
  });
}

// A thigh lifts the skirt, whose skinned place is 90 mm deep in it, by as much; smoothed it is not lifted as far.
TEST(ClothSimulation, SmoothedClothIsNotDeepInALimb) {
  test::on_every_device_and_body([&](ocl::DeviceContext& device) {
    for (const int finer : {1, 3}) {
      const Actor actor = test::skirt_actor(finer);
      for (const float looseness : {kTaut, kLoose}) {
        ClothOptions options;
        Simulation cloth(device, actor, options, looseness);
        cloth.up = Vector3::UnitY();  // of the rest frame
        const Reference reference(actor, options, looseness);
        for (int frame = 0; frame <= 12; ++frame) {
          const PosedSkeleton legs = posed(actor, -1.2 * std::min(frame, 10) / 10);
          const double deep_mm = reference.depth(legs, cloth.step(legs, actor.mesh.positions));
          EXPECT_LT(deep_mm, test::kSmoothedClothMm) << finer << " " << looseness << " " << frame;
        }
      }
    }
  });
}

// On a lifted thigh, and where skinning has the front of the skirt behind it: before the first frame cloth falls from
// where it is at rest.
TEST(ClothSimulation, StartsOnTheRightSideOfABentLeg) {
  const Actor actor = test::skirt_actor();
  std::vector<float> behind = actor.mesh.positions;
  for (size_t i = 0; i < behind.size(); i += 3)
    if (behind[i + 2] > 0 && actor.skin.weights[4 * (i / 3)] > 0.2f) behind[i + 2] -= 400;
  test::on_every_device_and_body([&](ocl::DeviceContext& device) {
    for (const float looseness : {kTaut, kLoose}) {
      Simulation right(device, actor, {}, looseness), wrong(device, actor, {}, looseness);
      right.up = wrong.up = Vector3::UnitY();  // of the rest frame
      const PosedSkeleton lifted = posed(actor, -1.0);
      const std::vector<float> expected = right.step(lifted, actor.mesh.positions);
      const std::vector<float> found = wrong.step(lifted, behind);
      double off_mm = 0;
      int n = 0;
      for (size_t i = 0; i < found.size(); i += 3, ++n)
        off_mm += std::hypot(found[i] - expected[i], found[i + 1] - expected[i + 1], found[i + 2] - expected[i + 2]);
      EXPECT_LT(off_mm / n, test::kStartedElsewhereMm) << looseness;
    }
  });
}

TEST(ClothSimulation, ATurnLeavesTheHemBehindUntilReset) {
  const Actor actor = test::skirt_actor();
  test::on_every_device_and_body([&](ocl::DeviceContext& device) {
    Simulation cloth(device, actor, {}), anew(device, actor, {});
    cloth.up = anew.up = Vector3::UnitY();  // of the rest frame
    cloth.step(posed(actor, 0), actor.mesh.positions);
    Pose pose = test::pose_of(actor.skeleton);
    pose.root_rotation = Eigen::AngleAxisd(0.5, Vector3::UnitY()).toRotationMatrix();
    std::vector<float> turned = actor.mesh.positions;
    for (int i = 0; i < actor.n_vertices(); ++i) {
      const Vector3 p = pose.root_rotation * vertex(actor.mesh.positions, i);
      for (int a = 0; a < 3; ++a) turned[3 * i + a] = float(p[a]);
    }
    const PosedSkeleton legs = forward_kinematics(actor.skeleton, pose);
    const int hem = actor.n_vertices() - 1, seam = 0;
    const auto swings = [&](const std::vector<float>& out, int i) {
      return (vertex(out, i) - vertex(turned, i)).norm();
    };
    const std::vector<float> behind = cloth.step(legs, turned);
    EXPECT_GT(swings(behind, hem), 20);
    EXPECT_LT(swings(behind, seam), test::kMillimetreFloat);
    (*cloth).reset();
    EXPECT_EQ(cloth.step(legs, turned), anew.step(legs, turned));
  });
}

// What is loose begins as if nothing had been, and hardly sags, as in few steps it would.
TEST(ClothSimulation, WhatIsLooseBeginsAnewAfterReset) {
  const Actor actor = test::skirt_actor();
  Pose pose = test::pose_of(actor.skeleton);
  pose.root_rotation = Vector3(1, -1, -1).asDiagonal();  // y is down in the camera frame
  const PosedSkeleton standing = forward_kinematics(actor.skeleton, pose);
  std::vector<float> skinned = actor.mesh.positions;
  for (size_t k = 0; k < skinned.size(); ++k)
    if (k % 3 != 0) skinned[k] = -skinned[k];
  test::on_every_device_and_body([&](ocl::DeviceContext& device) {
    ClothOptions options, few_steps;
    few_steps.loose.steps = 20;
    options.smoothing_mm = few_steps.smoothing_mm = 0;
    Simulation cloth(device, actor, options, kLoose), other(device, actor, options, kLoose),
        sagging(device, actor, few_steps, kLoose);
    const Reference reference(actor, {}, kLoose);
    std::vector<float> out, sagged;
    for (int frame = 0; frame < 5; ++frame) {
      const std::vector<float> moves = moved(skinned, {10.0 * frame, 0, 0});
      out = cloth.step(standing, moves), sagged = sagging.step(standing, moves);
    }
    EXPECT_LT(reference.mean_stretch(out), 0.03);
    EXPECT_LT(1.5 * reference.mean_stretch(out), reference.mean_stretch(sagged));
    (*cloth).reset();
    EXPECT_EQ(cloth.step(standing, skinned), other.step(standing, skinned));
  });
}

TEST(ClothSimulation, WithoutHangingClothNothingMoves) {
  Actor actor = test::skirt_actor();
  actor.rigidity.assign(actor.rigidity.size(), 2.0f);
  test::on_every_device([&](ocl::DeviceContext& device) {
    Simulation cloth(device, actor, {});
    EXPECT_FALSE((*cloth).has_cloth());
    cloth.step(posed(actor, 0), actor.mesh.positions);
    const std::vector<float> lifted = moved(actor.mesh.positions, {0, 100, 0});
    EXPECT_EQ(cloth.step(posed(actor, -1), lifted), lifted);
  });
}

// Hips alone do not say where the limbs are.
TEST(ClothSimulation, WithoutKneesNothingMoves) {
  Actor actor = test::skirt_actor();
  actor.skeleton.bones.erase(actor.skeleton.bones.begin() + 5, actor.skeleton.bones.end());
  test::on_every_device(
      [&](ocl::DeviceContext& device) { EXPECT_FALSE(ClothSimulation(device, actor, {}, kTaut).has_cloth()); });
}

TEST(ClothSimulation, SelfTestPasses) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    for (const auto& result : cloth_self_test(device)) EXPECT_TRUE(result.ok) << result.kernel << ": " << result.detail;
    test::expect_every_kernel_launched(device.info(), "cloth/cloth.cl", cloth_self_test);
    test::expect_every_kernel_launched(device.info(), "cloth/drape.cl", cloth_self_test);
  });
}

TEST(ClothSimulation, RefusesWhatMakesNoSense) {
  const Actor actor = test::skirt_actor();
  ocl::DeviceContext device(ocl::select_device(test::device_selectors()[0]));
  const auto refused = [&](auto&& change) {
    ClothOptions options;
    change(options);
    EXPECT_THROW(ClothSimulation(device, actor, options, kTaut), ConfigError);
  };
  refused([](ClothOptions& o) { o.taut.steps = 0; });
  refused([](ClothOptions& o) { o.loose.steps = 0; });
  refused([](ClothOptions& o) { o.taut.stiffness = -1; });
  refused([](ClothOptions& o) { o.loose.stiffness = NAN; });
  refused([](ClothOptions& o) { o.taut.stiffness = 1e6f; });
  ClothOptions between;
  between.taut = {390, 8, 1}, between.loose = {3.9e6f, 4, 100};  // either is stable
  EXPECT_THROW(ClothSimulation(device, actor, between, 0.5f), ConfigError);
  refused([](ClothOptions& o) { o.loose.damping = -1; });
  refused([](ClothOptions& o) { o.gravity = NAN; });
  refused([](ClothOptions& o) { o.settling_frames = -1; });
  refused([](ClothOptions& o) { o.smoothing_mm = -1; });
  refused([](ClothOptions& o) { o.smoothing_mm = 600; });
  refused([](ClothOptions& o) { o.air_drag = NAN; });
  refused([](ClothOptions& o) { o.spring_reach = 0; });
  refused([](ClothOptions& o) { o.bending_share = INFINITY; });
  refused([](ClothOptions& o) { o.relaxation = 2; });
  refused([](ClothOptions& o) { o.taut.max_held_leg_weight = 1; });
  refused([](ClothOptions& o) { o.limb_radii[2] = -1; });
  Simulation cloth(device, actor, {});
  EXPECT_THROW(cloth.step(posed(actor, 0), actor.mesh.positions, 0), LogicError);
}

}  // namespace
}  // namespace livecap
