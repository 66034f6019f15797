// The value in the middle of a list.
#pragma once

#include <algorithm>
#include <vector>

namespace livecap {

// Of a copy. An even number of values has two in the middle, of which this is the larger; 0 for an empty list.
template <typename T>
T median(std::vector<T> values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + values.size() / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace livecap
