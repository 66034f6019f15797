#include "image/upright_edges.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "base/text.h"
#include "image/person_gate.h"
#include "livecap/error.h"

namespace livecap {
namespace {

using Eigen::Vector3d;

constexpr double kRadPerDeg = std::numbers::pi / 180;
constexpr int kMostRows = 1080;        // a larger picture is made smaller
constexpr double kLeastLength = 0.02;  // of an edge, by the picture's height
constexpr double kMostLeaning = 40 * kRadPerDeg;
constexpr double kBlurPx = 1, kAlongPx = 1;  // of the smaller picture
constexpr double kMostPitch = 35 * kRadPerDeg, kMostRoll = 10 * kRadPerDeg, kApart = 0.5 * kRadPerDeg;
// Standard deviations: of an edge's direction, of its ends; and of up by all edges, whose lens and walls are not quite
// straight either.
constexpr double kEdgeDeviation = 0.25 * kRadPerDeg, kEndDeviationPx = 0.35, kUprightDeviation = 0.4 * kRadPerDeg;
constexpr double kDoubtful = 1.5;    // deviations; beyond it an edge counts less (Geman and McClure)
constexpr double kAgrees = 3;        // deviations
constexpr int kLeastEdges = 6;       // that last
constexpr double kLeastShare = 0.3;  // of the length of all that lean no further than kMostLeaning
constexpr int kRefinements = 20;
constexpr double kBesidePerson = 0.02;  // of the picture's height: edges so near a person are taken for their outline

struct Edge {
  Vector3d normal;  // unit, of the plane through it and the camera: up lies in it
  double length_px = 0;
  double deviation = 0;  // rad
};

Vector3d up_at(double pitch, double roll) {
  return {std::sin(roll) * std::cos(pitch), -std::cos(roll) * std::cos(pitch), std::sin(pitch)};
}

// Ends of the edges that lean no further than kMostLeaning and are long enough, px of `gray`.
std::vector<cv::Vec4f> segments(const cv::Mat& gray) {
  std::vector<cv::Vec4f> found;
  cv::createLineSegmentDetector(cv::LSD_REFINE_STD)->detect(gray, found);
  std::erase_if(found, [&](const cv::Vec4f& s) {
    const double x = std::abs(s[2] - s[0]), y = std::abs(s[3] - s[1]);
    return std::hypot(x, y) < kLeastLength * gray.rows || std::atan2(x, y) > kMostLeaning;
  });
  return found;
}

// Whether b runs where a does, of the same sense, along half of a.
bool runs_along(const cv::Vec4f& a, const cv::Vec4f& b) {
  if ((a[3] - a[1]) * (b[3] - b[1]) < 0) return false;
  const auto x_at = [](const cv::Vec4f& s, double y) { return s[0] + (s[2] - s[0]) * (y - s[1]) / (s[3] - s[1]); };
  const double top = std::max(std::min(a[1], a[3]), std::min(b[1], b[3]));
  const double bottom = std::min(std::max(a[1], a[3]), std::max(b[1], b[3]));
  if (bottom - top < std::abs(a[3] - a[1]) / 2) return false;
  return std::abs(x_at(a, top) - x_at(b, top)) < kAlongPx && std::abs(x_at(a, bottom) - x_at(b, bottom)) < kAlongPx;
}

// Of fine stripes, edges follow columns of pixels instead of the stripes, and all of them alike. They are others in a
// picture that is blurred a little, where edges of things stay.
std::vector<cv::Vec4f> lasting_segments(const cv::Mat& gray) {
  cv::Mat blurred;
  cv::GaussianBlur(gray, blurred, {}, kBlurPx);
  const std::vector<cv::Vec4f> last = segments(blurred);
  std::vector<cv::Vec4f> found = segments(gray);
  std::erase_if(found, [&](const cv::Vec4f& s) {
    return std::none_of(last.begin(), last.end(), [&](const cv::Vec4f& other) { return runs_along(s, other); });
  });
  return found;
}

std::vector<Edge> leaning_edges(const ImageRgb& picture, const ImageGray& person, const Camera& camera) {
  const cv::Mat rgb(picture.height, picture.width, CV_8UC3, const_cast<uint8_t*>(picture.pixels.data()));
  cv::Mat gray;
  cv::cvtColor(rgb, gray, cv::COLOR_RGB2GRAY);
  const double scale = std::min(1.0, double(kMostRows) / picture.height);
  if (scale < 1) {
    const cv::Size smaller(std::max(1, int(std::lround(scale * gray.cols))), kMostRows);
    cv::resize(gray, gray, smaller, 0, 0, cv::INTER_AREA);
  }

  ImageGray near_person = person;
  if (!person.pixels.empty()) grow_by_disc(near_person, int(std::ceil(kBesidePerson * person.height)));
  const auto is_person = [&](double x, double y) {
    if (near_person.pixels.empty()) return false;
    const int column = std::clamp(int(std::lround(x)), 0, near_person.width - 1);
    const int row = std::clamp(int(std::lround(y)), 0, near_person.height - 1);
    return near_person.pixels[size_t(row) * near_person.width + column] != 0;
  };
  const auto ray = [&](double x, double y) {
    return Vector3d((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1);
  };
  std::vector<Edge> edges;
  for (const cv::Vec4f& s : lasting_segments(gray)) {
    // Pixel centres are at integers in both pictures.
    const auto full = [&](float v) { return (v + 0.5) / scale - 0.5; };
    const double x0 = full(s[0]), y0 = full(s[1]), x1 = full(s[2]), y1 = full(s[3]);
    const double length = std::hypot(x1 - x0, y1 - y0);
    if (is_person(x0, y0) || is_person(x1, y1) || is_person((x0 + x1) / 2, (y0 + y1) / 2)) continue;
    edges.push_back({ray(x0, y0).cross(ray(x1, y1)).normalized(), length,
                     std::hypot(kEdgeDeviation, kEndDeviationPx / scale / length)});
  }
  return edges;
}

// Where most of the length agrees.
Vector3d best_on_grid(const std::vector<Edge>& edges) {
  Vector3d best = -Vector3d::UnitY();
  double most = 0;
  for (double pitch = -kMostPitch; pitch <= kMostPitch; pitch += kApart) {
    for (double roll = -kMostRoll; roll <= kMostRoll; roll += kApart) {
      const Vector3d up = up_at(pitch, roll);
      double agreeing = 0;
      for (const Edge& edge : edges) {
        const double off = edge.normal.dot(up) / edge.deviation;
        if (std::abs(off) < 2 * kAgrees) agreeing += edge.length_px * std::exp(-off * off / 2);
      }
      if (agreeing > most) most = agreeing, best = up;
    }
  }
  return best;
}

}  // namespace

std::optional<Upright> upright_by_edges(const ImageRgb& picture, const ImageGray& person, const Camera& camera) {
  if (picture.width != camera.width || picture.height != camera.height ||
      (!person.pixels.empty() && (person.width != picture.width || person.height != picture.height)))
    throw LogicError(format("upright edges: a picture of %d x %d, a mask of %d x %d, a camera of %d x %d",
                            picture.width, picture.height, person.width, person.height, camera.width, camera.height));
  const std::vector<Edge> edges = leaning_edges(picture, person, camera);
  if (int(edges.size()) < kLeastEdges) return std::nullopt;

  Upright found;
  found.up = best_on_grid(edges);
  Eigen::Matrix<double, 3, 2> tangent;
  Eigen::Matrix2d normal;
  for (int k = 0; k < kRefinements; ++k) {
    tangent.col(0) = found.up.cross(Vector3d::UnitZ()).normalized();
    tangent.col(1) = found.up.cross(tangent.col(0));
    normal.setZero();
    Eigen::Vector2d gradient = Eigen::Vector2d::Zero();
    for (const Edge& edge : edges) {
      const double off = edge.normal.dot(found.up) / edge.deviation;
      const double weight = std::pow(1 + std::pow(off / kDoubtful, 2), -2);
      const Eigen::Vector2d row = tangent.transpose() * edge.normal / edge.deviation;
      normal += weight * row * row.transpose();
      gradient += weight * off * row;
    }
    const Eigen::Vector2d move = normal.ldlt().solve(-gradient);
    if (!move.allFinite()) return std::nullopt;
    found.up = (found.up + tangent * move).normalized();
  }
  double agreeing = 0, all = 0;
  for (const Edge& edge : edges) {
    all += edge.length_px;
    if (std::abs(edge.normal.dot(found.up)) > kAgrees * edge.deviation) continue;
    agreeing += edge.length_px;
    ++found.n_edges;
  }
  const bool in_range = std::abs(std::asin(found.up.z())) < kMostPitch + kApart &&
                        std::abs(std::atan2(found.up.x(), -found.up.y())) < kMostRoll + kApart;
  if (found.n_edges < kLeastEdges || agreeing < kLeastShare * all || !in_range) return std::nullopt;
  const Eigen::Matrix2d spread = normal.inverse() + std::pow(kUprightDeviation, 2) * Eigen::Matrix2d::Identity();
  if (!spread.allFinite()) return std::nullopt;
  found.information = tangent * spread.inverse() * tangent.transpose();
  return found;
}

}  // namespace livecap
