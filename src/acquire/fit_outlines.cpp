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
constexpr double kRampMm = 20;     // above lowest_mm: from staying to moving wholly

constexpr int kAroundPx = 40;  // of a person's box: at 0.5 mm a pixel all that is asked about
constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();

// By how much points are outside of a mask, mm across the line of sight. Keeps the distances of a box only.
class Outline {
 public:
  Outline(const View& view, const Silhouette& silhouette, const PixelBox& box) : view_(view), box_(box) {
    if (silhouette.empty() || box.empty()) return;
    distance_.width = box.width();
    distance_.height = box.height();
    for (int y = box.y0; y < box.y1; ++y) {
      const auto row = silhouette.signed_distance.begin() + static_cast<ptrdiff_t>(y) * silhouette.width;
      distance_.signed_distance.insert(distance_.signed_distance.end(), row + box.x0, row + box.x1);
    }
  }

  // NaN outside of the box, or when the mask is empty.
  double outside_mm(const Vector3d& p) const {
    Eigen::Vector2d q;
    if (!view_.project(p, q)) return kUnknown;
    q -= Eigen::Vector2d(box_.x0, box_.y0);
    if (!(q.x() >= 0 && q.y() >= 0 && q.x() < distance_.width - 1 && q.y() < distance_.height - 1)) return kUnknown;
    return distance_at(distance_, q.x(), q.y()) * (view_.camera_from_world * p).z() / view_.camera.fx;
  }

 private:
  const View& view_;
  PixelBox box_;
  Silhouette distance_;  // of the box
};

struct SeenOutline {
  size_t view;
  Vector3d center;  // of the camera
  PixelBox box;
  Outline outline;
};

// Of the views that have a mask.
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

// By how much the drawn outline is beyond the seen one beside a point of the surface, mm. What makes a point lie inside
// of an outline (triangles, a limb's roundness) is the same in both. NaN: the point is beside neither, or is not seen
// edge-on.
double beyond_mm(const SeenOutline& seen, const Outline& drawn, const Vector3d& p, const Vector3d& normal) {
  if (std::abs(normal.dot((seen.center - p).normalized())) > kEdgeOn) return kUnknown;
  const double seen_mm = seen.outline.outside_mm(p), drawn_mm = drawn.outside_mm(p);
  if (!(std::abs(seen_mm) < kMostMm) || !(std::abs(drawn_mm) < kMostMm)) return kUnknown;
  if (!(seen.outline.outside_mm(p + kBeyondMm * normal) > kLeastOutMm)) return kUnknown;
  return seen_mm - drawn_mm;
}

}  // namespace

void fit_outlines(ocl::DeviceContext& device, const std::vector<View>& views, double lowest_mm,
                  meshing::Surface& surface) {
  const std::vector<SeenOutline> seen = seen_outlines(views);
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<ImageGray> masks = draw_masks(device, mesh_of(surface), views);
    std::vector<Outline> drawn;
    for (const SeenOutline& one : seen) drawn.emplace_back(views[one.view], make_silhouette(masks[one.view]), one.box);
    const auto mean_beyond_mm = [&](const Vector3d& p, const Vector3d& normal) {
      double sum = 0;
      int n = 0;
      for (size_t i = 0; i < seen.size(); ++i)
        if (const double mm = beyond_mm(seen[i], drawn[i], p, normal); !std::isnan(mm)) sum += mm, ++n;
      return n > 0 ? sum / n : kUnknown;
    };
    std::vector<double> offsets = mean_offsets(surface, 1, kMostMm, mean_beyond_mm);
    for (size_t i = 0; i < offsets.size(); ++i)
      offsets[i] *= std::clamp((surface.vertices[i].y() - lowest_mm) / kRampMm, 0.0, 1.0);
    move_along_normals(offsets, surface);
  }
}

}  // namespace livecap::acquire
