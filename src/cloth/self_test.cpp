// Known-answer tests of the cloth's kernels: a small skirt at rest, and one step of what has no links, worked
// out by hand.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "cloth/cloth_simulation.h"

namespace livecap {
namespace {

constexpr int kAround = 6, kRings = 3;
constexpr double kTolerance = 1e-3;  // mm

// A cone of three rings around two legs; the highest is the seam.
Actor small_skirt() {
  Actor actor;
  actor.skeleton.bones = {{"pelvis", -1, {0, 0, 0}},       {"left_hip", 0, {50, 0, 0}},
                          {"left_knee", 1, {0, -400, 0}},  {"left_ankle", 2, {0, -400, 0}},
                          {"right_hip", 0, {-50, 0, 0}},   {"right_knee", 4, {0, -400, 0}},
                          {"right_ankle", 5, {0, -400, 0}}};
  for (int ring = 0; ring < kRings; ++ring) {
    for (int k = 0; k < kAround; ++k) {
      const double angle = 2 * M_PI * k / kAround, radius = 200 + 20 * ring;
      actor.mesh.positions.insert(
          actor.mesh.positions.end(),
          {float(radius * std::sin(angle)), 50.0f - 100.0f * float(ring), float(radius * std::cos(angle))});
      actor.skin.bones.insert(actor.skin.bones.end(), {1, 0, 0, 0});
      actor.skin.weights.insert(actor.skin.weights.end(), {1, 0, 0, 0});
      actor.rigidity.push_back(ring == 0 ? 2.0f : 1.0f);
      if (ring == 0) continue;
      const int c = ring * kAround + k, d = ring * kAround + (k + 1) % kAround, a = c - kAround, b = d - kAround;
      actor.mesh.triangles.insert(actor.mesh.triangles.end(), {a, c, b, b, c, d});
    }
  }
  return actor;
}

}  // namespace

std::vector<ocl::SelfTestResult> cloth_self_test(ocl::DeviceContext& device) {
  const Actor actor = small_skirt();
  const std::vector<float>& rest = actor.mesh.positions;
  const PosedSkeleton posed = forward_kinematics(actor.skeleton, rest_pose(actor.skeleton));
  ClothOptions options;
  options.taut.steps = 1;
  options.relaxation = 1e-9f;
  options.limb_radii = {0, 0, 0, 0};
  options.gravity = 0;
  options.settling_frames = 0;
  options.smoothing_mm = 0;
  constexpr float kTaut = 0;
  constexpr int kX = 0, kY = 1;
  ClothSimulation cloth(device, actor, options, kTaut);
  ocl::Buffer<float> skinned(device, rest), start(device, rest), before(device, rest);
  const double seconds = 0.04, aside = 10;
  // The first step; once more where a GPU's work-groups do not wait for each other.
  const auto begin = [&](ClothSimulation& simulation) {
    do {
      skinned.write(rest);
      simulation.step(posed, seconds, -Eigen::Vector3d::UnitY(), skinned, start, before);
      device.finish();
    } while (simulation.gave_up());
  };
  // The largest distance along an axis from the rest place and so much, of the vertices from `first` to `end`.
  const auto error = [&](int axis, int first, int end, double by) {
    const std::vector<float> got = skinned.read_all();
    double worst = 0;
    for (int k = 3 * first + axis; k < 3 * end; k += 3) worst = std::max(worst, std::abs(got[k] - rest[k] - by));
    return worst;
  };

  begin(cloth);
  const double at_rest = error(kX, 0, actor.n_vertices(), 0);
  std::vector<float> moved = rest;
  for (size_t k = 0; k < moved.size(); k += 3) moved[k] += float(aside);
  skinned.write(moved);
  cloth.step(posed, seconds, -Eigen::Vector3d::UnitY(), skinned, start, before);
  // It takes up a share of the velocity it is carried with, loses some of that to the air, and is pulled.
  const double carried = aside / seconds * (1 - std::exp(-options.taut.damping * seconds));
  const double pulled = options.taut.stiffness * seconds * aside;
  const double by = seconds * (carried * std::exp(-options.air_drag * seconds) + pulled);
  const double swung = std::max(error(kX, 0, kAround, aside), error(kX, kAround, actor.n_vertices(), by));

  // With gravity it has fallen one step when it begins.
  options.gravity = ClothOptions().gravity;
  ClothSimulation falling(device, actor, options, kTaut);
  begin(falling);
  const double down = options.gravity * seconds * seconds;
  const double fell = std::max(error(kY, 0, kAround, 0), error(kY, kAround, actor.n_vertices(), down));
  const auto told = [](const char* what, double error_mm) {
    return ocl::SelfTestResult{what, error_mm <= kTolerance, std::to_string(error_mm) + " mm beside the known place"};
  };
  return {told("simulate_cloth at rest", at_rest), told("simulate_cloth carried aside", swung),
          told("simulate_cloth falling", fell)};
}

}  // namespace livecap
