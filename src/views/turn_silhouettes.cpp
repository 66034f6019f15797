#include "views/turn_silhouettes.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "geometry/rotation_vector.h"

namespace livecap {

namespace {

using Eigen::Isometry3d;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;
using Vector6 = Eigen::Matrix<double, 6, 1>;  // of a view's pose: rotation about the turn's centre, shift; camera axes

constexpr int kMaxSidePx = 640;
constexpr int kPointsPerOutline = 60;
constexpr double kReachMm = 800;  // of an arm from the axis
constexpr double kStepMm = 10;    // along a ray
constexpr double kMostPx = 6;     // of one outline's point: a mask with a hole counts no more
constexpr double kSigmaPx = 2;    // of an outline; Cauchy beyond
constexpr int kMostRounds = 12;
constexpr double kGainPx = 1e-3;  // less is no gain

// How poses drift between views this far apart, and how far at all. Standard deviations.
constexpr double kNeighborsRad = 5 * M_PI / 180;
constexpr double kDriftRad = 4e-3, kDriftMm = 2;
constexpr double kFarthestRad = 0.05, kFarthestMm = 50;

// Distances to one view's outline, px, positive inside of it.
struct Outline {
  cv::Mat_<float> distance;
  std::vector<cv::Point> points;
};

// One outline at a point of a ray of another view.
struct Bound {
  int view = -1;
  double distance_px = std::numeric_limits<double>::infinity();
  double along = 0;                      // how the distance changes with the ray's depth, px/mm
  Vector3d place = Vector3d::Zero();     // of the point, in that view's camera, mm
  Vector3d by_place = Vector3d::Zero();  // px/mm
};

// How far an outline's point misses what the others allow, and what that does when poses move.
struct Miss {
  double px = 0;
  std::vector<std::pair<int, Vector6>> by_pose;
};

Vector6 stiffness(double rad, double mm) {
  Vector6 s;
  s << Vector3d::Constant(1 / (rad * rad)), Vector3d::Constant(1 / (mm * mm));
  return s;
}

class Silhouettes {
 public:
  explicit Silhouettes(const std::vector<View>& views) {
    const Camera& camera = views.front().camera;
    scale_ = std::min(1.0, static_cast<double>(kMaxSidePx) / std::max(camera.width, camera.height));
    fx_ = scale_ * camera.fx, fy_ = scale_ * camera.fy;
    cx_ = scale_ * (camera.cx + 0.5) - 0.5, cy_ = scale_ * (camera.cy + 0.5) - 0.5;
    for (const View& view : views) outlines_.push_back(outline_of(view.mask));
    const int n = n_views();
    stride_ = std::max(1, static_cast<int>(0.38 * n));
    while (std::gcd(stride_, n) > 1) ++stride_;
  }

  int n_views() const { return static_cast<int>(outlines_.size()); }

  // Returns the mean miss; adds the normal equations of all poses, 6 a view.
  double linearize(const Turn& turn, MatrixXd& a, VectorXd& b) const {
    std::vector<Isometry3d> poses, inverse;
    for (int i = 0; i < n_views(); ++i) {
      poses.push_back(turn.camera_from_body(i));
      inverse.push_back(poses.back().inverse());
    }
    double sum = 0;
    size_t n = 0;
    for (int i = 0; i < n_views(); ++i)
      for (const cv::Point& point : outlines_[i].points) {
        const Vector3d ray((point.x - cx_) / fx_, (point.y - cy_) / fy_, 1);
        const auto [depth, deepest] = deepest_px(poses, inverse[i], i, ray, turn.center_mm.z());
        sum += std::min(kMostPx, -deepest);
        ++n;
        if (deepest >= 0 || deepest <= -kMostPx) continue;
        const Miss miss = miss_at(poses, inverse[i], i, ray, depth, deepest, turn.center_mm);
        const double weight = 1 / (kSigmaPx * kSigmaPx + miss.px * miss.px);
        for (const auto& [row, by_row] : miss.by_pose) {
          b.segment<6>(6 * row) += weight * miss.px * by_row;
          for (const auto& [column, by_column] : miss.by_pose)
            a.block<6, 6>(6 * row, 6 * column) += weight * by_row * by_column.transpose();
        }
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

  // Where a view's ray is deepest inside of all other outlines, mm from the camera, and how deep; at most 0.
  std::pair<double, double> deepest_px(const std::vector<Isometry3d>& poses, const Isometry3d& body_from_camera,
                                       int view, const Vector3d& ray, double middle_mm) const {
    double at = middle_mm, deepest = -2 * kMostPx;
    for (double z = middle_mm - kReachMm; z < middle_mm + kReachMm && deepest < 0; z += kStepMm) {
      const Vector3d body = body_from_camera * (z * ray);
      double least = 0;
      for (int k = 0; k < n_views() && least > deepest; ++k) {
        const int other = (view + n_views() / 4 + k * stride_) % n_views();  // from the side first
        if (other != view) least = std::min(least, distance_px(outlines_[other], poses[other] * body));
      }
      if (least > deepest) deepest = least, at = z;
    }
    return {at, deepest};
  }

  // The deepest point is held from both sides: by an outline that it would leave nearer to the camera, and by one that
  // it would leave beyond. The miss where both are equal, as they change along the ray, and by their poses and the
  // ray's own.
  Miss miss_at(const std::vector<Isometry3d>& poses, const Isometry3d& body_from_camera, int view, const Vector3d& ray,
               double depth_mm, double deepest, const Vector3d& center) const {
    const Vector3d body = body_from_camera * (depth_mm * ray);
    std::array<Bound, 2> sides;  // the distance falls, rises along the ray
    for (int k = 0; k < n_views(); ++k) {
      if (k == view || outlines_[k].distance.empty()) continue;
      const Vector3d place = poses[k] * body;
      const double distance = distance_px(outlines_[k], place);
      if (distance > deepest + kMostPx / 2) continue;  // no bound here
      const Vector3d by_place = slope(outlines_[k], place);
      const double along = by_place.dot(poses[k].linear() * body_from_camera.linear() * ray);
      Bound& side = sides[along > 0];
      if (distance < side.distance_px) side = {k, distance, along, place, by_place};
    }
    const double falls = -sides[0].along, rises = sides[1].along;
    std::array<double, 2> share = {sides[0].view >= 0 ? 1.0 : 0.0, sides[1].view >= 0 ? 1.0 : 0.0};
    if (share[0] + share[1] > 1 && falls + rises > 0) share = {rises / (falls + rises), falls / (falls + rises)};
    Miss miss;
    Vector6 by_own = Vector6::Zero();
    for (int s = 0; s < 2; ++s) {
      if (!(share[s] > 0)) continue;
      const Bound& side = sides[s];
      miss.px -= share[s] * side.distance_px;
      const Vector3d by_place = -share[s] * side.by_place;
      const Vector3d by_point = -(poses[side.view].linear() * body_from_camera.linear()).transpose() * by_place;
      Vector6 by_other, own;
      by_other << (side.place - center).cross(by_place), by_place;
      own << (depth_mm * ray - center).cross(by_point), by_point;
      by_own += own;
      miss.by_pose.emplace_back(side.view, by_other);
    }
    miss.by_pose.emplace_back(view, by_own);
    return miss;
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

  // Of the distance by the place in the camera, over a pixel, px/mm.
  Vector3d slope(const Outline& outline, const Vector3d& p) const {
    const Vector3d right(p.z() / (2 * fx_), 0, 0), down(0, p.z() / (2 * fy_), 0);
    const Eigen::Vector2d by_pixel(distance_px(outline, p + right) - distance_px(outline, p - right),
                                   distance_px(outline, p + down) - distance_px(outline, p - down));
    return pixel_by_point(fx_, fy_, p).transpose() * by_pixel;
  }

  int stride_ = 1;  // from one view to the next that is looked at: soon all sides are
  double scale_ = 1, fx_ = 1, fy_ = 1, cx_ = 0, cy_ = 0;
  std::vector<Outline> outlines_;
};

// What the poses have moved by stays small, and neighbours have moved alike: adds that to the normal equations.
void add_priors(const Turn& turn, const VectorXd& moved, MatrixXd& a, VectorXd& b) {
  const int n = static_cast<int>(turn.angle_rad.size());
  const Vector6 far = stiffness(kFarthestRad, kFarthestMm);
  for (int i = 0; i < n; ++i) {
    a.diagonal().segment<6>(6 * i) += far;
    b.segment<6>(6 * i) += far.cwiseProduct(moved.segment<6>(6 * i));
    const int j = (i + 1) % n;
    const double apart = std::abs(std::remainder(turn.angle_rad[j] - turn.angle_rad[i], 2 * M_PI));
    const Vector6 near = stiffness(kDriftRad, kDriftMm) * kNeighborsRad / std::max(apart, kNeighborsRad / 5);
    const Vector6 pull = near.cwiseProduct(moved.segment<6>(6 * j) - moved.segment<6>(6 * i));
    b.segment<6>(6 * j) += pull;
    b.segment<6>(6 * i) -= pull;
    a.diagonal().segment<6>(6 * i) += near;
    a.diagonal().segment<6>(6 * j) += near;
    a.block<6, 6>(6 * i, 6 * j).diagonal() -= near;
    a.block<6, 6>(6 * j, 6 * i).diagonal() -= near;
  }
}

void move(const VectorXd& step, Turn& turn) {
  for (size_t i = 0; i < turn.deviation.size(); ++i) {
    const Eigen::Quaterniond turned = rotation_of(step.segment<3>(6 * i));
    TurnDeviation& deviation = turn.deviation[i];
    deviation.rotation = (turned * deviation.rotation).normalized();
    deviation.shift_mm = turned * deviation.shift_mm + step.segment<3>(6 * i + 3);
  }
}

}  // namespace

void align_turn_by_silhouettes(const std::vector<View>& views, Turn& turn) {
  const Silhouettes silhouettes(views);
  const int n = 6 * silhouettes.n_views();
  Turn next = turn;
  VectorXd moved = VectorXd::Zero(n);
  double best = std::numeric_limits<double>::infinity();
  for (int round = 0; round <= kMostRounds; ++round) {
    MatrixXd a = MatrixXd::Zero(n, n);
    VectorXd b = VectorXd::Zero(n);
    const double gap = silhouettes.linearize(next, a, b);
    if (!(gap < best - kGainPx)) break;
    best = gap;
    turn = next;
    add_priors(turn, moved, a, b);
    const VectorXd step = -a.ldlt().solve(b);
    move(step, next);
    moved += step;
  }
}

}  // namespace livecap
