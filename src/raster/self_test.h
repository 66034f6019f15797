// Known-answer tests of this room's kernels on one device, for `livecap devices`.
#pragma once

#include <vector>

#include "ocl/context.h"

namespace livecap {

std::vector<ocl::SelfTestResult> raster_self_test(ocl::DeviceContext& device);

}  // namespace livecap
