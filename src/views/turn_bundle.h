// Bundle adjustment of one rigid body that turns before a static camera: points of the body, and where the body is in
// every picture. A view's pose is that of a turntable (one axis for all, an angle each) and a small deviation of its
// own, because people sway.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "livecap/camera.h"

namespace livecap {

// How the pixel of a point in front of a camera (its frame, mm) moves with the point, px/mm.
inline Eigen::Matrix<double, 2, 3> pixel_by_point(double fx, double fy, const Eigen::Vector3d& p) {
  Eigen::Matrix<double, 2, 3> m;
  m << fx / p.z(), 0, -fx * p.x() / (p.z() * p.z()), 0, fy / p.z(), -fy * p.y() / (p.z() * p.z());
  return m;
}

struct TurnObservation {
  int view = 0;
  int point = 0;
  Eigen::Vector2d pixel = Eigen::Vector2d::Zero();
  double sigma_px = 1;  // beyond some of these it counts less and less (Cauchy)
};

struct TurnDeviation {
  Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();  // after the turntable's, camera axes
  Eigen::Vector3d shift_mm = Eigen::Vector3d::Zero();            // camera axes
};

// camera = deviation.rotation * axis * about_y(angle) * body + center + shift. Body: +Y along the axis.
struct Turn {
  Eigen::Quaterniond axis = Eigen::Quaterniond(0, 1, 0, 0);  // body to camera at angle 0: faces the camera
  Eigen::Vector3d center_mm = Eigen::Vector3d(0, 0, 3000);   // a point of the axis; its y and z stay (scale, height)
  std::vector<double> angle_rad;                             // [n_views]
  std::vector<TurnDeviation> deviation;                      // [n_views]
  std::vector<Eigen::Vector3d> points_mm;                    // [n_points] of the body

  Eigen::Isometry3d camera_from_body(int view) const;
  // Pixels from the observation to its point; infinite behind the camera.
  double error_px(const Camera& camera, const TurnObservation& seen) const;
};

struct TurnBundleOptions {
  bool keep_axis = false;  // its direction is known
  bool deviate = false;    // solve the deviations as well, with these standard deviations
  double sway_rad = 0.035, shift_mm = 30;
  int max_iterations = 60;
};

// Levenberg-Marquardt with the points eliminated. Returns the final cost (half the robust sum of squares).
double solve_turn(const Camera& camera, const std::vector<TurnObservation>& observations,
                  const TurnBundleOptions& options, Turn& turn);

}  // namespace livecap
