#include "surface/sell.h"

#include <gtest/gtest.h>

#include <set>

#include "surface/scene.h"

namespace livecap {
namespace {

std::vector<Mesh> meshes() {
  Mesh loose = test::icosphere(1, 100, {0, 0, 0});
  loose.positions.insert(loose.positions.end(), {1, 2, 3, 4, 5, 6});  // two vertices in no triangle
  Mesh no_triangles;
  no_triangles.positions.assign(3 * 17, 0.0f);
  return {test::icosphere(0, 100, {0, 0, 0}), loose, test::grid(32, 32, 10, 1000),
          test::tube(50, 100, 200, 1000, {0, 0, 0}), no_triangles};
}

TEST(Sell, EntriesAreExactlyTheOneRings) {
  for (const Mesh& mesh : meshes()) {
    const SellGraph g = make_sell_graph(mesh);
    std::set<std::pair<int, int>> expected, found;
    for (size_t t = 0; t < mesh.triangles.size(); t += 3)
      for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b)
          if (a != b) expected.insert({mesh.triangles[t + a], mesh.triangles[t + b]});
    ASSERT_EQ(g.n_rows % kSlice, 0);
    ASSERT_EQ(int(g.slice_offsets.size()), g.n_rows / kSlice + 1);
    int n_real = 0;
    for (int s = 0; s < g.n_rows / kSlice; ++s)
      for (int at = g.slice_offsets[s]; at < g.slice_offsets[s + 1]; ++at) {
        const int row = s * kSlice + (at - g.slice_offsets[s]) % kSlice;
        ASSERT_GE(g.neighbors[at], 0);
        if (g.neighbors[at] == row) continue;
        ASSERT_LT(g.neighbors[at], g.n);
        ASSERT_LT(row, g.n);
        found.insert({g.order[row], g.order[g.neighbors[at]]});
        ++n_real;
      }
    EXPECT_EQ(found, expected);
    EXPECT_EQ(n_real, int(expected.size()));
    EXPECT_EQ(g.n_entries, g.slice_offsets.back());
    const std::vector<float> marks = g.per_entry([](int, int) { return 1.0; });
    for (int at = 0; at < g.n_entries; ++at) EXPECT_TRUE(marks[at] == 0.0f || marks[at] == 1.0f);
    EXPECT_EQ(std::count(marks.begin(), marks.end(), 1.0f), n_real);
  }
}

TEST(Sell, OrderIsAPermutationAndPlanesAvoidThePage) {
  for (const Mesh& mesh : meshes()) {
    const SellGraph g = make_sell_graph(mesh);
    std::vector<int32_t> sorted = g.order;
    std::sort(sorted.begin(), sorted.end());
    for (int i = 0; i < g.n; ++i) {
      EXPECT_EQ(sorted[i], i);
      EXPECT_EQ(g.order[g.row[i]], i);
    }
    EXPECT_NE(g.stride % 1024, 0);
    EXPECT_GE(g.stride, g.n_rows);
    std::vector<float> values(2 * g.n);
    for (int i = 0; i < 2 * g.n; ++i) values[i] = float(i + 1);
    const std::vector<float> planes = g.planes(values, 2);
    ASSERT_EQ(planes.size(), size_t(2) * g.stride);
    for (int i = 0; i < g.n; ++i) EXPECT_EQ(planes[g.stride + g.row[i]], values[2 * i + 1]);
    for (int r = g.n; r < g.stride; ++r) EXPECT_EQ(planes[r], 0.0f);
  }
}

TEST(Sell, PaddingStaysSmallOnABodyLikeMesh) {
  const SellGraph g = make_sell_graph(test::tube(50, 100, 200, 1000, {0, 0, 0}));
  int n_directed = 0;
  for (const int d : g.degree) n_directed += d;
  EXPECT_LT(g.n_entries, 1.1 * n_directed);
}

}  // namespace
}  // namespace livecap
