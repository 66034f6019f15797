// The pose energy's residuals once more, in double precision with Eigen and without the library's row functions: what
// the device is compared with. Only the kinematic chain (tested on its own) is shared.
#pragma once

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "geometry/mesh.h"
#include "livecap/camera.h"
#include "pose/pose_system.h"

namespace livecap::test {

struct PoseReference {
  const Actor& actor;
  const Camera& camera;
  PoseOptions options;
  KeypointTargets targets;
  std::vector<int32_t> contour;  // template vertices
  double contour_weight = 0;     // of each
  std::vector<float> distance;   // [width*height] or empty
  Floor floor{};
  std::vector<SolePoint> soles{};
  std::vector<double> stands{};  // empty: no floor is known

  struct SkinnedVertex {
    Eigen::Vector3d position;
    Eigen::Matrix3d rotation;
  };

  // Dual quaternion skinning: normalised weighted sum of bone motions, signs as the strongest bone's.
  SkinnedVertex skin(int vertex, const PosedSkeleton& posed) const {
    Eigen::Vector4d real = Eigen::Vector4d::Zero();
    Eigen::Vector4d dual = Eigen::Vector4d::Zero();
    Eigen::Quaterniond first;
    for (int j = 0; j < 4; ++j) {
      const Eigen::Isometry3d& motion = posed.camera_from_rest[actor.skin.bones[4 * vertex + j]];
      Eigen::Quaterniond q(motion.linear());
      if (j == 0) first = q;
      if (first.dot(q) < 0) q.coeffs() *= -1;
      const Eigen::Vector3d t = motion.translation();
      const Eigen::Quaterniond d = Eigen::Quaterniond(0, t.x() / 2, t.y() / 2, t.z() / 2) * q;
      real += double(actor.skin.weights[4 * vertex + j]) * q.coeffs();
      dual += double(actor.skin.weights[4 * vertex + j]) * d.coeffs();
    }
    const double length = real.norm();
    const Eigen::Quaterniond q(Eigen::Vector4d(real / length));
    const Eigen::Quaterniond d(Eigen::Vector4d(dual / length));
    const Eigen::Vector3d rest = Eigen::Map<const Eigen::Vector3f>(&actor.mesh.positions[3 * vertex]).cast<double>();
    const Eigen::Vector3d t = 2 * (d * q.conjugate()).vec();
    return {q * rest + t, q.toRotationMatrix()};
  }

  Eigen::Vector2d project(const Eigen::Vector3d& p) const {
    return {camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy};
  }

  bool in_picture(const Eigen::Vector3d& p) const {
    if (!(p.z() > 100)) return false;
    const Eigen::Vector2d px = project(p);
    return px.x() >= 0 && px.y() >= 0 && px.x() <= camera.width - 1 && px.y() <= camera.height - 1;
  }

  double sample(const Eigen::Vector2d& px) const {
    const int x = std::min(int(px.x()), camera.width - 2);
    const int y = std::min(int(px.y()), camera.height - 2);
    const double fx = px.x() - x;
    const double fy = px.y() - y;
    const auto at = [&](int i, int j) { return double(distance[size_t(j) * camera.width + i]); };
    return (1 - fx) * (1 - fy) * at(x, y) + fx * (1 - fy) * at(x + 1, y) + (1 - fx) * fy * at(x, y + 1) +
           fx * fy * at(x + 1, y + 1);
  }

  // The paper's rule: z = -grad |distance|; -1 when inside and the projected normal points against z. And 0 when
  // outside and it points along z: to the contour of another part. `margin` gets how far from the switch the vertex is.
  double direction(int vertex, const PosedSkeleton& posed, double& margin) const {
    const SkinnedVertex v = skin(vertex, posed);
    const std::vector<float> normals = vertex_normals_;
    const Eigen::Vector3d n = v.rotation * Eigen::Map<const Eigen::Vector3f>(&normals[3 * vertex]).cast<double>();
    const double h = 1e-3;
    const Eigen::Vector2d px = project(v.position);
    const double value = sample(px);
    const Eigen::Vector2d gradient((sample(px + Eigen::Vector2d(h, 0)) - sample(px - Eigen::Vector2d(h, 0))) / (2 * h),
                                   (sample(px + Eigen::Vector2d(0, h)) - sample(px - Eigen::Vector2d(0, h))) / (2 * h));
    const Eigen::Vector2d z = value > 0 ? Eigen::Vector2d(-gradient) : gradient;
    const Eigen::Vector2d n_px = (project(v.position + h * n) - px) / h;
    margin = std::min(std::abs(value), std::abs(n_px.dot(z)));
    return value <= 0 ? (n_px.dot(z) < 0 ? -1 : 1) : (n_px.dot(z) > 0 ? 0 : 1);
  }

  // In PoseSystem's row order.
  Eigen::VectorXd residuals(const PoseState& state) const {
    const PosedSkeleton posed = forward_kinematics(actor.skeleton, state.pose);
    std::vector<double> rows;
    for (int k = 0; k < kKeypointCount; ++k) {
      const KeypointTarget& target = targets[k];
      Eigen::Vector3d p = Eigen::Vector3d::Zero();
      if (actor.keypoints[k].bone >= 0)
        p = posed.camera_from_rest[actor.keypoints[k].bone] * actor.keypoints[k].rest_position_mm;
      const Eigen::Vector2d r2 = target.weight_2d > 0 && p.z() > 100
                                     ? Eigen::Vector2d(std::sqrt(target.weight_2d) * (project(p) - target.position_px))
                                     : Eigen::Vector2d::Zero();
      const Eigen::Vector3d r3 = std::sqrt(target.weight_3d) * (p - (target.detection_mm + state.t_prime_mm));
      const Eigen::Vector3d rt = std::sqrt(target.weight_temporal) * (p - target.previous_position_mm);
      rows.insert(rows.end(), r2.begin(), r2.end());
      rows.insert(rows.end(), r3.begin(), r3.end());
      rows.insert(rows.end(), rt.begin(), rt.end());
    }
    for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
      const Dof& dof = actor.skeleton.dofs[k];
      const double theta = state.pose.angles_rad[k];
      const double beyond = std::max(0.0, theta - dof.max_rad) - std::max(0.0, dof.min_rad - theta);
      rows.push_back(std::sqrt(options.weights.anatomic) * beyond);
    }
    for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
      const Dof& dof = actor.skeleton.dofs[k];
      rows.push_back(std::sqrt(options.weights.rest * dof.rest_share) * (state.pose.angles_rad[k] - dof.rest_rad));
    }
    for (size_t k = 0; k < soles.size(); ++k) {
      const Eigen::Vector3d p = posed.camera_from_rest[soles[k].bone] * soles[k].rest_mm;
      const double below = std::min(0.0, floor.height_mm(p)), above = std::max(0.0, floor.height_mm(p));
      rows.push_back(stands.empty() ? 0 : std::sqrt(options.weights.floor) * (below + stands[k] * above));
    }
    for (int vertex : contour) {
      const Eigen::Vector3d v = skin(vertex, posed).position;
      rows.push_back(in_picture(v) ? std::sqrt(contour_weight) * sample(project(v)) : 0.0);
    }
    return Eigen::Map<Eigen::VectorXd>(rows.data(), rows.size());
  }

  // increment: [rotation vector | t | angles | t'].
  static PoseState moved(const PoseState& state, const Eigen::VectorXd& increment) {
    return {add_increment(state.pose, increment.head(increment.size() - 3)), state.t_prime_mm + increment.tail<3>()};
  }

  Eigen::MatrixXd jacobian(const PoseState& state) const {
    const int n = actor.skeleton.n_dofs() + 9;
    const double h = 1e-5;
    Eigen::MatrixXd J(residuals(state).size(), n);
    for (int k = 0; k < n; ++k) {
      const Eigen::VectorXd step = h * Eigen::VectorXd::Unit(n, k);
      J.col(k) = (residuals(moved(state, step)) - residuals(moved(state, -step))) / (2 * h);
    }
    return J;
  }

  std::vector<float> vertex_normals_ = vertex_normals(actor.mesh.positions, actor.mesh.triangles);
};

// A distance-like image that bilinear interpolation reproduces exactly, so that its gradient is smooth: negative on one
// side, positive on the other. offset_px > 0 large makes it positive everywhere.
inline std::vector<float> smooth_distance(const Camera& camera, double offset_px = 0) {
  std::vector<float> image;
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double dx = x - camera.cx;
      const double dy = y - camera.cy;
      image.push_back(float(offset_px + 0.8 * dx + 0.5 * dy + 1e-3 * dx * dy));
    }
  }
  return image;
}

// Every third vertex: more than a real contour has.
inline std::vector<int32_t> some_vertices(const Actor& actor, int stride) {
  std::vector<int32_t> vertices;
  for (int i = 0; i < actor.n_vertices(); i += stride) vertices.push_back(i);
  return vertices;
}

}  // namespace livecap::test
