// Pictures of calibration boards by a lens with distortion: each pixel's ray is found by Newton steps on the lens
// equation and cut with the board's plane; nothing of OpenCV but the drawing of markers.
#pragma once

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "base/image_rgb.h"
#include "livecap/camera.h"

namespace livecap::test {

// Grey value in [0,1] at a point of the board's plane, in squares; the origin is the middle of the board.
using BoardPaint = std::function<double(double x, double y)>;

// columns x rows squares with a white rim of one square on a grey wall.
inline BoardPaint chessboard_paint(int columns, int rows) {
  return [=](double x, double y) {
    const double u = x + columns / 2.0, v = y + rows / 2.0;
    if (u < -1 || v < -1 || u > columns + 1 || v > rows + 1) return 0.45;
    if (u < 0 || v < 0 || u >= columns || v >= rows) return 0.92;
    return (static_cast<int>(u) + static_cast<int>(v)) % 2 == 0 ? 0.06 : 0.92;
  };
}

inline BoardPaint charuco_paint(int columns, int rows, double marker_share, int dictionary) {
  constexpr int kSquarePx = 48;
  cv::Mat drawn;
  cv::aruco::CharucoBoard::create(columns, rows, 1.0f, static_cast<float>(marker_share),
                                  cv::aruco::getPredefinedDictionary(dictionary))
      ->draw({columns * kSquarePx, rows * kSquarePx}, drawn);
  return [=](double x, double y) {
    const double u = x + columns / 2.0, v = y + rows / 2.0;
    if (u < -1 || v < -1 || u > columns + 1 || v > rows + 1) return 0.45;
    if (u < 0 || v < 0 || u >= columns || v >= rows) return 0.92;
    return drawn.at<uint8_t>(std::min(drawn.rows - 1, static_cast<int>(v * kSquarePx)),
                             std::min(drawn.cols - 1, static_cast<int>(u * kSquarePx))) > 127
               ? 0.92
               : 0.06;
  };
}

class BoardCamera {
 public:
  explicit BoardCamera(const Camera& camera) : camera_(camera) {
    for (int row = 0; row < kSamples * camera.height; ++row)
      for (int column = 0; column < kSamples * camera.width; ++column)
        rays_.push_back(ray((column + 0.5) / kSamples - 0.5, (row + 0.5) / kSamples - 0.5));
  }

  // blur_px: standard deviation. noise: 8-bit levels.
  ImageGray take(const BoardPaint& paint, const Eigen::Isometry3d& camera_from_board, double blur_px, double noise,
                 unsigned seed) const {
    const int w = camera_.width, h = camera_.height;
    const Eigen::Isometry3d board_from_camera = camera_from_board.inverse();
    const Eigen::Vector3d eye = board_from_camera.translation();
    cv::Mat picture(h, w, CV_32F, cv::Scalar(0));
    for (int v = 0; v < h; ++v)
      for (int u = 0; u < w; ++u) {
        double sum = 0;
        for (int j = 0; j < kSamples; ++j)
          for (int i = 0; i < kSamples; ++i) {
            const Eigen::Vector2d& r = rays_[(static_cast<size_t>(v) * kSamples + j) * w * kSamples + u * kSamples + i];
            const Eigen::Vector3d d = board_from_camera.linear() * Eigen::Vector3d(r.x(), r.y(), 1);
            const double t = -eye.z() / d.z();
            sum += t > 0 ? paint(eye.x() + t * d.x(), eye.y() + t * d.y()) : 0.45;
          }
        picture.at<float>(v, u) = static_cast<float>(255 * sum / (kSamples * kSamples));
      }
    if (blur_px > 0) cv::GaussianBlur(picture, picture, {0, 0}, blur_px);
    ImageGray image{w, h, std::vector<uint8_t>(size_t(w) * h)};
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, 1);
    for (size_t i = 0; i < image.pixels.size(); ++i)
      image.pixels[i] =
          static_cast<uint8_t>(std::clamp(picture.at<float>(i / w, i % w) + noise * normal(random), 0.0, 255.0));
    return image;
  }

 private:
  static constexpr int kSamples = 3;  // per side of a pixel

  Eigen::Vector2d distorted(const Eigen::Vector2d& p) const {
    const auto& [k1, k2, p1, p2, k3] = camera_.distortion;
    const double x = p.x(), y = p.y(), r2 = p.squaredNorm(), radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
    return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x), y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
  }

  Eigen::Vector2d ray(double u, double v) const {
    const Eigen::Vector2d seen((u - camera_.cx) / camera_.fx, (v - camera_.cy) / camera_.fy);
    Eigen::Vector2d p = seen;
    for (int i = 0; i < 6; ++i) {
      constexpr double h = 1e-6;
      Eigen::Matrix2d jacobian;
      for (int k = 0; k < 2; ++k) jacobian.col(k) = (distorted(p + h * Eigen::Vector2d::Unit(k)) - distorted(p)) / h;
      p += jacobian.inverse() * (seen - distorted(p));
    }
    return p;
  }

  Camera camera_;
  std::vector<Eigen::Vector2d> rays_;  // [samples] on the plane z = 1
};

// The board (half sizes in squares) somewhere in the picture, tilted up to tilt_deg in a direction that goes around
// with `index`, turned in the picture by up to 25 degrees.
inline Eigen::Isometry3d board_pose(const Camera& camera, double half_width, double half_height, int index,
                                    double tilt_deg, unsigned seed) {
  std::mt19937 random(seed * 7919 + index);
  const auto uniform = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(random);
  };
  const double direction = 2 * M_PI * index * 0.381966;
  const Eigen::Vector3d axis(std::cos(direction), std::sin(direction), 0);
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = (Eigen::AngleAxisd(tilt_deg * uniform(0.7, 1) * M_PI / 180, axis) *
                   Eigen::AngleAxisd(uniform(-25, 25) * M_PI / 180, Eigen::Vector3d::UnitZ()))
                      .toRotationMatrix();
  const double extent = std::hypot(half_width, half_height) + 1;
  // Fills 70 to 95 per cent of the picture's height, and moves within what is left of the width.
  const double z = camera.fy * extent / (0.5 * camera.height * uniform(0.75, 1.0));
  const double free_x = std::max(0.0, 0.5 * camera.width / camera.fx * z - 0.85 * extent);
  const double free_y = std::max(0.0, 0.5 * camera.height / camera.fy * z - 0.75 * extent);
  pose.translation() = Eigen::Vector3d(uniform(-1, 1) * free_x, uniform(-1, 1) * free_y, z);
  return pose;
}

}  // namespace livecap::test
