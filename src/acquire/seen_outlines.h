// Where the outlines of a person are, in the views that have a mask.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "image/silhouette.h"
#include "views/view.h"

namespace livecap::acquire {

// By how much points are outside of a mask, mm across the line of sight. Keeps the distances of a box only.
class Outline {
 public:
  // view: outlives it.
  Outline(const View& view, const Silhouette& silhouette, const PixelBox& box);

  // NaN outside of the box, or when the mask is empty.
  double outside_mm(const Eigen::Vector3d& p) const;

 private:
  const View& view_;
  PixelBox box_;
  Silhouette distance_;  // of the box
};

struct SeenOutline {
  size_t view;
  Eigen::Vector3d center;  // of the camera
  PixelBox box;
  Outline outline;

  // By how much a point of a surface is outside, mm, when it lies on this outline: near it, seen edge-on, and with
  // nothing of the person just beyond. NaN when it does not.
  double outside_mm(const Eigen::Vector3d& p, const Eigen::Vector3d& normal) const;
};

inline constexpr double kOutlineReachMm = 6;  // farther from an outline is another part's, or hidden

// Of the views that have a mask; `views` outlives them.
std::vector<SeenOutline> seen_outlines(const std::vector<View>& views);

}  // namespace livecap::acquire
