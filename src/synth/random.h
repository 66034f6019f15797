// Repeatable random numbers and value noise that are the same with every standard library.
#pragma once

#include <cmath>
#include <cstdint>

namespace livecap::synth {

// A well mixed 64-bit hash (SplitMix64, Steele et al. 2014).
inline uint64_t hash64(uint64_t x) {
  x += 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return x ^ (x >> 31);
}

// In [0,1), one value per integer lattice point.
inline double lattice_noise(int x, int y, uint64_t seed) {
  const uint64_t key = (static_cast<uint64_t>(static_cast<uint32_t>(x)) << 32) | static_cast<uint32_t>(y);
  return static_cast<double>(hash64(key ^ hash64(seed)) >> 11) * 0x1p-53;
}

// Smooth noise in [0,1) with features of size 1.
inline double value_noise(double x, double y, uint64_t seed) {
  const int ix = static_cast<int>(std::floor(x)), iy = static_cast<int>(std::floor(y));
  double fx = x - ix, fy = y - iy;
  fx = fx * fx * (3 - 2 * fx);
  fy = fy * fy * (3 - 2 * fy);
  const double top = lattice_noise(ix, iy, seed) * (1 - fx) + lattice_noise(ix + 1, iy, seed) * fx;
  const double bottom = lattice_noise(ix, iy + 1, seed) * (1 - fx) + lattice_noise(ix + 1, iy + 1, seed) * fx;
  return top * (1 - fy) + bottom * fy;
}

// Three octaves of value_noise, in [0,1).
inline double cloud_noise(double x, double y, uint64_t seed) {
  return (4 * value_noise(x, y, seed) + 2 * value_noise(2 * x, 2 * y, seed + 1) + value_noise(4 * x, 4 * y, seed + 2)) /
         7;
}

}  // namespace livecap::synth
