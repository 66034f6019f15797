// The visual hull of the silhouettes, carved on the device (paper, "Actor Model Acquisition": the template's shape).
#pragma once

#include <vector>

#include "ocl/context.h"
#include "scan/volume.h"
#include "views/view.h"

namespace livecap::acquire {

struct HullOptions {
  static constexpr int kMostIgnored = 5;

  int n_ignored = 0;       // views without an exact mask that may be overruled at a point, 0 to kMostIgnored
  double limit_mm = 60;    // distances are cut there
  double min_seen = 0.35;  // share of the views whose picture must hold a point
  double low_mm = -1e9;    // below it, along y,
  int n_ignored_low = 0;   // so many views may be overruled

  void validate() const;  // throws ConfigError
};

// views: camera_from_world in the rest frame, mm, with masks. Fills `volume`'s distances at its nodes.
void carve_hull(ocl::DeviceContext& device, const std::vector<View>& views, const HullOptions& options, Volume& volume);

std::vector<ocl::SelfTestResult> acquire_self_test(ocl::DeviceContext& device);

}  // namespace livecap::acquire
