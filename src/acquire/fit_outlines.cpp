#include "acquire/fit_outlines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "acquire/facet_offsets.h"
#include "texture/surface_views.h"

namespace livecap::acquire {

namespace {

using Eigen::Vector3d;

constexpr int kRounds = 2;

// By how much the drawn outline is beyond the seen one beside a point of the surface, mm. What makes a point lie inside
// of an outline (triangles, a limb's roundness) is the same in both. NaN: the point is not on both.
double beyond_mm(const SeenOutline& seen, const Outline& drawn, const Vector3d& p, const Vector3d& normal) {
  const double seen_mm = seen.outside_mm(p, normal), drawn_mm = drawn.outside_mm(p);
  return std::abs(drawn_mm) < kOutlineReachMm ? seen_mm - drawn_mm : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

void fit_outlines(ocl::DeviceContext& device, const std::vector<View>& views, const std::vector<SeenOutline>& seen,
                  double lowest_mm, meshing::Surface& surface) {
  for (int round = 0; round < kRounds; ++round) {
    const std::vector<ImageGray> masks = draw_masks(device, mesh_of(surface), views);
    std::vector<Outline> drawn;
    for (const SeenOutline& one : seen) drawn.emplace_back(views[one.view], make_silhouette(masks[one.view]), one.box);
    const auto mean_beyond_mm = [&](const Vector3d& p, const Vector3d& normal) {
      double sum = 0;
      int n = 0;
      for (size_t i = 0; i < seen.size(); ++i)
        if (const double mm = beyond_mm(seen[i], drawn[i], p, normal); !std::isnan(mm)) sum += mm, ++n;
      return n > 0 ? sum / n : std::numeric_limits<double>::quiet_NaN();
    };
    std::vector<double> offsets = mean_offsets(surface, 1, kOutlineReachMm, mean_beyond_mm);
    for (size_t i = 0; i < offsets.size(); ++i) offsets[i] *= ramp_above(lowest_mm, surface.vertices[i]);
    move_along_normals(offsets, surface);
  }
}

}  // namespace livecap::acquire
