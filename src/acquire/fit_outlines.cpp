#include "acquire/fit_outlines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "acquire/facet_offsets.h"
#include "image/silhouette.h"
#include "texture/surface_views.h"

namespace livecap::acquire {

namespace {

using Eigen::Vector3d;

constexpr int kRounds = 2;
constexpr double kEdgeOn = 0.2;    // cosine between normal and line of sight
constexpr double kMostMm = 6;      // farther from an outline is another part's, or hidden
constexpr double kBeyondMm = 12;   // so far out along the normal a point must be outside of the mask,
constexpr double kLeastOutMm = 5;  // by so much, or what ends there is another part of the body

// Around the box, px: at 0.5 mm a pixel all that is asked about.
constexpr int kAround = 40;

// By how much points are outside of a mask, mm across the line of sight. Keeps the distances of a box only.
class Outline {
 public:
  Outline(const View& view, const Silhouette& silhouette, const PixelBox& box) : view_(view) {
    if (silhouette.empty() || box.empty()) return;
    x0_ = std::max(0, box.x0 - kAround);
    y0_ = std::max(0, box.y0 - kAround);
    width_ = std::min(silhouette.width, box.x1 + kAround) - x0_;
    height_ = std::min(silhouette.height, box.y1 + kAround) - y0_;
    for (int y = y0_; y < y0_ + height_; ++y) {
      const auto row = silhouette.signed_distance.begin() + static_cast<ptrdiff_t>(y) * silhouette.width + x0_;
      signed_distance_.insert(signed_distance_.end(), row, row + width_);
    }
  }

  // NaN outside of the box, or when the mask is empty.
  double outside_mm(const Vector3d& p) const {
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    Eigen::Vector2d q;
    if (!view_.project(p, q)) return kUnknown;
    q -= Eigen::Vector2d(x0_, y0_);
    if (!(q.x() >= 0 && q.y() >= 0 && q.x() < width_ - 1 && q.y() < height_ - 1)) return kUnknown;
    const int x = static_cast<int>(q.x()), y = static_cast<int>(q.y());
    const double fx = q.x() - x, fy = q.y() - y;
    const float* row = &signed_distance_[static_cast<size_t>(y) * width_ + x];
    const float* below = row + width_;
    const double px = (1 - fy) * ((1 - fx) * row[0] + fx * row[1]) + fy * ((1 - fx) * below[0] + fx * below[1]);
    return px * (view_.camera_from_world * p).z() / view_.camera.fx;
  }

 private:
  const View& view_;
  int x0_ = 0, y0_ = 0, width_ = 0, height_ = 0;
  std::vector<float> signed_distance_;  // [width_*height_] px, see image/silhouette.h
};

struct OutlinePair {
  Vector3d center;
  Outline seen, drawn;

  // By how much the drawn outline is beyond the seen one beside a point of the surface. What makes a point lie inside
  // of an outline (triangles, a limb's roundness) is the same in both. False: the point is beside neither, or is not
  // seen edge-on.
  bool beyond_mm(const Vector3d& p, const Vector3d& normal, double& mm) const {
    if (std::abs(normal.dot((center - p).normalized())) > kEdgeOn) return false;
    const double seen_mm = seen.outside_mm(p), drawn_mm = drawn.outside_mm(p);
    if (!(std::abs(seen_mm) < kMostMm) || !(std::abs(drawn_mm) < kMostMm)) return false;
    if (!(seen.outside_mm(p + kBeyondMm * normal) > kLeastOutMm)) return false;
    mm = seen_mm - drawn_mm;
    return true;
  }
};

// Of the views that have a mask.
std::vector<OutlinePair> draw_outlines(ocl::DeviceContext& device, const std::vector<View>& views,
                                       const meshing::Surface& surface) {
  std::vector<OutlinePair> pairs;
  const std::vector<ImageGray> drawn = draw_masks(device, mesh_of(surface), views);
  for (size_t i = 0; i < views.size(); ++i) {
    if (views[i].mask.empty()) continue;
    const Silhouette seen = make_silhouette(views[i].mask);
    pairs.push_back(
        {views[i].center(), Outline(views[i], seen, seen.box), Outline(views[i], make_silhouette(drawn[i]), seen.box)});
  }
  return pairs;
}

}  // namespace

void fit_outlines(ocl::DeviceContext& device, const std::vector<View>& views, meshing::Surface& surface) {
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<OutlinePair> outlines = draw_outlines(device, views, surface);
    const auto beyond = [&](const Vector3d& p, const Vector3d& normal, double& mm) {
      double sum = 0, one = 0;
      int n = 0;
      for (const OutlinePair& outline : outlines)
        if (outline.beyond_mm(p, normal, one)) sum += one, ++n;
      mm = sum / n;
      return n > 0;
    };
    move_along_normals(mean_offsets(surface, 1, kMostMm, beyond), surface);
  }
}

}  // namespace livecap::acquire
