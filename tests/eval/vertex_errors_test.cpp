// Errors by vertex and by label on two frames of four vertices.
#include "eval/vertex_errors.h"

#include <gtest/gtest.h>

#include "livecap/error.h"

namespace livecap {
namespace {

// Labels: skirt 12, upper clothes 5, skirt, left arm 14.
const std::vector<uint8_t> kLabels = {12, 5, 12, 14};

VertexErrors two_frames() {
  VertexErrors errors;
  errors.add(std::vector<double>{10, 20, 30, 40}, std::vector<double>{1, 2, 3, 4});
  errors.add(std::vector<double>{50, 60, 70, 80}, std::vector<double>{5, 6, 7, 8});
  return errors;
}

TEST(VertexErrors, OverEverything) {
  const VertexErrors errors = two_frames();
  EXPECT_EQ(errors.n_frames(), 2);
  EXPECT_EQ(errors.direct().n, 8);
  EXPECT_DOUBLE_EQ(errors.direct().mean, 45);
  EXPECT_DOUBLE_EQ(errors.aligned().mean, 4.5);
  EXPECT_DOUBLE_EQ(errors.aligned().p95, 7.65);  // rank 0.95 * 7 = 6.65, between 7 and 8
  EXPECT_EQ(errors.mean_aligned(), (std::vector<float>{3, 4, 5, 6}));
}

TEST(VertexErrors, ByLabel) {
  const std::vector<LabelError> rows = errors_by_label(two_frames(), kLabels);
  ASSERT_EQ(rows.size(), 3u);  // in the order of the ids
  EXPECT_EQ(rows[0].label, "upper-clothes");
  EXPECT_EQ(rows[1].label, "skirt");
  EXPECT_EQ(rows[2].label, "left-arm");
  EXPECT_EQ(rows[1].n_vertices, 2);
  EXPECT_EQ(rows[1].direct.n, 4);
  EXPECT_DOUBLE_EQ(rows[1].direct.mean, 40);  // 10, 30, 50, 70
  EXPECT_DOUBLE_EQ(rows[1].aligned.max, 7);
  EXPECT_DOUBLE_EQ(rows[0].aligned.mean, 4);
  EXPECT_DOUBLE_EQ(rows[2].direct.mean, 60);
}

TEST(VertexErrors, LooseGarmentsAreDressCoatAndSkirt) {
  int n = 0;
  for (int label = -1; label < 25; ++label) n += is_loose_garment(label);
  EXPECT_EQ(n, 3);
  EXPECT_TRUE(is_loose_garment(6));
  EXPECT_TRUE(is_loose_garment(7));
  EXPECT_TRUE(is_loose_garment(12));
}

TEST(VertexErrors, RefusesAnotherMesh) {
  VertexErrors errors = two_frames();
  EXPECT_THROW(errors.add(std::vector<double>{1}, std::vector<double>{1}), LogicError);
  EXPECT_THROW(errors.add(std::vector<double>{1, 2, 3, 4}, std::vector<double>{1}), LogicError);
  EXPECT_THROW(errors_by_label(errors, std::vector<uint8_t>{12}), LogicError);
}

}  // namespace
}  // namespace livecap
