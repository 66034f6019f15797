// How far two arrays of floats differ.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace livecap::test {

// |a - b| / |b| over all elements; NaN when anything is, or when the sizes differ.
inline double relative_error(const std::vector<float>& a, const std::vector<float>& b) {
  if (a.size() != b.size()) return NAN;
  double difference = 0, norm = 1e-12;
  for (size_t i = 0; i < b.size(); ++i) {
    difference += (double(a[i]) - b[i]) * (double(a[i]) - b[i]);
    norm += double(b[i]) * b[i];
  }
  return std::sqrt(difference / norm);
}

}  // namespace livecap::test
