// The fields of view that a camera can be given.
#pragma once

#include "base/value_range.h"

namespace livecap {

inline constexpr ValueRange kFovDeg{1, 170};  // of the longer side

}  // namespace livecap
