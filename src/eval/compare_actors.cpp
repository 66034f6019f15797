#include "eval/compare_actors.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>

#include "actor/labels.h"
#include "base/text.h"
#include "eval/other_mesh.h"
#include "meshing/nearest_surface.h"
#include "meshing/surface_parts.h"
#include "synth/random.h"

namespace livecap {

namespace {

using Eigen::Vector3d;

constexpr double kCellMm = 40;

using DualQuaternion = std::array<Eigen::Quaterniond, 2>;

Eigen::Quaterniond scaled(const Eigen::Quaterniond& q, double s) {
  return Eigen::Quaterniond(Eigen::Vector4d(s * q.coeffs()));
}

}  // namespace

std::vector<Eigen::VectorXd> test_poses(const Skeleton& skeleton, int n_poses) {
  constexpr double kMost = 80 * M_PI / 180;
  std::vector<Eigen::VectorXd> poses;
  for (int p = 0; p < n_poses; ++p) {
    Eigen::VectorXd angles(skeleton.n_dofs());
    for (int d = 0; d < skeleton.n_dofs(); ++d) {
      const double low = std::max(0.75 * skeleton.dofs[d].min_rad, -kMost);
      const double high = std::min(0.75 * skeleton.dofs[d].max_rad, kMost);
      // Three draws: most poses of a person are not at the limits.
      double share = 0;
      for (int i = 0; i < 3; ++i) share += synth::lattice_noise(p, 3 * d + i, 77) / 3;
      angles[d] = low + share * (high - low);
    }
    poses.push_back(angles);
  }
  return poses;
}

std::vector<Vector3d> pose_actor(const Actor& actor, const Skeleton& skeleton, const SkinWeights& skin,
                                 const Eigen::VectorXd& angles_rad) {
  Pose pose = rest_pose(skeleton);
  pose.angles_rad = angles_rad;
  const PosedSkeleton posed = forward_kinematics(skeleton, pose);
  std::vector<DualQuaternion> motions;
  for (const Eigen::Isometry3d& motion : posed.camera_from_rest) {
    const Eigen::Quaterniond real(motion.linear());
    const Vector3d t = motion.translation();
    motions.push_back({real, scaled(Eigen::Quaterniond(0, t.x(), t.y(), t.z()) * real, 0.5)});
  }
  std::vector<Vector3d> result(actor.n_vertices());
  for (int i = 0; i < actor.n_vertices(); ++i) {
    Eigen::Vector4d real = Eigen::Vector4d::Zero(), dual = real;
    const auto& first = motions[skin.bones[4 * i]][0];
    for (int k = 0; k < kMaxInfluences; ++k) {
      const auto& motion = motions[skin.bones[4 * i + k]];
      const double weight = skin.weights[4 * i + k] * (first.dot(motion[0]) < 0 ? -1 : 1);
      real += weight * motion[0].coeffs();
      dual += weight * motion[1].coeffs();
    }
    const double norm = real.norm();
    const Eigen::Quaterniond q0(Eigen::Vector4d(real / norm)), qe(Eigen::Vector4d(dual / norm));
    const Vector3d rest = Eigen::Map<const Eigen::Vector3f>(&actor.mesh.positions[3 * i]).cast<double>();
    result[i] = q0 * rest + 2 * (qe * q0.conjugate()).vec();
  }
  return result;
}

ActorComparison compare_actors(const Actor& built, const Actor& truth, int n_poses, const std::vector<char>& seen) {
  ActorComparison result;
  meshing::Surface built_surface = meshing::surface_of(built.mesh);
  const meshing::Surface true_surface = meshing::surface_of(truth.mesh);
  const RestOverlay overlay = overlay_rest(built, truth);
  const Eigen::Isometry3d& motion = overlay.truth_from_actor;
  const std::vector<meshing::SurfacePoint>& on = overlay.nearest;
  for (Vector3d& p : built_surface.vertices) p = motion * p;
  const meshing::NearestSurface near_built(built_surface, kCellMm);

  std::vector<double> distances;
  std::vector<double> seen_distances;
  size_t same_label = 0, same_class = 0, same_seen_label = 0;
  for (size_t i = 0; i < on.size(); ++i) {
    distances.push_back(on[i].distance);
    const int corner =
        static_cast<int>(std::max_element(on[i].weights.begin(), on[i].weights.end()) - on[i].weights.begin());
    const int vertex = true_surface.triangles[on[i].triangle][corner];
    same_label += built.labels[i] == truth.labels[vertex];
    if (!seen.empty()) {
      const auto& corners = true_surface.triangles[on[i].triangle];
      const bool hidden = !seen[corners[0]] && !seen[corners[1]] && !seen[corners[2]];
      result.hidden.push_back(hidden);
      if (!hidden) seen_distances.push_back(on[i].distance);
      same_seen_label += !hidden && built.labels[i] == truth.labels[vertex];
    }
    same_class += built.rigidity[i] == truth.rigidity[vertex];
  }
  result.rest_mm = summarize(distances).mean;
  if (!seen_distances.empty())
    result.seen_labels = static_cast<double>(same_seen_label) / static_cast<double>(seen_distances.size());
  result.seen_built_to_truth_mm = summarize(std::move(seen_distances));
  for (int label = 0; label < kLabelCount; ++label) {
    double total = 0;
    int n = 0;
    for (size_t i = 0; i < on.size(); ++i)
      if (built.labels[i] == label) total += distances[i], ++n;
    if (n > 0) result.surface_by_label_mm.emplace_back(kLabelNames[label], total / n);
  }
  result.distances_mm = distances;
  result.built_to_truth_mm = summarize(std::move(distances));
  result.labels = static_cast<double>(same_label) / static_cast<double>(on.size());
  result.rigidity = static_cast<double>(same_class) / static_cast<double>(on.size());
  distances.clear();
  for (const Vector3d& p : true_surface.vertices) distances.push_back(near_built.find(p).distance);
  result.truth_to_built_mm = summarize(std::move(distances));

  const PosedSkeleton built_rest = forward_kinematics(built.skeleton, rest_pose(built.skeleton));
  const PosedSkeleton true_rest = forward_kinematics(truth.skeleton, rest_pose(truth.skeleton));
  double sum = 0;
  int count = 0;
  for (int bone = 0; bone < built.skeleton.n_bones(); ++bone) {
    const std::string& name = built.skeleton.bones[bone].name;
    const int other = truth.skeleton.bone_index(name);
    if (other < 0) continue;
    const Vector3d off =
        motion * built_rest.camera_from_bone[bone].translation() - true_rest.camera_from_bone[other].translation();
    result.joints_mm.emplace_back(name, off);
    if (name == "root" || name == "chest" || name.find("clavicle") != std::string::npos) continue;
    sum += off.norm();
    ++count;
  }
  for (int k : {kLeftWrist, kRightWrist}) {
    const Vector3d off = motion * built.keypoints[k].rest_position_mm - truth.keypoints[k].rest_position_mm;
    result.joints_mm.emplace_back(kKeypointNames[k], off);
    sum += off.norm();
    ++count;
  }
  result.joints_mean_mm = sum / std::max(1, count);

  distances.clear();
  const bool same_chain = built.skeleton.n_dofs() == truth.skeleton.n_dofs();
  for (const Eigen::VectorXd& angles : test_poses(truth.skeleton, same_chain ? n_poses : 0)) {
    const auto a = pose_actor(built, built.skeleton, built.skin, angles);
    const auto b = pose_actor(truth, truth.skeleton, truth.skin, angles);
    for (size_t i = 0; i < on.size(); ++i) {
      const auto& t = true_surface.triangles[on[i].triangle];
      const Vector3d target = on[i].weights[0] * b[t[0]] + on[i].weights[1] * b[t[1]] + on[i].weights[2] * b[t[2]];
      distances.push_back((motion * a[i] - target).norm());
    }
  }
  result.posed_mm = summarize(std::move(distances));
  return result;
}

std::string comparison_report(const ActorComparison& c) {
  const auto line = [](const char* what, const Summary& s) {
    return format("%-28s mean %6.1f  median %6.1f  95 %% %6.1f  most %6.1f mm\n", what, s.mean, s.median, s.p95, s.max);
  };
  std::string text =
      line("surface, built to true", c.built_to_truth_mm) + line("surface, true to built", c.truth_to_built_mm);
  if (!c.hidden.empty()) {
    const auto n = std::count(c.hidden.begin(), c.hidden.end(), 1);
    text += line("  without concavities", c.seen_built_to_truth_mm) +
            format("  concavities and unseen       %.1f %% of the vertices\n",
                   100.0 * static_cast<double>(n) / static_cast<double>(c.hidden.size()));
  }
  for (const auto& [name, error] : c.surface_by_label_mm) text += format("  %-26s      %6.1f\n", name.c_str(), error);
  if (c.posed_mm.n > 0) text += line("posed", c.posed_mm) + format("%-28s mean %6.1f\n", "the same at rest", c.rest_mm);
  text += format("%-28s mean %6.1f mm (each: distance; left, up, front)\n", "joints", c.joints_mean_mm);
  for (const auto& [name, off] : c.joints_mm)
    text += format("  %-26s      %6.1f %8.1f %6.1f %6.1f\n", name.c_str(), off.norm(), off.x(), off.y(), off.z());
  text += format("labels %.1f %%, rigidity classes %.1f %% of the vertices as in the truth\n", 100 * c.labels,
                 100 * c.rigidity);
  if (!c.hidden.empty()) text += format("  labels without concavities and unseen %.1f %%\n", 100 * c.seen_labels);
  return text;
}

}  // namespace livecap
