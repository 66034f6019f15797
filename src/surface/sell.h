// The one-ring graph of a mesh in slices of 16 rows (SELL-16, sliced ELLPACK): within a slice the k-th neighbours of
// its 16 vertices lie side by side, so that a vector register or a half-warp reads them at once. Rows are renumbered
// for locality (reverse Cuthill-McKee), then sorted by degree in windows to keep the padding small.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/mesh.h"

namespace livecap {

inline constexpr int kSlice = 16;

struct SellGraph {
  int n = 0;       // vertices
  int n_rows = 0;  // n rounded up to a multiple of kSlice; rows beyond n have no neighbours
  int stride = 0;  // floats between planes: n_rows, moved off multiples of 4096 bytes (they collide in the caches)
  int n_entries = 0;
  std::vector<int32_t> order;          // [n] vertex of each row
  std::vector<int32_t> row;            // [n] row of each vertex
  std::vector<int32_t> slice_offsets;  // [n_rows/kSlice + 1] first entry of each slice
  std::vector<int32_t> neighbors;      // [n_entries] rows; padding names its own row
  std::vector<int32_t> degree;         // [n] neighbours of each vertex (mesh order)

  // One value per entry from f(vertex i, vertex j); 0 for padding.
  template <typename F>
  std::vector<float> per_entry(F&& f) const {
    std::vector<float> values(n_entries, 0.0f);
    for (int r = 0; r < n; ++r) {
      const int begin = slice_offsets[r / kSlice];
      for (int k = 0; k < degree[order[r]]; ++k) {
        const int at = begin + k * kSlice + r % kSlice;
        values[at] = static_cast<float>(f(order[r], order[neighbors[at]]));
      }
    }
    return values;
  }

  // Per-vertex values of `width` planes as rows: out[a*stride + row] = values[width*vertex + a], zero beyond.
  std::vector<float> planes(const std::vector<float>& values, int width) const;
};

SellGraph make_sell_graph(const Mesh& mesh);
// Of any links between vertices, those of each both ways.
SellGraph make_sell_graph(const OneRing& links);

}  // namespace livecap
