#include "acquire/body_shape.h"

#include <gtest/gtest.h>

#include "base/text.h"

namespace livecap::acquire {
namespace {

using Eigen::Vector3d;

TEST(BodyShape, AScanOfFewerVerticesThanAskedForIsTold) {
  const meshing::Surface ball = meshing::extract_surface([](const Vector3d& p) { return p.norm() - 300; },
                                                         Vector3d::Constant(-350), Vector3d::Constant(350), 50);
  const int n = static_cast<int>(ball.vertices.size());
  for (const int asked : {n - 20, n, n + 1}) {
    std::vector<std::string> notes;
    std::vector<double> offsets;
    BodyShape shape = shape_of_scan(ball, notes);
    ASSERT_TRUE(shape.as_is);
    EXPECT_EQ(static_cast<int>(thin_shape(shape, asked, offsets, notes).vertices.size()), std::min(asked, n));
    std::vector<std::string> expected;
    if (asked > n)
      expected.push_back(format("the shape has %d vertices, fewer than --vertices %d: none are added", n, asked));
    EXPECT_EQ(notes, expected);
  }
}

}  // namespace
}  // namespace livecap::acquire
