// Known-answer tests of the cloth's kernels: a small skirt at rest, and one step of what has no links, worked
// out by hand.
#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "cloth/cloth_simulation.h"
#include "cloth/drape.h"
#include "match/layout.h"

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

// Cloth 3 m away is simulated 30 mm left of its skinned place and matched 12 mm right of where it is simulated: four
// tenths of the way. Returns how far it is moved beside those 12 mm.
double drape_error_mm(ocl::DeviceContext& device, const Actor& actor, const PosedSkeleton& posed) {
  constexpr float kBeside = 30, kMatched = 12, kFar = 3000;
  Camera camera;
  camera.width = camera.height = 1000, camera.fx = camera.fy = 1000, camera.cx = camera.cy = 500;
  DrapeOptions options;
  options.clings_doubt_mm = 1e-3f;
  options.narrows_doubt_mm = 1e6f;
  const ClothGraph graph = make_cloth_graph(actor, 0);
  Drape drape(device, actor, graph, 0, camera, options);
  std::vector<float> simulated = actor.mesh.positions, skinned, matches(size_t(LC_MATCH) * actor.n_vertices());
  for (size_t k = 2; k < simulated.size(); k += 3) simulated[k] += kFar;
  skinned = simulated;
  for (int i = 0; i < actor.n_vertices(); ++i) {
    skinned[3 * i] += kBeside;
    const float* p = simulated.data() + 3 * i;
    matches[LC_MATCH * i] = float(camera.fx) * (p[0] + kMatched) / p[2] + float(camera.cx);
    matches[LC_MATCH * i + 1] = float(camera.fy) * p[1] / p[2] + float(camera.cy);
    matches[LC_MATCH * i + 2] = matches[LC_MATCH * i + 4] = 1;  // certain in all directions
    matches[LC_MATCH * i + LC_MATCH_WEIGHT_PX] = 1;
  }
  const ocl::Buffer<int32_t> visible(device, std::vector<int32_t>(actor.n_vertices(), 1));
  ocl::Buffer<float> moved(device, skinned), start(device, simulated), before(device, simulated);
  for (int frame = 0; frame < 2; ++frame) {
    moved.write(skinned);
    drape.keep(moved);
    moved.write(simulated);
    drape.move(posed, Eigen::Vector3d::UnitY(), moved, start, before);
    drape.look(visible, moved, {device, matches});
    device.finish();
    drape.learn(1 / 30.0);
  }
  const std::vector<float> got = moved.read_all();
  double worst = 0;
  for (int p = 0; p < graph.n_particles(); ++p) {
    if (graph.held[p]) continue;
    for (int a = 0; a < 3; ++a) {
      const int at = 3 * graph.vertices[p] + a;
      const double off = std::abs(got[at] - simulated[at] - (a == 0 ? kMatched : 0));
      if (!(off <= worst)) worst = off;
    }
  }
  return worst;
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
          told("simulate_cloth falling", fell),
          told("drape_cloth, look_at_drape", drape_error_mm(device, actor, posed))};
}

}  // namespace livecap
