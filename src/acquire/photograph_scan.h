#pragma once

#include <vector>

#include "scan/scan.h"
#include "views/view.h"

namespace livecap::acquire {

// Pictures of the scan from all around, for the network, in the scan's own world. The longer of Y and Z is up.
std::vector<View> photograph_scan(const Scan& scan, int n_views);

}  // namespace livecap::acquire
