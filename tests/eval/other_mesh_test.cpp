// What comparing a mesh with another one's truth does not hang on.
#include "eval/other_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "actor/actor.h"
#include "support/tolerances.h"
#include "synth/synth.h"

namespace livecap {
namespace {

// The head in ten times as many vertices, all of them beside the truth by the same way.
TEST(OtherMesh, DenselyMeshedPlacesDoNotMoveTheSurface) {
  const Actor actor = load_actor_bytes(make_builtin_actor_glb("trousers"), "trousers");
  std::vector<float> paired, vertices;
  for (int i = 0; i < actor.n_vertices(); ++i) {
    const float* p = &actor.mesh.positions[3 * i];
    for (int copy = 0; copy < (p[1] > 1450 ? 10 : 1); ++copy) {
      paired.insert(paired.end(), p, p + 3);
      vertices.insert(vertices.end(), {p[0] + 70, p[1] - 40, p[2] + 20});
    }
  }
  const auto distances = surface_distances(vertices, paired, actor.mesh.positions, actor.mesh.triangles);
  ASSERT_EQ(distances.size(), (vertices.size() / 3 + 4) / 5);
  EXPECT_LT(*std::max_element(distances.begin(), distances.end()), test::kSameSurfaceMm);
}

}  // namespace
}  // namespace livecap
