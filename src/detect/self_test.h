// Known-answer tests of this room's kernels on one device, for `livecap devices`. Only GPUs use them; they are right on
// any device.
#pragma once

#include <vector>

#include "ocl/context.h"

namespace livecap::detect {

std::vector<ocl::SelfTestResult> detect_self_test(ocl::DeviceContext& device);

}  // namespace livecap::detect
