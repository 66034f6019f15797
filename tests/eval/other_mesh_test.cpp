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

// A mesh with ten times as many vertices in its head is wrong there by 30 mm: at the truth's vertices that counts as
// often as the truth has vertices in the head.
TEST(OtherMesh, TheTruthsVerticesDecideWhatCounts) {
  const Actor truth = load_actor_bytes(make_builtin_actor_glb("trousers", kBuiltinHeightMm, 2000), "trousers");
  const Actor other = load_actor_bytes(make_builtin_actor_glb("trousers", kBuiltinHeightMm, 1400), "trousers");
  const RestOverlay overlay = overlay_rest(other, truth);
  const auto on = true_vertices_on(other, truth, overlay);
  ASSERT_EQ(on.size(), static_cast<size_t>(truth.n_vertices()));
  std::vector<float> captured = other.mesh.positions;
  for (size_t i = 0; i < captured.size(); i += 3)
    if (captured[i + 1] > 1450) captured[i + 2] += 30;
  const std::vector<float> at = resample(on, other.mesh.triangles, captured);
  double sum = 0;
  int n_head = 0;
  for (int i = 0; i < truth.n_vertices(); ++i) {
    const bool head = truth.mesh.positions[3 * i + 1] > 1450;
    sum += at[3 * i + 2] - truth.mesh.positions[3 * i + 2];
    n_head += head;
  }
  EXPECT_NEAR(sum / truth.n_vertices(), 30.0 * n_head / truth.n_vertices(), 1);
  EXPECT_LT(n_head, truth.n_vertices() / 4);
}

}  // namespace
}  // namespace livecap
