#include "synth/falling_cloth.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "livecap/error.h"

namespace livecap::synth {
namespace {

constexpr double kFrame = 1 / 30.0;

// A strip that hangs straight down from its two topmost vertices, 20 mm wide, in cells of 10 mm.
struct Strip {
  std::vector<Vec3> rest;
  std::vector<Eigen::Vector3i> triangles;
  std::vector<char> held;
};

Strip strip(double length_mm) {
  Strip made;
  const int n = static_cast<int>(std::lround(length_mm / 10)) + 1;
  for (int i = 0; i < n; ++i) {
    for (double x : {-10.0, 10.0}) made.rest.push_back({x, -10.0 * i, 0});
    made.held.insert(made.held.end(), 2, i == 0);
    if (i == 0) continue;
    const int at = 2 * i;
    made.triangles.push_back({at - 2, at, at - 1});
    made.triangles.push_back({at - 1, at, at + 1});
  }
  return made;
}

TEST(FallingCloth, TheAngleOfAHingeHasItsDerivatives) {
  const std::array<Vec3, 4> flat{{{0, 0, 0}, {0, 10, 0}, {-8, 4, 0}, {7, 5, 0}}};
  EXPECT_NEAR(hinge_angle(flat), 0, 1e-12);
  std::array<Vec3, 4> right = flat;
  right[3] = {0, 5, 7};
  EXPECT_NEAR(std::abs(hinge_angle(right)), M_PI / 2, 1e-12);
  const std::array<Vec3, 4> bent{{{1, -2, 3}, {2, 9, 1}, {-8, 4, 2}, {7, 5, 6}}};
  std::array<Vec3, 4> gradient;
  hinge_angle(bent, &gradient);
  constexpr double kStep = 1e-6;
  for (int corner = 0; corner < 4; ++corner)
    for (int a = 0; a < 3; ++a) {
      std::array<Vec3, 4> ahead = bent, back = bent;
      ahead[corner][a] += kStep;
      back[corner][a] -= kStep;
      EXPECT_NEAR(gradient[corner][a], (hinge_angle(ahead) - hinge_angle(back)) / (2 * kStep), 1e-7);
    }
}

// A hanging strip swings as a chain does: at its slowest with j0 / 2 sqrt(g / L), j0 = 2.4048 the first zero of J_0.
TEST(FallingCloth, AStripSwingsAsAHangingChainDoes) {
  const double length = 300;
  const Strip s = strip(length);
  Fabric fabric;
  fabric.bending = 1e-9;
  fabric.drag = 0;
  fabric.damping = 1;
  FallingCloth cloth(s.rest, s.triangles, s.held, {}, fabric);
  // Leant by a little along z, nearly its slowest shape.
  std::vector<Vec3> leant = s.rest;
  for (Vec3& p : leant) p = Vec3(p.x(), p.y() * std::cos(0.04), p.y() * std::sin(0.04));
  cloth.reset(leant);
  std::vector<double> crossings;
  double before = leant.back().z();
  for (int frame = 1; frame < 240; ++frame) {
    const double z = cloth.step(s.rest, {}, kFrame).back().z();
    if ((before < 0) != (z < 0)) crossings.push_back(kFrame * (frame - z / (z - before)));
    before = z;
  }
  ASSERT_GE(crossings.size(), 7u);
  const double period = 2 * (crossings[6] - crossings[0]) / 6;
  EXPECT_NEAR(period, 2 * M_PI / (2.4048 / 2 * std::sqrt(kGravity / length)), 0.04 * period);
}

// At rest what hangs below a place, M g, stretches it: by rho g L^2 / (2 k) over the whole length.
TEST(FallingCloth, ItsOwnWeightStretchesIt) {
  const double length = 200;
  const Strip s = strip(length);
  Fabric fabric;
  fabric.stretch = 10;
  fabric.damping = 50;
  FallingCloth cloth(s.rest, s.triangles, s.held, {}, fabric);
  cloth.reset(s.rest);
  std::vector<Vec3> out;
  for (int frame = 0; frame < 200; ++frame) out = cloth.step(s.rest, {}, kFrame);
  const double longer = s.rest.back().y() - out.back().y();
  const double expected = fabric.density * 1e-6 * kGravity * length * length / (2 * fabric.stretch);
  EXPECT_GT(expected, 4);
  EXPECT_NEAR(longer, expected, 0.1 * expected);
}

// What falls flat through the air ends at the speed at which drag carries it: v^2 = 2 rho g / (air drag).
TEST(FallingCloth, AFlatPieceFallsAsFastAsTheAirLetsIt) {
  const std::vector<Vec3> rest{{0, 0, 0}, {50, 0, 0}, {0, 0, 50}, {50, 0, 50}};
  Fabric fabric;
  fabric.density = 0.05;
  FallingCloth cloth(rest, {{0, 2, 1}, {1, 2, 3}}, {0, 0, 0, 0}, {}, fabric);
  cloth.reset(rest);
  double before = 0, after = 0;
  for (int frame = 0; frame < 60; ++frame) {
    before = after;
    after = cloth.step(rest, {}, kFrame)[0].y();
  }
  const double speed = std::sqrt(2 * fabric.density * 1e-6 * kGravity / (1.2e-9 * fabric.drag));
  EXPECT_NEAR((before - after) / kFrame, speed, 0.01 * speed);
}

TEST(FallingCloth, LiesOnALimbAndIsTakenAlongByFriction) {
  const Strip s = strip(300);
  const double radius = 40;
  for (const double friction : {0.0, 5.0}) {
    Fabric fabric;
    fabric.friction = friction;
    FallingCloth cloth(s.rest, s.triangles, s.held, {std::vector<double>(s.rest.size(), 1e9)}, fabric);
    cloth.reset(s.rest);
    std::vector<Vec3> out;
    Vec3 at(0, -150, -80);
    const auto limb_to = [&](const Vec3& next) {
      const Vec3 half(200, 0, 0);
      out =
          cloth.step(s.rest, {MovingCone{{at - half, next - half}, {at + half, next + half}, radius, radius}}, kFrame);
      at = next;
    };
    // It comes from behind the strip and pushes it aside.
    while (at.z() < 60) limb_to(at + Vec3(0, 0, 4));
    for (const Vec3& p : out) EXPECT_GT(std::hypot(p.y() - at.y(), p.z() - at.z()), radius - 0.5) << friction;
    EXPECT_GT(out[30].z(), 80) << "at the limb's height";
    // Then it goes along itself.
    const double before = out[30].x();
    for (int frame = 0; frame < 10; ++frame) limb_to(at + Vec3(3, 0, 0));
    if (friction == 0)
      EXPECT_NEAR(out[30].x(), before, 3);
    else
      EXPECT_GT(out[30].x(), before + 10);
  }
}

// A strip held at one end sinks at the other by rho g L^4 / (8 bending).
TEST(FallingCloth, IsAsStiffAsItsFabric) {
  Strip s;  // lies flat along x, equilateral triangles
  const double cell = 10, row = cell * std::sqrt(3) / 2;
  constexpr int kAlong = 20, kAcross = 6;
  for (int i = 0; i <= kAlong; ++i)
    for (int k = 0; k <= kAcross; ++k) {
      s.rest.push_back({row * i, 0, cell * (k + 0.5 * (i % 2))});
      s.held.push_back(i <= 1);
    }
  const auto at = [](int i, int k) { return i * (kAcross + 1) + k; };
  for (int i = 0; i < kAlong; ++i)
    for (int k = 0; k < kAcross; ++k)
      if (i % 2 == 0) {
        s.triangles.push_back({at(i, k), at(i + 1, k), at(i, k + 1)});
        s.triangles.push_back({at(i, k + 1), at(i + 1, k), at(i + 1, k + 1)});
      } else {
        s.triangles.push_back({at(i, k), at(i + 1, k), at(i + 1, k + 1)});
        s.triangles.push_back({at(i, k), at(i + 1, k + 1), at(i, k + 1)});
      }
  Fabric fabric;
  fabric.density = 0.05;
  fabric.bending = 1e-3;
  fabric.damping = 30;
  FallingCloth cloth(s.rest, s.triangles, s.held, {}, fabric);
  cloth.reset(s.rest);
  std::vector<Vec3> out;
  for (int frame = 0; frame < 300; ++frame) out = cloth.step(s.rest, {}, kFrame / 8);  // coarser ones leave it softer
  // A cantilever under its own weight.
  const double length = row * (kAlong - 1), sunk = -out[at(kAlong, kAcross / 2)].y();
  const double expected = fabric.density * 1e-6 * kGravity * std::pow(length, 4) / (8 * fabric.bending * 1e6);
  EXPECT_NEAR(sunk, expected, 0.4 * expected) << "of few triangles with zigzag edges";
}

// No limb is thicker for a vertex than its reach.
TEST(FallingCloth, IsNotPushedByWhatItIsDrawnInto) {
  const Strip s = strip(300);
  Fabric fabric;
  fabric.damping = 50;
  FallingCloth cloth(s.rest, s.triangles, s.held, {std::vector<double>(s.rest.size(), 0.0)}, fabric);
  cloth.reset(s.rest);
  const MovingCone limb{{{{-200, -150, 20}, {-200, -150, 20}}}, {{{200, -150, 20}, {200, -150, 20}}}, 40, 40};
  std::vector<Vec3> out;
  for (int frame = 0; frame < 20; ++frame) out = cloth.step(s.rest, {limb}, kFrame);
  for (const Vec3& p : out) EXPECT_NEAR(p.z(), 0, 2);
}

TEST(FallingCloth, RefusesOtherVerticesOrCones) {
  const Strip s = strip(50);
  EXPECT_THROW(FallingCloth(s.rest, s.triangles, {1}, {}, {}), LogicError);
  EXPECT_THROW(FallingCloth(s.rest, s.triangles, s.held, {{1.0}}, {}), LogicError);
  FallingCloth cloth(s.rest, s.triangles, s.held, {}, {});
  EXPECT_THROW(cloth.step(s.rest, {}, kFrame), LogicError) << "before reset()";
  cloth.reset(s.rest);
  EXPECT_THROW(cloth.step({}, {}, kFrame), LogicError);
  EXPECT_THROW(cloth.step(s.rest, {MovingCone{}}, kFrame), LogicError);
}

}  // namespace
}  // namespace livecap::synth
