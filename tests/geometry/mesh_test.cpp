#include "geometry/mesh.h"

#include <gtest/gtest.h>

namespace livecap {
namespace {

// Two triangles over the edge 1-2, and vertex 4 in none.
const std::vector<int32_t> kTriangles = {0, 1, 2, 2, 1, 3};

TEST(Mesh, FansNameTheTrianglesOfEachVertex) {
  const TriangleFans fans = triangle_fans(5, kTriangles);
  EXPECT_EQ(fans.offsets, (std::vector<int32_t>{0, 1, 3, 5, 6, 6}));
  EXPECT_EQ(fans.triangles, (std::vector<int32_t>{0, 0, 1, 0, 1, 1}));
  EXPECT_EQ(triangle_fans(0, {}).offsets, std::vector<int32_t>{0});
}

TEST(Mesh, RingsNameEachNeighbourOnce) {
  const OneRing ring = one_ring(5, kTriangles);
  EXPECT_EQ(ring.offsets, (std::vector<int32_t>{0, 2, 5, 8, 10, 10}));
  EXPECT_EQ(ring.neighbors, (std::vector<int32_t>{1, 2, 0, 2, 3, 0, 1, 3, 1, 2}));
}

}  // namespace
}  // namespace livecap
