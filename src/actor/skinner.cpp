#include "actor/skinner.h"

#include <cmath>

#include "base/round_up.h"
#include "base/text.h"
#include "geometry/reference.h"
#include "ocl/lanes.h"

namespace livecap {
namespace {

constexpr const char* kSource = "surface/slices.cl";
constexpr size_t kGroup = 64;  // on a GPU

}  // namespace

Skinner::Skinner(ocl::DeviceContext& device, const Actor& actor, const SkinWeights& skin, int n_bones)
    : n_vertices_(actor.n_vertices()),
      lanes_(device.lanes()),
      rest_(device, actor.mesh.positions),
      bones_(device, skin.bones),
      weights_(device, skin.weights),
      dual_quats_(device, size_t(8) * n_bones),
      skin_(device, kSource, "skin_vertices"),
      unskin_(device, kSource, "unskin_displacement"),
      normals_(device, kSource, "vertex_normals") {
  const TriangleFans fans = triangle_fans(actor.n_vertices(), actor.mesh.triangles);
  fan_offsets_ = ocl::Buffer<int32_t>(device, fans.offsets);
  if (device.is_cpu()) {
    n_triangles_ = actor.mesh.n_triangles();
    triangles_ = ocl::Buffer<int32_t>(device, actor.mesh.triangles);
    fan_triangles_ = ocl::Buffer<int32_t>(device, fans.triangles);
    areas_ = ocl::Buffer<float>(device, size_t(4) * n_triangles_);
    triangle_normals_ = {device, kSource, "triangle_normals"};
    return;
  }
  std::vector<int32_t> corners;
  for (const int32_t t : fans.triangles)
    corners.insert(corners.end(), actor.mesh.triangles.begin() + 3 * t, actor.mesh.triangles.begin() + 3 * t + 3);
  fan_triangles_ = ocl::Buffer<int32_t>(device, corners);
}

void Skinner::set_pose(std::span<const float> dual_quats) {
  dual_quats_.write_later(dual_quats);
}

ocl::Range Skinner::over(int n) const {
  const size_t local = lanes_ > 1 ? 1 : kGroup;
  const size_t items = ocl::lane_items(n, lanes_);
  return {round_up(items, local), 1, local, 1};
}

void Skinner::skin(const ocl::Buffer<float>& displacement_rest, ocl::Buffer<float>& out_camera) {
  skin_.launch(over(n_vertices_), n_vertices_, rest_, displacement_rest, bones_, weights_, dual_quats_, out_camera);
}

void Skinner::unskin_displacement(const ocl::Buffer<float>& deformed_camera, const ocl::Buffer<float>& skinned_camera,
                                  const ocl::Buffer<float>& share, ocl::Buffer<float>& out_displacement_rest) {
  unskin_.launch(over(n_vertices_), n_vertices_, deformed_camera, skinned_camera, share, bones_, weights_, dual_quats_,
                 out_displacement_rest);
}

void Skinner::normals(const ocl::Buffer<float>& positions_camera, ocl::Buffer<float>& out_normals) {
  if (areas_.empty()) {
    normals_.launch(over(n_vertices_), n_vertices_, positions_camera, fan_offsets_, fan_triangles_, out_normals);
    return;
  }
  triangle_normals_.launch(over(n_triangles_), n_triangles_, positions_camera, triangles_, areas_);
  normals_.launch(over(n_vertices_), n_vertices_, areas_, fan_offsets_, fan_triangles_, out_normals);
}

std::vector<ocl::SelfTestResult> skinner_self_test(ocl::DeviceContext& device) {
  using namespace reference;
  // A tetrahedron on two bones: one still, one turned by 90 degrees about z and moved by 100 mm along x.
  Actor actor;
  actor.mesh.positions = {0, 0, 0, 100, 0, 0, 0, 100, 0, 0, 0, 100};
  actor.mesh.triangles = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
  actor.skeleton.bones = {{"root", -1, {0, 0, 0}}, {"turned", 0, {0, 0, 0}}};
  actor.skin.bones = {0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 0, 0, 0};
  actor.skin.weights = {1, 0, 0, 0, 1, 0, 0, 0, 0.5f, 0.5f, 0, 0, 0.75f, 0.25f, 0, 0};
  const float h = std::sqrt(0.5f);
  const std::vector<float> quats = {1, 0, 0, 0, 0, 0, 0, 0, h, 0, 0, h, 0, 50 * h, -50 * h, 0};
  const std::vector<float> displacement = {0, 0, 0, 5, 0, 0, 0, 7, 0, 0, 0, -3};
  const std::vector<float> half_of_third = {0, 0, 0, 5, 0, 0, 0, 3.5f, 0, 0, 0, -3};

  Skinner skinner(device, actor);
  skinner.set_pose(quats);
  ocl::Buffer<float> d(device, displacement), skinned(device, 12), bare(device, 12), back(device, 12),
      normals(device, 12);
  skinner.skin(d, skinned);
  d.fill(0);
  skinner.skin(d, bare);
  const ocl::Buffer<float> share(device, std::vector<float>{1, 1, 0.5f, 1});
  skinner.unskin_displacement(skinned, bare, share, back);
  skinner.normals(skinner.rest_positions(), normals);

  auto bone = [&](int b) {
    const float* q = quats.data() + 8 * b;
    return DualQuat{q[0], q[1], q[2], q[3], q[4], q[5], q[6], q[7]};
  };
  double skin_error = 0;
  const auto got = skinned.read_all();
  for (int i = 0; i < 4; ++i) {
    DualQuat sum = dual_quat_zero();
    for (int k = 0; k < 4; ++k)
      sum = dual_quat_add_scaled(sum, bone(actor.skin.bones[4 * i + k]), actor.skin.weights[4 * i + k]);
    const Vec3 p = dual_quat_transform(sum, vec3(actor.mesh.positions[3 * i] + displacement[3 * i],
                                                 actor.mesh.positions[3 * i + 1] + displacement[3 * i + 1],
                                                 actor.mesh.positions[3 * i + 2] + displacement[3 * i + 2]));
    skin_error = std::max(
        {skin_error, std::abs(p.x - got[3 * i]), std::abs(p.y - got[3 * i + 1]), std::abs(p.z - got[3 * i + 2])});
  }
  auto largest_difference = [](const std::vector<float>& a, const std::vector<float>& b) {
    double worst = 0;
    for (size_t i = 0; i < a.size(); ++i) worst = std::max(worst, std::abs(double(a[i]) - b[i]));
    return worst;
  };
  const double back_error = largest_difference(back.read_all(), half_of_third);
  const double normal_error =
      largest_difference(normals.read_all(), vertex_normals(actor.mesh.positions, actor.mesh.triangles));
  auto result = [](const char* kernel, double error, double bound) {
    return ocl::SelfTestResult{kernel, error <= bound, format("largest error %.3g, allowed %.3g", error, bound)};
  };
  return {result("skin_vertices", skin_error, 1e-3), result("unskin_displacement", back_error, 1e-3),
          result("vertex_normals", normal_error, 1e-5)};
}

}  // namespace livecap
