#include "bench_peers.h"

#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCore>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "base/timer.h"

namespace livecap::tools {
namespace {

constexpr int kPeerRepeats = 15;

template <typename Work>
double median_ms(Work&& work) {
  work();  // first touch of memory
  std::vector<double> times;
  for (int i = 0; i < kPeerRepeats; ++i) {
    const Timer timer;
    work();
    times.push_back(timer.elapsed_ms());
  }
  return median(times);
}

// I + L with one 3x3 diagonal block per vertex and edge: what E_smooth makes of the mesh.
Eigen::SparseMatrix<float, Eigen::RowMajor> laplacian_system(const Mesh& mesh) {
  std::vector<Eigen::Triplet<float>> entries;
  for (size_t t = 0; t < mesh.triangles.size(); t += 3) {
    for (int k = 0; k < 3; ++k) {
      const int a = mesh.triangles[t + k];
      const int b = mesh.triangles[t + (k + 1) % 3];
      for (int axis = 0; axis < 3; ++axis) {
        entries.emplace_back(3 * a + axis, 3 * b + axis, -0.5f);
        entries.emplace_back(3 * b + axis, 3 * a + axis, -0.5f);
        entries.emplace_back(3 * a + axis, 3 * a + axis, 0.5f);
        entries.emplace_back(3 * b + axis, 3 * b + axis, 0.5f);
      }
    }
  }
  const int n = 3 * mesh.n_vertices();
  for (int i = 0; i < n; ++i) entries.emplace_back(i, i, 1.0f);
  Eigen::SparseMatrix<float, Eigen::RowMajor> matrix(n, n);
  matrix.setFromTriplets(entries.begin(), entries.end());
  return matrix;
}

}  // namespace

PeerTimes time_peers(const Actor& actor, int width, int height) {
  const int threads = cv::getNumThreads();
  cv::setNumThreads(1);
  PeerTimes times;

  cv::Mat mask(height, width, CV_8U, cv::Scalar(0));
  cv::ellipse(mask, {width / 2, height / 2}, {width / 5, 2 * height / 5}, 0, 0, 360, cv::Scalar(255), -1);
  cv::Mat inside, outside;
  times.distance_transform_ms = median_ms([&] {
    cv::distanceTransform(mask, inside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
    cv::distanceTransform(255 - mask, outside, cv::DIST_L2, cv::DIST_MASK_PRECISE);
  });

  cv::Mat picture(height, width, CV_32FC3), blurred;
  cv::theRNG().state = 1;
  cv::randu(picture, 0, 1);
  times.gaussian_blur_ms = median_ms([&] {
    for (int size : {15, 9, 3}) cv::GaussianBlur(picture, blurred, {size, size}, 0);
  });

  const auto matrix = laplacian_system(actor.mesh);
  const Eigen::VectorXf right = Eigen::VectorXf::LinSpaced(matrix.rows(), -1, 1);
  Eigen::VectorXf solution;
  times.conjugate_gradient_ms = median_ms([&] {
    for (int step = 0; step < 3; ++step) {
      // The diagonal of the preconditioner is renewed in each step, as stage II does.
      Eigen::ConjugateGradient<Eigen::SparseMatrix<float, Eigen::RowMajor>, Eigen::Lower | Eigen::Upper> solver(matrix);
      solver.setTolerance(0);
      solver.setMaxIterations(4);
      solution = solver.solve(right);
    }
  });
  cv::setNumThreads(threads);
  return times;
}

}  // namespace livecap::tools
