#include "render/floor_grid.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "picture/rasterize.h"

namespace livecap::render {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double kSpacingMm = 500, kLineMm = 6;
constexpr double kRadiusMm = 3200, kFadeMm = 1400;  // the floor ends here, the last part of it fades
constexpr double kFloorGray = 196, kLineGray = 150;
constexpr double kCellMm = 16;         // of the shadow
constexpr double kShadowFallMm = 350;  // at this height above the floor a body's shadow is 1/e
constexpr double kShadowBlurMm = 45;
constexpr double kShadowDepth = 0.6;  // of the light that the darkest shadow takes
constexpr int kCells = static_cast<int>(2 * kRadiusMm / kCellMm);

// Share of a pixel of this size [mm on the floor] that a line covers whose middle is this far away.
double line_cover(double away_mm, double pixel_mm) {
  const double low = std::max(away_mm - pixel_mm / 2, -kLineMm / 2),
               high = std::min(away_mm + pixel_mm / 2, kLineMm / 2);
  return std::clamp((high - low) / std::max(pixel_mm, 1e-3), 0.0, 1.0);
}

double nearest_line_mm(double along_mm) {
  return std::abs(along_mm - kSpacingMm * std::round(along_mm / kSpacingMm));
}

double sampled(const cv::Mat1f& map, const Vector2d& place_mm) {
  const Vector2d cell = (place_mm.array() + kRadiusMm) / kCellMm;
  const int x = static_cast<int>(std::floor(cell.x())), y = static_cast<int>(std::floor(cell.y()));
  if (x < 0 || y < 0 || x + 1 >= map.cols || y + 1 >= map.rows) return 0;
  const double fx = cell.x() - x, fy = cell.y() - y;
  return (1 - fy) * ((1 - fx) * map(y, x) + fx * map(y, x + 1)) +
         fy * ((1 - fx) * map(y + 1, x) + fx * map(y + 1, x + 1));
}

}  // namespace

FloorGrid::FloorGrid(const Floor& floor, const Vector3d& place_mm) : floor_(floor) {
  origin_ = place_mm - floor.height_mm(place_mm) * floor.up;
  Vector3d front = -origin_ + floor.up * floor.up.dot(origin_);
  front = front.norm() > 1 ? front.normalized() : floor.up.unitOrthogonal();
  axes_ << floor.up.cross(front).transpose(), front.transpose();
}

void FloorGrid::draw(const Viewpoint& view, std::span<const float> positions, std::span<const int32_t> triangles,
                     ImageRgb& canvas) const {
  const Eigen::Isometry3d camera_from_view = view.view_from_camera.inverse();
  const Vector3d eye = camera_from_view.translation();
  const double eye_height = floor_.height_mm(eye);
  if (eye_height <= 0) return;

  // How much of the body is above each place, the more the closer; 0..1.
  cv::Mat1f shadow(kCells, kCells, 0.0f);
  if (!positions.empty()) {
    std::vector<ScreenPoint> points;
    for (size_t i = 0; i < positions.size(); i += 3) {
      const Vector3d p = Eigen::Map<const Eigen::Vector3f>(&positions[i]).cast<double>();
      const Vector2d cell = ((axes_ * (p - origin_)).array() + kRadiusMm) / kCellMm;
      points.push_back({static_cast<float>(cell.x()), static_cast<float>(cell.y()),
                        static_cast<float>(-std::max(0.0, floor_.height_mm(p)))});
    }
    NearnessImage lowest(kCells, kCells);
    for (size_t i = 0; i + 2 < triangles.size(); i += 3)
      rasterize({points[triangles[i]], points[triangles[i + 1]], points[triangles[i + 2]]}, lowest,
                [&](int x, int y, const float(&)[3], float nearness) {
                  shadow(y, x) = std::exp(nearness / static_cast<float>(kShadowFallMm));
                });
    cv::GaussianBlur(shadow, shadow, cv::Size(), kShadowBlurMm / kCellMm);
  }

  const Eigen::Matrix3d turn = camera_from_view.linear();
  const Vector3d dx = turn.col(0) / view.camera.fx, dy = turn.col(1) / view.camera.fy;  // of a ray, per pixel
  const Vector2d eye_place = axes_ * (eye - origin_);
  for (int y = 0; y < canvas.height; ++y) {
    for (int x = 0; x < canvas.width; ++x) {
      const Vector3d ray = turn.col(2) + (x - view.camera.cx) * dx + (y - view.camera.cy) * dy;
      const double fall = -floor_.up.dot(ray);
      if (fall <= 0) continue;
      const double reach = eye_height / fall;
      const Vector2d place = eye_place + reach * (axes_ * ray);
      const double radius = place.norm();
      if (radius >= kRadiusMm) continue;
      // How far the place moves from this pixel to the next, along each axis.
      const Vector2d along_x = reach * (axes_ * (dx + floor_.up.dot(dx) / fall * ray));
      const Vector2d along_y = reach * (axes_ * (dy + floor_.up.dot(dy) / fall * ray));
      const Vector2d pixel_mm = along_x.cwiseAbs() + along_y.cwiseAbs();
      const double line = std::max(line_cover(nearest_line_mm(place.x()), pixel_mm.x()),
                                   line_cover(nearest_line_mm(place.y()), pixel_mm.y()));
      const double gray = (kFloorGray + line * (kLineGray - kFloorGray)) * (1 - kShadowDepth * sampled(shadow, place));
      const double share = std::clamp((kRadiusMm - radius) / kFadeMm, 0.0, 1.0);
      uint8_t* pixel = &canvas.pixels[3 * (size_t(y) * canvas.width + x)];
      for (int k = 0; k < 3; ++k) pixel[k] = static_cast<uint8_t>(pixel[k] + share * (gray - pixel[k]) + 0.5);
    }
  }
}

}  // namespace livecap::render
