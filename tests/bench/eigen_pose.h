// Stage I's solve as one writes it on the host: what bench_stages measures PoseSolver with. The same terms, steps and
// final residuals from the same detections, in one thread without OpenCL: rows in floats, J^T J by Eigen's product,
// Cholesky in double. The chain, the targets and the terms' formulas are the library's.
#pragma once

#include <Eigen/Cholesky>
#include <vector>

#include "pose/pose_solver.h"
#include "pose/posed_step.h"

namespace livecap::bench {

class EigenPose {
 public:
  // Keeps references.
  EigenPose(const Actor& actor, const Camera& camera, const PoseOptions& options);

  struct Result {
    PoseState state;
    double energy = 0;  // F^T F there
  };
  // Of the input: detections, initial, previous, contour_vertices, at most PoseOptions::max_contour_vertices.
  // distance [width*height] px, signed.
  Result solve(const PoseInput& input, const std::vector<float>& distance);

 private:
  using Rows = Eigen::Array<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

  void fill_rows(const PoseInput& input, const KeypointTargets& targets, const std::vector<float>& distance,
                 bool with_J);
  void add_keypoint(int k, const KeypointTarget& target, bool with_J);
  void add_contour_vertex(int vertex, const float* distance, float sqrt_weight, bool with_J);
  void take_step(PoseState& state);

  const Actor& actor_;
  const Camera& camera_;
  const PoseOptions options_;
  PosePoints points_;
  PoseLayout layout_{};
  Rows moves_;                       // [n_bones, n_columns] 1 where a column moves the bone
  std::vector<float> rest_normals_;  // [3*n_vertices]
  std::vector<float> step_;          // pose/layout.h
  Rows J_;                           // [most rows, n_columns]: unknowns, residual, zeros
  int n_rows_ = 0;
  Eigen::MatrixXf gram_;
  Eigen::MatrixXd A_;
  Eigen::VectorXd delta_;
  Eigen::LLT<Eigen::MatrixXd> cholesky_;
};

}  // namespace livecap::bench
