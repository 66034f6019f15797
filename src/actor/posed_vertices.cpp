#include "actor/posed_vertices.h"

#include "geometry/reference.h"

namespace livecap {

Eigen::Vector3d posed_point(std::span<const float> dual_quats, const SkinWeights& skin, int vertex,
                            const Eigen::Vector3d& rest_mm) {
  const auto motion = [&](int influence) {
    const float* q = &dual_quats[8 * static_cast<size_t>(skin.bones[kMaxInfluences * vertex + influence])];
    return reference::DualQuat{q[0], q[1], q[2], q[3], q[4], q[5], q[6], q[7]};
  };
  const reference::DualQuat first = motion(0);
  reference::DualQuat sum = reference::dual_quat_zero();
  for (int k = 0; k < kMaxInfluences; ++k) {
    const reference::DualQuat q = motion(k);
    const double sign = reference::dual_quat_real_dot(first, q) < 0 ? -1 : 1;
    sum = reference::dual_quat_add_scaled(sum, q, sign * skin.weights[kMaxInfluences * vertex + k]);
  }
  const reference::Vec3 p = reference::dual_quat_transform(sum, reference::vec3(rest_mm.x(), rest_mm.y(), rest_mm.z()));
  return {p.x, p.y, p.z};
}

std::vector<float> posed_vertices(const Actor& actor, std::span<const float> dual_quats) {
  std::vector<float> positions(actor.mesh.positions.size());
  for (int i = 0; i < actor.n_vertices(); ++i) {
    const Eigen::Vector3d rest = Eigen::Vector3f::Map(&actor.mesh.positions[3 * i]).cast<double>();
    Eigen::Vector3f::Map(&positions[3 * i]) = posed_point(dual_quats, actor.skin, i, rest).cast<float>();
  }
  return positions;
}

}  // namespace livecap
