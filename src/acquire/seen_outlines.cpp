#include "acquire/seen_outlines.h"

#include <cmath>
#include <limits>

namespace livecap::acquire {

using Eigen::Vector3d;

namespace {

constexpr double kEdgeOn = 0.2;    // cosine between normal and line of sight
constexpr double kBeyondMm = 12;   // so far out along the normal a point must be outside of the mask,
constexpr double kLeastOutMm = 5;  // by so much, or what ends there is another part of the body
constexpr int kAroundPx = 40;      // of a person's box: at 0.5 mm a pixel all that is asked about
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

}  // namespace

Outline::Outline(const View& view, const Silhouette& silhouette, const PixelBox& box) : view_(view), box_(box) {
  if (silhouette.empty() || box.empty()) return;
  distance_.width = box.width();
  distance_.height = box.height();
  for (int y = box.y0; y < box.y1; ++y) {
    const auto row = silhouette.signed_distance.begin() + static_cast<ptrdiff_t>(y) * silhouette.width;
    distance_.signed_distance.insert(distance_.signed_distance.end(), row + box.x0, row + box.x1);
  }
}

double Outline::outside_mm(const Vector3d& p) const {
  Eigen::Vector2d q;
  if (!view_.project(p, q)) return kUnknown;
  q -= Eigen::Vector2d(box_.x0, box_.y0);
  if (!(q.x() >= 0 && q.y() >= 0 && q.x() < distance_.width - 1 && q.y() < distance_.height - 1)) return kUnknown;
  return distance_at(distance_, q.x(), q.y()) * (view_.camera_from_world * p).z() / view_.camera.fx;
}

double SeenOutline::outside_mm(const Vector3d& p, const Vector3d& normal) const {
  if (std::abs(normal.dot((center - p).normalized())) > kEdgeOn) return kUnknown;
  const double mm = outline.outside_mm(p);
  const bool on_it = std::abs(mm) < kOutlineReachMm && outline.outside_mm(p + kBeyondMm * normal) > kLeastOutMm;
  return on_it ? mm : kUnknown;
}

std::vector<SeenOutline> seen_outlines(const std::vector<View>& views) {
  std::vector<SeenOutline> seen;
  for (size_t i = 0; i < views.size(); ++i) {
    if (views[i].mask.empty()) continue;
    const Silhouette silhouette = make_silhouette(views[i].mask);
    const PixelBox box = grown(silhouette.box, kAroundPx, silhouette.width, silhouette.height);
    seen.push_back({i, views[i].center(), box, Outline(views[i], silhouette, box)});
  }
  return seen;
}

}  // namespace livecap::acquire
