#include "calibrate/calibrate.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "base/median.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap {

namespace {

constexpr double kLeastTurnDeg = 12;      // the planes of at least two views must differ so much
constexpr double kGoodTiltDeg = 15;       // a tilt that counts
constexpr double kLargestSigma = 0.01;    // of the focal length: above it, it is not determined
constexpr double kDoubtfulSigma = 0.003;  // above it, more views are asked for
constexpr double kOutlier = 3;            // times the median view's RMS
constexpr double kLeastOutlierPx = 0.4;
constexpr double kUsefulK3 = 0.95;  // share of the RMS that must remain at most with k3

constexpr const char* kNinths[9] = {"upper left", "upper middle", "upper right",  "left",       "middle",
                                    "right",      "lower left",   "lower middle", "lower right"};
constexpr const char* kSides[4] = {"left", "right", "upper", "lower"};

struct Points {
  std::vector<std::vector<cv::Point3f>> board;
  std::vector<std::vector<cv::Point2f>> pixels;
};

Points points_of(const std::vector<BoardView>& views) {
  Points points;
  for (const BoardView& view : views) {
    if (!view.left_out.empty()) continue;
    points.board.emplace_back();
    points.pixels.emplace_back();
    for (const auto& p : view.corners.board)
      points.board.back().emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()), 0.0f);
    for (const auto& p : view.corners.pixels)
      points.pixels.back().emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  }
  return points;
}

// The board's normal towards the camera, from its perspective alone, for a camera with focal length max(width, height).
Eigen::Vector3d rough_normal(const BoardCorners& corners, int width, int height) {
  const double focal = std::max(width, height), cx = (width - 1) / 2.0, cy = (height - 1) / 2.0;
  std::vector<cv::Point2d> from, to;
  for (size_t i = 0; i < corners.board.size(); ++i) {
    from.emplace_back(corners.board[i].x(), corners.board[i].y());
    to.emplace_back((corners.pixels[i].x() - cx) / focal, (corners.pixels[i].y() - cy) / focal);
  }
  const cv::Mat h = cv::findHomography(from, to);
  if (h.empty()) return Eigen::Vector3d::Zero();
  const auto column = [&](int k) {
    return Eigen::Vector3d(h.at<double>(0, k), h.at<double>(1, k), h.at<double>(2, k));
  };
  const Eigen::Vector3d normal = column(0).cross(column(1)).normalized();
  return normal.z() > 0 ? Eigen::Vector3d(-normal) : normal;
}

// The largest angle between the planes of two views, degrees. Distortion and an unknown focal length matter little for
// whether there is any.
double largest_turn_deg(const BoardViews& gathered) {
  std::vector<Eigen::Vector3d> normals;
  for (const BoardView& view : gathered.views)
    normals.push_back(rough_normal(view.corners, gathered.width, gathered.height));
  double least = 1;
  for (const auto& a : normals)
    for (const auto& b : normals) least = std::min(least, a.dot(b));
  return std::acos(std::clamp(least, -1.0, 1.0)) * 180 / M_PI;
}

struct Solution {
  cv::Mat matrix, distortion, sigmas, view_rms;
  std::vector<cv::Mat> rotations, translations;
  double rms = 0;
};

Solution solve(const Points& points, int width, int height, bool with_k3) {
  Solution s;
  cv::Mat extrinsic_sigmas;
  try {
    s.rms = cv::calibrateCamera(points.board, points.pixels, {width, height}, s.matrix, s.distortion, s.rotations,
                                s.translations, s.sigmas, extrinsic_sigmas, s.view_rms, with_k3 ? 0 : cv::CALIB_FIX_K3,
                                {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 100, 1e-10});
  } catch (const cv::Exception& error) {
    throw ConfigError("calibrate: the views do not determine a camera (" + error.err + ")");
  }
  return s;
}

// Solves with and without k3 and keeps it when it explains something.
Solution solve_best(const std::vector<BoardView>& views, int width, int height) {
  const Points points = points_of(views);
  Solution plain = solve(points, width, height, false);
  if (points.board.size() < 2 * kMinBoardViews) return plain;
  Solution with_k3 = solve(points, width, height, true);
  return with_k3.rms < kUsefulK3 * plain.rms ? with_k3 : plain;
}

// Leaves out views that fit much worse than the others, one solve after the other. Returns the last.
Solution solve_without_outliers(int width, int height, std::vector<BoardView>& views) {
  for (;;) {
    Solution solution = solve_best(views, width, height);
    std::vector<double> rms;
    int next = 0;
    for (BoardView& view : views)
      if (view.left_out.empty()) rms.push_back(view.rms_px = solution.view_rms.at<double>(next++));
    const double limit = std::max(kOutlier * median(rms), kLeastOutlierPx);
    int n_out = 0;
    for (BoardView& view : views) {
      if (!view.left_out.empty() || view.rms_px <= limit) continue;
      view.left_out = format("%.2f px, the others %.2f", view.rms_px, median(rms));
      ++n_out;
    }
    if (n_out == 0) return solution;
    if (static_cast<int>(rms.size()) - n_out < kMinBoardViews)
      throw ConfigError(format(
          "calibrate: %d of %zu views do not fit the others (more than %.1f px off) and fewer than %d are left; is "
          "the board flat, the zoom and focus fixed, and is it always the same board?",
          n_out, views.size(), limit, kMinBoardViews));
  }
}

void look_at_coverage(int width, int height, const Solution& solution, Calibration& result) {
  int n_corners = 0;
  for (const BoardView& view : result.views) {
    if (!view.left_out.empty()) continue;
    for (const auto& p : view.corners.pixels) {
      const int x = std::clamp(static_cast<int>(3 * (p.x() + 0.5) / width), 0, 2),
                y = std::clamp(static_cast<int>(3 * (p.y() + 0.5) / height), 0, 2);
      ++result.coverage[3 * y + x], ++n_corners;
    }
  }
  std::string bare;
  for (int i = 0; i < 9; ++i) {
    result.coverage[i] /= std::max(n_corners, 1);
    if (result.coverage[i] < 0.02) bare += std::string(bare.empty() ? "" : ", ") + kNinths[i];
  }
  if (!bare.empty())
    result.notes.push_back("hardly a corner in the picture's " + bare + ": add views with the board there");

  for (size_t i = 0; i < solution.rotations.size(); ++i) {
    cv::Mat rotation;
    cv::Rodrigues(solution.rotations[i], rotation);
    Eigen::Vector3d n(rotation.at<double>(0, 2), rotation.at<double>(1, 2), rotation.at<double>(2, 2));
    if (n.z() > 0) n = -n;
    // A board that faces right (normal to +x) has its right side farther away.
    const double right = std::atan2(n.x(), -n.z()) * 180 / M_PI, lower = std::atan2(n.y(), -n.z()) * 180 / M_PI;
    const double tilts[4] = {-right, right, -lower, lower};
    for (int k = 0; k < 4; ++k) result.tilts_deg[k] = std::max(result.tilts_deg[k], tilts[k]);
  }
  std::string missing;
  for (int k = 0; k < 4; ++k)
    if (result.tilts_deg[k] < kGoodTiltDeg) missing += std::string(missing.empty() ? "" : ", ") + kSides[k];
  if (!missing.empty())
    result.notes.push_back("no view in which this side of the board is farther away by 15 degrees or more: " + missing +
                           "; add some");
}

}  // namespace

Calibration calibrate(const BoardViews& gathered) {
  const int width = gathered.width, height = gathered.height;
  if (static_cast<int>(gathered.views.size()) < kMinBoardViews)
    throw ConfigError(format("calibrate: %zu views of the board; at least %d are needed, 15 to 30 are good",
                             gathered.views.size(), kMinBoardViews));
  if (const double turn = largest_turn_deg(gathered); turn < kLeastTurnDeg)
    throw ConfigError(
        format("calibrate: in all %zu views the board is parallel within %.0f degrees, which leaves the focal length "
               "open; tilt it by 20 to 40 degrees to all four sides",
               gathered.views.size(), std::max(turn, 1.0)));

  Calibration result;
  result.notes = gathered.notes;
  result.views = gathered.views;
  const Solution solution = solve_without_outliers(width, height, result.views);
  Camera& camera = result.camera;
  camera.width = width, camera.height = height;
  camera.fx = solution.matrix.at<double>(0, 0), camera.fy = solution.matrix.at<double>(1, 1);
  camera.cx = solution.matrix.at<double>(0, 2), camera.cy = solution.matrix.at<double>(1, 2);
  for (int k = 0; k < 5; ++k) camera.distortion[k] = solution.distortion.at<double>(k);
  result.rms_px = solution.rms;
  result.focal_sigma = std::max(solution.sigmas.at<double>(0) / camera.fx, solution.sigmas.at<double>(1) / camera.fy);
  for (const BoardView& view : result.views) {
    if (view.left_out.empty())
      ++result.n_used;
    else
      result.notes.push_back(view.name + ": does not fit (" + view.left_out + "); left out");
  }
  const bool sane = std::isfinite(camera.fx) && camera.fx > 0 && camera.fy > 0 && std::isfinite(result.focal_sigma) &&
                    std::abs(camera.cx - width / 2.0) < width / 2.0 &&
                    std::abs(camera.cy - height / 2.0) < height / 2.0;
  if (!sane || result.focal_sigma > kLargestSigma)
    throw ConfigError(format(
        "calibrate: %d views leave the focal length open (%.0f px, uncertain by %.1f %%); add views tilted by 20 "
        "to 40 degrees to all four sides, near and in the corners of the picture",
        result.n_used, camera.fx, 100 * result.focal_sigma));
  if (result.rms_px > kLargestRmsPx)
    throw ConfigError(
        format("calibrate: the corners are %.1f px off; is the board flat, are zoom and focus fixed, and "
               "is it always the same board?",
               result.rms_px));
  if (result.rms_px > kDoubtfulRmsPx)
    result.notes.push_back(format(
        "the corners are %.1f px off (below 0.5 is usual): a bent board, autofocus or a moving board", result.rms_px));
  if (result.focal_sigma > kDoubtfulSigma)
    result.notes.push_back(
        format("the focal length is uncertain by %.1f %%: more views help", 100 * result.focal_sigma));
  look_at_coverage(width, height, solution, result);
  return result;
}

}  // namespace livecap
