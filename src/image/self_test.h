// Known answers of the kernels of this room.
#pragma once

#include <vector>

#include "ocl/context.h"

namespace livecap {

std::vector<ocl::SelfTestResult> image_self_test(ocl::DeviceContext& device);

}  // namespace livecap
