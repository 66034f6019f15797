#include "surface/sell.h"

#include <algorithm>
#include <numeric>

namespace livecap {
namespace {

constexpr int kSortWindow = 128;  // rows; small enough to keep the locality of the order

// Breadth first from a vertex of least degree, component by component, then reversed.
std::vector<int32_t> reverse_cuthill_mckee(const OneRing& ring, int n) {
  const auto degree = [&](int i) { return ring.offsets[i + 1] - ring.offsets[i]; };
  std::vector<int32_t> seeds(n);
  std::iota(seeds.begin(), seeds.end(), 0);
  std::stable_sort(seeds.begin(), seeds.end(), [&](int a, int b) { return degree(a) < degree(b); });
  std::vector<char> seen(n, 0);
  std::vector<int32_t> order;
  order.reserve(n);
  std::vector<int32_t> next;
  for (const int seed : seeds) {
    if (seen[seed]) continue;
    seen[seed] = 1;
    size_t head = order.size();
    order.push_back(seed);
    while (head < order.size()) {
      const int i = order[head++];
      next.clear();
      for (int k = ring.offsets[i]; k < ring.offsets[i + 1]; ++k) {
        const int j = ring.neighbors[k];
        if (!seen[j]) {
          seen[j] = 1;
          next.push_back(j);
        }
      }
      std::stable_sort(next.begin(), next.end(), [&](int a, int b) { return degree(a) < degree(b); });
      order.insert(order.end(), next.begin(), next.end());
    }
  }
  std::reverse(order.begin(), order.end());
  return order;
}

}  // namespace

std::vector<float> SellGraph::planes(const std::vector<float>& values, int width) const {
  std::vector<float> out(size_t(width) * stride, 0.0f);
  for (int r = 0; r < n; ++r)
    for (int a = 0; a < width; ++a) out[size_t(a) * stride + r] = values[size_t(width) * order[r] + a];
  return out;
}

SellGraph make_sell_graph(const Mesh& mesh) {
  return make_sell_graph(one_ring(mesh.n_vertices(), mesh.triangles));
}

SellGraph make_sell_graph(const OneRing& ring) {
  SellGraph g;
  g.n = static_cast<int>(ring.offsets.size()) - 1;
  g.n_rows = (g.n + kSlice - 1) / kSlice * kSlice;
  g.stride = g.n_rows;
  if (g.stride % 1024 == 0) g.stride += kSlice;
  g.degree.resize(g.n);
  for (int i = 0; i < g.n; ++i) g.degree[i] = ring.offsets[i + 1] - ring.offsets[i];

  g.order = reverse_cuthill_mckee(ring, g.n);
  for (int begin = 0; begin < g.n; begin += kSortWindow) {
    const int end = std::min(begin + kSortWindow, g.n);
    std::stable_sort(g.order.begin() + begin, g.order.begin() + end,
                     [&](int a, int b) { return g.degree[a] > g.degree[b]; });
  }
  g.row.resize(g.n);
  for (int r = 0; r < g.n; ++r) g.row[g.order[r]] = r;

  const int n_slices = g.n_rows / kSlice;
  g.slice_offsets.assign(n_slices + 1, 0);
  for (int s = 0; s < n_slices; ++s) {
    int width = 0;
    for (int r = s * kSlice; r < std::min((s + 1) * kSlice, g.n); ++r) width = std::max(width, g.degree[g.order[r]]);
    g.slice_offsets[s + 1] = g.slice_offsets[s] + width * kSlice;
  }
  g.n_entries = g.slice_offsets[n_slices];
  g.neighbors.resize(g.n_entries);
  for (int s = 0; s < n_slices; ++s) {
    for (int at = g.slice_offsets[s]; at < g.slice_offsets[s + 1]; ++at) {
      const int k = (at - g.slice_offsets[s]) / kSlice;
      const int r = s * kSlice + (at - g.slice_offsets[s]) % kSlice;
      const bool real = r < g.n && k < g.degree[g.order[r]];
      g.neighbors[at] = real ? g.row[ring.neighbors[ring.offsets[g.order[r]] + k]] : r;
    }
  }
  return g;
}

}  // namespace livecap
