#include "synth/falling_cloth.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/tolerances.h"

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
    if (before < 0 != z < 0) crossings.push_back(kFrame * (frame - z / (z - before)));
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

TEST(FallingCloth, LiesOnALimbAndGoesAlongWithIt) {
  const Strip s = strip(300);
  const double radius = 40;
  std::vector<Vec3> out;
  for (double friction : {0.0, 5.0}) {
    Fabric fabric;
    fabric.friction = friction;
    FallingCloth cloth(s.rest, s.triangles, s.held, {std::vector<double>(s.rest.size(), 1e9)}, fabric);
    cloth.reset(s.rest);
    double z = -80;  // comes from behind the strip, pushes it aside
    for (int frame = 0; frame < 60; ++frame) {
      const double next = std::min(z + 4, 60.0);
      const MovingCone limb{
          {{{-200, -150, z}, {-200, -150, next}}}, {{{200, -150, z}, {200, -150, next}}}, radius, radius};
      out = cloth.step(s.rest, {limb}, kFrame);
      z = next;
    }
    for (const Vec3& p : out) EXPECT_GT(std::hypot(p.y() + 150, p.z() - z), radius - 0.5) << friction;
    EXPECT_GT(out[30].z(), 80) << "at the limb's height";
  }
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

}  // namespace
}  // namespace livecap::synth
