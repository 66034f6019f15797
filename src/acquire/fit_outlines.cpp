#include "acquire/fit_outlines.h"

#include <cmath>
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

// By how much points are outside of a mask, mm across the line of sight.
class Outline {
 public:
  Outline(const View& view, const ImageGray& mask) : view_(view), silhouette_(make_silhouette(mask)) {}

  // NaN outside of the picture, or when the mask is empty.
  double outside_mm(const Vector3d& p) const {
    constexpr double kUnknown = std::numeric_limits<double>::quiet_NaN();
    Eigen::Vector2d q;
    if (silhouette_.empty() || !view_.project(p, q)) return kUnknown;
    if (!(q.x() >= 0 && q.y() >= 0 && q.x() < silhouette_.width - 1 && q.y() < silhouette_.height - 1)) return kUnknown;
    const int x = static_cast<int>(q.x()), y = static_cast<int>(q.y());
    const double fx = q.x() - x, fy = q.y() - y;
    const float* row = &silhouette_.signed_distance[static_cast<size_t>(y) * silhouette_.width + x];
    const float* below = row + silhouette_.width;
    const double px = (1 - fy) * ((1 - fx) * row[0] + fx * row[1]) + fy * ((1 - fx) * below[0] + fx * below[1]);
    return px * (view_.camera_from_world * p).z() / view_.camera.fx;
  }

 private:
  const View& view_;
  Silhouette silhouette_;
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
  for (size_t i = 0; i < views.size(); ++i)
    if (!views[i].mask.empty())
      pairs.push_back({views[i].center(), Outline(views[i], views[i].mask), Outline(views[i], drawn[i])});
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
