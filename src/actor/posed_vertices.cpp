#include "actor/posed_vertices.h"

#include "geometry/reference.h"

namespace livecap {

std::vector<float> posed_vertices(const Actor& actor, std::span<const float> dual_quats) {
  const auto motion = [&](int bone) {
    const float* q = &dual_quats[8 * bone];
    return reference::DualQuat{q[0], q[1], q[2], q[3], q[4], q[5], q[6], q[7]};
  };
  std::vector<float> positions(actor.mesh.positions.size());
  for (int i = 0; i < actor.n_vertices(); ++i) {
    const reference::DualQuat first = motion(actor.skin.bones[4 * i]);
    reference::DualQuat sum = reference::dual_quat_zero();
    for (int k = 0; k < kMaxInfluences; ++k) {
      const reference::DualQuat q = motion(actor.skin.bones[4 * i + k]);
      const double sign = reference::dual_quat_real_dot(first, q) < 0 ? -1 : 1;
      sum = reference::dual_quat_add_scaled(sum, q, sign * actor.skin.weights[4 * i + k]);
    }
    const float* p = &actor.mesh.positions[3 * i];
    const reference::Vec3 moved = reference::dual_quat_transform(sum, reference::vec3(p[0], p[1], p[2]));
    positions[3 * i] = static_cast<float>(moved.x);
    positions[3 * i + 1] = static_cast<float>(moved.y);
    positions[3 * i + 2] = static_cast<float>(moved.z);
  }
  return positions;
}

}  // namespace livecap
