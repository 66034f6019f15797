#include "acquire/material_labels.h"

#include <gtest/gtest.h>

#include "support/tolerances.h"

namespace livecap::acquire {
namespace {

// Three vertices of a tetrahedron's four are looked at, one label is none of LIP's.
TEST(MaterialLabels, VotesCountWhatTheyCannotUse) {
  meshing::Surface surface;
  surface.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  surface.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  View view;
  view.labels = {96, 64, std::vector<uint8_t>(96 * 64, 5)};
  view.labels.pixels[0] = 200;
  const std::vector<ViewCoverage> coverage = {
      {{1, 1, 1, 0}, {Eigen::Vector2f(0, 0), Eigen::Vector2f(5, 5), Eigen::Vector2f(6, 5), Eigen::Vector2f(0, 0)}}};
  const MaterialLabels labels = vote_labels(surface, {view}, coverage);
  EXPECT_EQ(labels.n_unseen, 2);
  EXPECT_NEAR(labels.foreign, 1.0 / 3, test::kDoubleExact);
  for (uint8_t label : labels.labels) EXPECT_EQ(label, 5);
}

}  // namespace
}  // namespace livecap::acquire
