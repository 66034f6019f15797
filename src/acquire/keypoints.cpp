#include "acquire/keypoints.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "detect/pose_detector.h"

namespace livecap::acquire {

namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr double kInlierRad = 0.035;  // 100 mm at 2.9 m: hips and shoulders differ that much between views
constexpr double kCauchyRad = 0.010;  // scale of the final weights
constexpr double kMinConfidence = 0.3;

// Least squares over the squared distances to the rays; false when the rays are parallel.
bool nearest_point(const std::vector<Ray>& rays, const std::vector<double>& weights, Vector3d& point) {
  Matrix3d a = Matrix3d::Zero();
  Vector3d b = Vector3d::Zero();
  double total = 0;
  for (size_t i = 0; i < rays.size(); ++i) {
    const Matrix3d across = Matrix3d::Identity() - rays[i].direction * rays[i].direction.transpose();
    a += weights[i] * across;
    b += weights[i] * across * rays[i].center;
    total += weights[i];
  }
  const Eigen::SelfAdjointEigenSolver<Matrix3d> eigen(a);
  if (!(total > 0) || eigen.eigenvalues()[0] < 1e-3 * total) return false;
  point = a.ldlt().solve(b);
  return true;
}

double angle_to(const Ray& ray, const Vector3d& point) {
  const Vector3d to = point - ray.center;
  return std::atan2(to.cross(ray.direction).norm(), to.dot(ray.direction));
}

Ray ray_of(const View& view, const KeypointDetection& seen) {
  const Camera& camera = view.camera;
  const Vector3d direction((seen.x_px - camera.cx) / camera.fx, (seen.y_px - camera.cy) / camera.fy, 1);
  return {view.center(), (view.camera_from_world.linear().transpose() * direction).normalized(), seen.confidence};
}

}  // namespace

std::vector<Detections> detect_in_views(ocl::DeviceContext& device, const std::string& model,
                                        const std::vector<View>& views, const std::function<bool(int, int)>& progress) {
  detect::PoseDetectorOptions options;
  options.model = model;
  options.filter = options.keep_sides = options.drop_jumps = options.correct_posture = options.alternate_mirror = false;
  detect::PoseDetector detector(device, options);
  std::vector<Detections> detections(views.size());
  for (size_t i = 0; i < views.size(); ++i) {
    if (progress && !progress(static_cast<int>(i), static_cast<int>(views.size()))) break;
    detector.reset();
    detections[i] = detector.detect(views[i].image, views[i].camera, static_cast<int64_t>(i), static_cast<double>(i));
  }
  return detections;
}

SpacePoint triangulate(const std::vector<Ray>& rays) {
  SpacePoint best;
  double best_support = 0;
  const size_t n = rays.size();
  // Pairs that look from clearly different sides.
  for (size_t i = 0; i < n; ++i)
    for (size_t j = i + 1; j < n; ++j) {
      if (rays[i].direction.cross(rays[j].direction).norm() < 0.15) continue;
      Vector3d point;
      if (!nearest_point({rays[i], rays[j]}, {1, 1}, point)) continue;
      if (angle_to(rays[i], point) > kInlierRad || angle_to(rays[j], point) > kInlierRad) continue;
      double support = 0;
      for (const Ray& ray : rays) {
        const double share = angle_to(ray, point) / kInlierRad;
        if (share < 1) support += ray.weight * (1 - share * share);
      }
      if (support > best_support) {
        best_support = support;
        best.position = point;
        best.found = true;
      }
    }
  if (!best.found) return best;
  std::vector<double> weights(n);
  for (int round = 0; round < 20; ++round) {
    for (size_t i = 0; i < n; ++i) {
      const double angle = angle_to(rays[i], best.position), distance = (best.position - rays[i].center).norm();
      const double share = angle / kCauchyRad;
      weights[i] = angle > kInlierRad ? 0 : rays[i].weight / ((1 + share * share) * distance * distance);
    }
    const Vector3d before = best.position;
    if (!nearest_point(rays, weights, best.position)) break;
    if ((best.position - before).norm() < 1e-9 * before.norm()) break;
  }
  double sum = 0;
  for (const Ray& ray : rays)
    if (const double angle = angle_to(ray, best.position); angle < kInlierRad) sum += angle * angle, ++best.n_inliers;
  best.found = best.n_inliers >= 3;
  best.spread_rad = best.n_inliers > 0 ? std::sqrt(sum / best.n_inliers) : 0;
  return best;
}

SpaceKeypoints triangulate_keypoints(const std::vector<View>& views, const std::vector<Detections>& detections) {
  SpaceKeypoints points;
  for (int k = 0; k < kKeypointCount; ++k) {
    std::vector<Ray> rays;
    for (size_t i = 0; i < views.size(); ++i) {
      if (!detections[i].person || detections[i].keypoints[k].confidence < kMinConfidence) continue;
      rays.push_back(ray_of(views[i], detections[i].keypoints[k]));
    }
    points[k] = triangulate(rays);
  }
  return points;
}

std::vector<char> agreeing_views(const std::vector<View>& views, const std::vector<Detections>& detections,
                                 const SpaceKeypoints& points) {
  std::vector<char> agrees(views.size(), 1);
  for (size_t i = 0; i < views.size(); ++i) {
    int n = 0, n_near = 0;
    for (int k = 0; k < kKeypointCount; ++k) {
      const KeypointDetection& seen = detections[i].keypoints[k];
      if (!detections[i].person || !points[k].found || seen.confidence < kMinConfidence) continue;
      ++n;
      n_near += angle_to(ray_of(views[i], seen), points[k].position) < kInlierRad;
    }
    agrees[i] = 2 * n_near >= n;
  }
  return agrees;
}

}  // namespace livecap::acquire
