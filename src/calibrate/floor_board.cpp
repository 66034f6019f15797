#include "calibrate/floor_board.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <opencv2/calib3d.hpp>

#include "base/text.h"
#include "image/image_io.h"
#include "livecap/error.h"

namespace livecap {

namespace {

constexpr double kDegPerRad = 180 / M_PI;
constexpr double kLargestTiltDeg = 60;  // of the floor against what is level for a level camera
constexpr double kAroundMm = 1000;      // how far from the board the floor must be known
constexpr double kLargestSigmaMm = 60;
constexpr double kDoubtfulSigmaMm = 15;
constexpr double kAsGood = 1.5;  // the other of a plane's two poses, by its RMS

using Vector6 = Eigen::Matrix<double, 6, 1>;

// (normal, distance): n . p + distance = 0 on the plane.
using Plane = Eigen::Vector4d;

struct BoardPose {
  Vector6 turn_and_move;  // Rodrigues vector and translation, camera from board, mm
  double rms_px = 0;
  Plane plane;
};

// Its normal towards the camera.
Plane plane_of(const Vector6& pose) {
  const double angle = pose.head<3>().norm();
  const Eigen::Matrix3d turn =
      angle > 0 ? Eigen::AngleAxisd(angle, pose.head<3>() / angle).toRotationMatrix() : Eigen::Matrix3d::Identity();
  const Eigen::Vector3d normal = turn.col(2);
  const double distance = -normal.dot(pose.tail<3>());
  return Plane(normal.x(), normal.y(), normal.z(), distance) * (distance < 0 ? -1 : 1);
}

double tilt_deg(const Plane& plane) {
  return std::acos(std::clamp(-plane.y(), -1.0, 1.0)) * kDegPerRad;
}

// The corners as OpenCV takes them, and both poses in which a plane looks nearly alike.
class BoardSight {
 public:
  BoardSight(const BoardCorners& corners, const Camera& camera, double square_mm)
      : matrix_((cv::Mat_<double>(3, 3) << camera.fx, 0, camera.cx, 0, camera.fy, camera.cy, 0, 0, 1)),
        distortion_(camera.distortion.begin(), camera.distortion.end()) {
    for (const auto& p : corners.board) board_.emplace_back(square_mm * p.x(), square_mm * p.y(), 0.0);
    for (const auto& p : corners.pixels) pixels_.emplace_back(p.x(), p.y());
  }

  // The best first.
  std::vector<BoardPose> poses() const {
    std::vector<cv::Mat> turns, moves;
    cv::solvePnPGeneric(board_, pixels_, matrix_, distortion_, turns, moves, false, cv::SOLVEPNP_IPPE);
    std::vector<BoardPose> poses;
    for (size_t i = 0; i < turns.size(); ++i) {
      cv::solvePnPRefineLM(board_, pixels_, matrix_, distortion_, turns[i], moves[i]);
      BoardPose pose;
      for (int k = 0; k < 3; ++k) {
        pose.turn_and_move[k] = turns[i].at<double>(k);
        pose.turn_and_move[3 + k] = moves[i].at<double>(k);
      }
      if (!pose.turn_and_move.allFinite()) continue;
      pose.plane = plane_of(pose.turn_and_move);
      pose.rms_px = std::sqrt(squared_error(pose.turn_and_move) / static_cast<double>(pixels_.size()));
      poses.push_back(pose);
    }
    std::sort(poses.begin(), poses.end(), [](const auto& a, const auto& b) { return a.rms_px < b.rms_px; });
    return poses;
  }

  // Standard deviation of the plane's height at a distance from the board, where it is largest: from the corners'
  // errors through the pose's normal equations to the plane.
  double sigma_mm(const BoardPose& pose, double around_mm) const {
    cv::Mat turn, move, jacobian;
    split(pose.turn_and_move, turn, move);
    std::vector<cv::Point2d> projected;
    cv::projectPoints(board_, turn, move, matrix_, distortion_, projected, jacobian);
    const int n_rows = jacobian.rows;
    Eigen::MatrixXd J(n_rows, 6);
    for (int i = 0; i < n_rows; ++i)
      for (int k = 0; k < 6; ++k) J(i, k) = jacobian.at<double>(i, k);
    const double variance = squared_error(pose.turn_and_move) / std::max(1, n_rows - 6);
    const Eigen::MatrixXd covariance = variance * (J.transpose() * J).inverse();
    Eigen::Matrix<double, 4, 6> plane_by_pose;
    for (int k = 0; k < 6; ++k) {
      const Vector6 step = (k < 3 ? 1e-6 : 1e-3) * Vector6::Unit(k);
      plane_by_pose.col(k) =
          (plane_of(pose.turn_and_move + step) - plane_of(pose.turn_and_move - step)) / (2 * step.norm());
    }
    const Eigen::Matrix4d of_plane = plane_by_pose * covariance * plane_by_pose.transpose();
    const Eigen::Vector3d normal = pose.plane.head<3>(), middle = middle_mm(pose), side = normal.unitOrthogonal();
    double most = 0;
    for (int i = 0; i < 36; ++i) {
      const Eigen::Vector3d p = middle + around_mm * (Eigen::AngleAxisd(M_PI * i / 18, normal) * side);
      const Eigen::Vector4d at(p.x(), p.y(), p.z(), 1);
      const double here = at.dot(of_plane * at);
      if (!(here <= most)) most = here;  // and what is no number stays one
    }
    return std::sqrt(most);
  }

  // In the camera's frame.
  Eigen::Vector3d middle_mm(const BoardPose& pose) const {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const auto& p : board_) sum += Eigen::Vector3d(p.x, p.y, 0);
    const Eigen::Vector3d vector = pose.turn_and_move.head<3>();
    const Eigen::Vector3d middle = sum / static_cast<double>(board_.size());
    return Eigen::AngleAxisd(vector.norm(), vector.normalized()) * middle + pose.turn_and_move.tail<3>();
  }

 private:
  static void split(const Vector6& pose, cv::Mat& turn, cv::Mat& move) {
    turn = (cv::Mat_<double>(3, 1) << pose[0], pose[1], pose[2]);
    move = (cv::Mat_<double>(3, 1) << pose[3], pose[4], pose[5]);
  }

  double squared_error(const Vector6& pose) const {
    cv::Mat turn, move;
    split(pose, turn, move);
    std::vector<cv::Point2d> projected;
    cv::projectPoints(board_, turn, move, matrix_, distortion_, projected);
    double sum = 0;
    for (size_t i = 0; i < pixels_.size(); ++i) sum += (projected[i] - pixels_[i]).ddot(projected[i] - pixels_[i]);
    return sum;
  }

  cv::Mat matrix_;
  std::vector<double> distortion_;
  std::vector<cv::Point3d> board_;
  std::vector<cv::Point2d> pixels_;
};

}  // namespace

void FloorBoardOptions::validate() const {
  board.validate();
  if (picture.empty()) throw ConfigError("calibrate: --floor needs a picture of the board on the floor");
  if (!(square_mm > 0) || !std::isfinite(square_mm))
    throw ConfigError(
        format("--square is %g; with --floor it must be the side of one of the board's squares in mm, "
               "measured on the board",
               square_mm));
}

FloorPicture read_floor_picture(const FloorBoardOptions& options) {
  options.validate();
  const ImageGray image = read_image_gray(options.picture);
  FloorPicture picture{options.picture, image.width, image.height, {}, options.square_mm, {}};
  BoardOptions board = options.board;
  std::string note;
  if (recognize_board({image}, board, note)) picture.corners = find_board(image, board);
  if (picture.corners.empty())
    throw ConfigError(
        options.picture +
        format(
            ": no board with %dx%d %s; it must be sharp, wholly in the picture, have a white rim and squares of some "
            "ten pixels: lay it nearer to the camera, or take a larger one",
            board.columns, board.rows, board.is_charuco() ? "squares" : "inner corners"));
  if (!note.empty()) picture.notes.push_back(note);
  return picture;
}

FloorBoard find_floor(const FloorPicture& picture, const Camera& camera) {
  camera.validate();
  if (picture.width != camera.width || picture.height != camera.height)
    throw IoError(picture.name + format(": the picture is %dx%d, the camera is for %dx%d; take it as the videos are",
                                        picture.width, picture.height, camera.width, camera.height));
  FloorBoard result;
  result.notes = picture.notes;
  const BoardSight sight(picture.corners, camera, picture.square_mm);
  const std::vector<BoardPose> poses = sight.poses();
  if (poses.empty()) throw ConfigError(picture.name + ": the board's corners do not tell where it lies");
  const auto lies = [](const BoardPose& pose) { return tilt_deg(pose.plane) <= kLargestTiltDeg; };
  const BoardPose& pose =
      poses.size() > 1 && !lies(poses[0]) && lies(poses[1]) && poses[1].rms_px < kAsGood * poses[0].rms_px ? poses[1]
                                                                                                           : poses[0];
  if (pose.rms_px > kLargestRmsPx)
    throw ConfigError(picture.name + format(": the corners are %.1f px off; is the board flat, and the camera this "
                                            "one, with its zoom and focus unchanged?",
                                            pose.rms_px));
  if (!lies(pose))
    throw ConfigError(
        picture.name +
        format(": the board %s (%.0f degrees from level for a level camera); it must lie flat on the floor, below the "
               "camera, which looks down by 60 degrees at most, and the picture must be upright",
               pose.plane.y() > 0 ? "seems to hang above the camera" : "seems to stand", tilt_deg(pose.plane)));
  const double height_mm = pose.plane.w();
  result.floor = {{pose.plane.x(), pose.plane.y(), pose.plane.z()}, height_mm};
  Camera above = camera;
  above.floor = result.floor;
  try {
    above.validate();
  } catch (const ConfigError&) {
    throw ConfigError(picture.name + format(": the camera would be %.3g m above the floor; is --square %g the side of "
                                            "a square in mm?",
                                            height_mm / 1000, picture.square_mm));
  }
  result.n_corners = static_cast<int>(picture.corners.pixels.size());
  result.rms_px = pose.rms_px;
  result.tilt = tilt_above(result.floor);
  result.away_mm = sight.middle_mm(pose).norm();
  result.sigma_mm = sight.sigma_mm(pose, kAroundMm);
  const char* larger = "a larger board, or one nearer to where the person will be and to the camera, helps";
  if (!(result.sigma_mm <= kLargestSigmaMm))
    throw ConfigError(picture.name + format(": a metre from the board the floor is uncertain by %.0f mm; %s",
                                            result.sigma_mm, larger));
  if (result.sigma_mm > kDoubtfulSigmaMm)
    result.notes.push_back(
        format("a metre from the board the floor is uncertain by %.0f mm: %s", result.sigma_mm, larger));
  if (result.rms_px > kDoubtfulRmsPx)
    result.notes.push_back(
        format("the board's corners on the floor are %.1f px off (below 0.5 is usual): a bent board, "
               "or zoom or focus changed",
               result.rms_px));
  return result;
}

}  // namespace livecap
