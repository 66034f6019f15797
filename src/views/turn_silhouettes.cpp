#include "views/turn_silhouettes.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <opencv2/core/optim.hpp>
#include <opencv2/imgproc.hpp>

namespace livecap {

namespace {

using Eigen::Isometry3d;
using Eigen::Vector3d;

constexpr int kMaxSidePx = 640;
constexpr int kPointsPerOutline = 60;
constexpr double kReachMm = 800;  // of an arm from the axis
constexpr double kStepMm = 10;    // along a ray
constexpr double kMostPx = 6;     // of one outline's point: a mask with a hole counts no more
constexpr double kFirstStepDeg = 0.5;
constexpr int kMostSteps = 60;
constexpr double kGainPx = 1e-3;  // less is no gain

// Distances to one view's outline, px, positive inside of it.
struct Outline {
  cv::Mat_<float> distance;
  std::vector<cv::Point> points;
};

class Silhouettes {
 public:
  explicit Silhouettes(const std::vector<View>& views) {
    const Camera& camera = views.front().camera;
    scale_ = std::min(1.0, static_cast<double>(kMaxSidePx) / std::max(camera.width, camera.height));
    fx_ = scale_ * camera.fx, fy_ = scale_ * camera.fy;
    cx_ = scale_ * (camera.cx + 0.5) - 0.5, cy_ = scale_ * (camera.cy + 0.5) - 0.5;
    for (const View& view : views) outlines_.push_back(outline_of(view.mask));
    const int n = static_cast<int>(views.size());
    stride_ = std::max(1, static_cast<int>(0.38 * n));
    while (std::gcd(stride_, n) > 1) ++stride_;
  }

  double gap_px(const Turn& turn) const {
    std::vector<Isometry3d> poses, inverse;
    for (size_t i = 0; i < outlines_.size(); ++i) {
      poses.push_back(turn.camera_from_body(static_cast<int>(i)));
      inverse.push_back(poses.back().inverse());
    }
    double sum = 0;
    size_t n = 0;
    for (size_t i = 0; i < outlines_.size(); ++i)
      for (const cv::Point& point : outlines_[i].points) {
        sum += std::min(kMostPx, -deepest_px(poses, inverse[i], static_cast<int>(i), point, turn.center_mm.z()));
        ++n;
      }
    return n > 0 ? sum / static_cast<double>(n) : 0;
  }

 private:
  Outline outline_of(const ImageGray& mask) const {
    if (mask.empty()) return {};
    const cv::Mat whole(mask.height, mask.width, CV_8UC1, const_cast<uint8_t*>(mask.pixels.data()));
    cv::Mat small, inside, outside;
    cv::resize(whole, small, {}, scale_, scale_, cv::INTER_AREA);
    small = small > 127;
    cv::distanceTransform(small, inside, cv::DIST_L2, cv::DIST_MASK_5);
    cv::distanceTransform(~small, outside, cv::DIST_L2, cv::DIST_MASK_5);
    Outline outline;
    outline.distance = inside - outside;
    std::vector<std::vector<cv::Point>> contours;
    cv::findContours(small, contours, cv::RETR_EXTERNAL, cv::CHAIN_APPROX_NONE);
    std::vector<cv::Point> all;  // not on the picture's border, where nobody ends
    for (const auto& contour : contours)
      for (const cv::Point& p : contour)
        if (p.x > 0 && p.y > 0 && p.x < small.cols - 1 && p.y < small.rows - 1) all.push_back(p);
    for (int k = 0; k < kPointsPerOutline && !all.empty(); ++k)
      outline.points.push_back(all[k * all.size() / kPointsPerOutline]);
    return outline;
  }

  // How deep inside of all other outlines the ray of a picture's point gets; at most 0.
  double deepest_px(const std::vector<Isometry3d>& poses, const Isometry3d& body_from_camera, int view,
                    const cv::Point& point, double depth_mm) const {
    const Vector3d ray((point.x - cx_) / fx_, (point.y - cy_) / fy_, 1);
    const int n = static_cast<int>(poses.size());
    double deepest = -2 * kMostPx;
    for (double z = depth_mm - kReachMm; z < depth_mm + kReachMm && deepest < 0; z += kStepMm) {
      const Vector3d body = body_from_camera * (z * ray);
      double least = 0;
      for (int k = 0; k < n && least > deepest; ++k) {
        const int other = (view + n / 4 + k * stride_) % n;  // from the side first
        if (other != view) least = std::min(least, distance_px(outlines_[other], poses[other] * body));
      }
      deepest = std::max(deepest, least);
    }
    return deepest;
  }

  // Far outside of the picture, or behind the camera, is far outside of the person.
  double distance_px(const Outline& outline, const Vector3d& p) const {
    if (!(p.z() > 0)) return -2 * kMostPx;
    const double x = fx_ * p.x() / p.z() + cx_, y = fy_ * p.y() / p.z() + cy_;
    const cv::Mat_<float>& d = outline.distance;
    if (d.empty()) return 0;  // the network saw nobody
    if (!(x >= 0 && y >= 0 && x < d.cols - 1 && y < d.rows - 1)) return -2 * kMostPx;
    const int u = static_cast<int>(x), v = static_cast<int>(y);
    const double a = x - u, b = y - v;
    return (1 - b) * ((1 - a) * d(v, u) + a * d(v, u + 1)) + b * ((1 - a) * d(v + 1, u) + a * d(v + 1, u + 1));
  }

  int stride_ = 1;  // from one view to the next that is looked at: soon all sides are
  double scale_ = 1, fx_ = 1, fy_ = 1, cx_ = 0, cy_ = 0;
  std::vector<Outline> outlines_;
};

Turn tilted(const Turn& turn, double about_x_deg, double about_z_deg) {
  const Vector3d tilt = Vector3d(about_x_deg, 0, about_z_deg) * M_PI / 180;
  const double angle = tilt.norm();
  Turn result = turn;
  if (angle > 0) result.axis = Eigen::Quaterniond(Eigen::AngleAxisd(angle, tilt / angle)) * turn.axis;
  return result;
}

// By the tilts about camera x and z, degrees.
class Gap : public cv::MinProblemSolver::Function {
 public:
  Gap(const Silhouettes& silhouettes, const Turn& turn) : silhouettes_(silhouettes), turn_(turn) {}
  int getDims() const override { return 2; }
  double calc(const double* deg) const override { return silhouettes_.gap_px(tilted(turn_, deg[0], deg[1])); }

 private:
  const Silhouettes& silhouettes_;
  const Turn& turn_;
};

}  // namespace

void tilt_axis_by_silhouettes(const std::vector<View>& views, Turn& turn) {
  const Silhouettes silhouettes(views);
  cv::Mat_<double> best = cv::Mat_<double>::zeros(1, 2);
  const cv::Mat_<double> first_step(1, 2, kFirstStepDeg);
  const cv::TermCriteria criteria(cv::TermCriteria::MAX_ITER + cv::TermCriteria::EPS, kMostSteps, kGainPx);
  const double before = silhouettes.gap_px(turn);
  const double after =
      cv::DownhillSolver::create(cv::makePtr<Gap>(silhouettes, turn), first_step, criteria)->minimize(best);
  if (after < before - kGainPx) turn = tilted(turn, best(0), best(1));
}

}  // namespace livecap
