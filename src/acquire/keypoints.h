// What the pose network sees in each picture, and the keypoints in space that agree with all of them.
#pragma once

#include <Eigen/Core>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "base/detections.h"
#include "ocl/context.h"
#include "views/view.h"

namespace livecap::acquire {

// The network in every view on its own: no memory of the view before. progress: false stops (the rest stays empty).
// Throws IoError (model), OclError.
std::vector<Detections> detect_in_views(ocl::DeviceContext& device, const std::string& model,
                                        const std::vector<View>& views,
                                        const std::function<bool(int done, int total)>& progress = {});

// The viewing ray of one observation; direction is unit.
struct Ray {
  Eigen::Vector3d center, direction;
  double weight = 1;
};

struct SpacePoint {
  bool found = false;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  int n_inliers = 0;
  double spread_rad = 0;  // rms angle between the inliers' rays and the point
};

// The point most rays agree on: the best pair's midpoint, then reweighted least squares on the angles (Cauchy).
// Needs three inliers within 2 degrees that do not all look along one line.
SpacePoint triangulate(const std::vector<Ray>& rays);

using SpaceKeypoints = std::array<SpacePoint, kKeypointCount>;

// In the world of the views. Observations below a confidence of 0.3 do not count.
SpaceKeypoints triangulate_keypoints(const std::vector<View>& views, const std::vector<Detections>& detections);

// 0 for a view that sees most of its keypoints elsewhere than the points are: its camera is wrong, or its detection.
std::vector<char> agreeing_views(const std::vector<View>& views, const std::vector<Detections>& detections,
                                 const SpaceKeypoints& points);

}  // namespace livecap::acquire
