#include "export/residual_basis.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <cmath>

#include "export/export_frame.h"

namespace livecap {
namespace {

// Below this a blend of opposed rotations has all but collapsed a direction; that direction is left undisplaced.
constexpr double kMinStretch = 0.1;
constexpr int kMaxSnapshots = 400;  // the Gram matrix stays small; frames between two snapshots look like them

}  // namespace

LinearSkinning::LinearSkinning(const Actor& actor)
    : actor_(actor), bones_(actor.skeleton.n_bones()), blended_(actor.n_vertices()) {}

void LinearSkinning::set_pose(const Pose& pose) {
  const PosedSkeleton posed = forward_kinematics(actor_.skeleton, pose);
  for (int b = 0; b < actor_.skeleton.n_bones(); ++b) {
    bones_[b].leftCols<3>() = gltf_axes_from_camera() * posed.camera_from_rest[b].linear();
    bones_[b].col(3) = gltf_from_camera(posed.camera_from_rest[b].translation());
  }
  for (int v = 0; v < actor_.n_vertices(); ++v) {
    blended_[v].setZero();
    for (int k = 0; k < kMaxInfluences; ++k)
      blended_[v] += actor_.skin.weights[4 * v + k] * bones_[actor_.skin.bones[4 * v + k]];
  }
}

namespace {
Eigen::Vector3d bind_m(const Actor& actor, int v) {
  return kMetresPerMm * Eigen::Map<const Eigen::Vector3f>(actor.mesh.positions.data() + 3 * v).cast<double>();
}
}  // namespace

Eigen::Vector3d LinearSkinning::forward(int v, const Eigen::Vector3d& displacement) const {
  return blended_[v].leftCols<3>() * (bind_m(actor_, v) + displacement) + blended_[v].col(3);
}

Eigen::Vector3d LinearSkinning::inverse(int v, const Eigen::Vector3d& captured) const {
  const Eigen::Matrix3d a = blended_[v].leftCols<3>();
  const Eigen::Vector3d difference = captured - forward(v, Eigen::Vector3d::Zero());
  // |a^-1| <= 1/kMinStretch is certain when the determinant is large: |det| = product of stretches, each at most 1.
  if (a.determinant() > 2 * kMinStretch) return a.inverse() * difference;
  const Eigen::JacobiSVD<Eigen::Matrix3d> svd(a, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Eigen::Vector3d scaled = svd.matrixU().transpose() * difference;
  for (int k = 0; k < 3; ++k)
    scaled[k] = svd.singularValues()[k] > kMinStretch ? scaled[k] / svd.singularValues()[k] : 0;
  return svd.matrixV() * scaled;
}

Eigen::MatrixXf residual_basis(int n_numbers, int n_samples, int max_shapes, double tolerance_m,
                               const std::function<void(int, Eigen::Ref<Eigen::VectorXd>)>& residual) {
  const int n_snapshots = std::min(n_samples, kMaxSnapshots);
  if (n_snapshots == 0 || max_shapes <= 0) return Eigen::MatrixXf(n_numbers, 0);
  Eigen::MatrixXd x(n_numbers, n_snapshots);
  for (int i = 0; i < n_snapshots; ++i) residual(static_cast<int>(int64_t{i} * n_samples / n_snapshots), x.col(i));
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(Eigen::MatrixXd(x.transpose() * x));
  const Eigen::VectorXd& energies = eigen.eigenvalues();  // ascending
  // What is left out altogether, over all snapshots and vertices, stays below the tolerance.
  const double allowed = tolerance_m * tolerance_m * n_snapshots * n_numbers / 3;
  int n_skipped = 0;
  double skipped = 0;
  while (n_skipped < n_snapshots && skipped + std::max(energies[n_skipped], 0.0) <= allowed)
    skipped += std::max(energies[n_skipped++], 0.0);
  const int n_shapes = std::min(n_snapshots - n_skipped, max_shapes);
  Eigen::MatrixXf basis(n_numbers, n_shapes);
  for (int k = 0; k < n_shapes; ++k) {
    const Eigen::VectorXd shape = x * eigen.eigenvectors().col(n_snapshots - 1 - k);
    basis.col(k) = (shape / shape.cwiseAbs().maxCoeff()).cast<float>();
  }
  return basis;
}

}  // namespace livecap
