// The next multiple: sizes that work-groups and vector registers divide.
#pragma once

#include <cstddef>

namespace livecap {

// step > 0.
constexpr size_t round_up(size_t value, size_t step) {
  return (value + step - 1) / step * step;
}

}  // namespace livecap
