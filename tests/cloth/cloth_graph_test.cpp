#include "cloth/cloth_graph.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "cloth/hanging_cloth.h"
#include "cloth/scene.h"
#include "support/builtin_actor.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

constexpr float kHeld = 0.15f;

int particle_of(const ClothGraph& graph, int vertex) {
  const auto found = std::find(graph.vertices.begin(), graph.vertices.end(), vertex);
  return found == graph.vertices.end() ? -1 : int(found - graph.vertices.begin());
}

std::set<std::pair<int, bool>> links_of(const ClothGraph& graph, int vertex) {
  const int p = particle_of(graph, vertex);
  std::set<std::pair<int, bool>> out;
  for (int at = graph.links.offsets[p]; at < graph.links.offsets[p + 1]; ++at)
    out.insert({graph.vertices[graph.links.neighbors[at]], graph.across[at] != 0});
  return out;
}

TEST(ClothGraph, LinksEdgesAndWhatLiesAcrossThem) {
  const ClothGraph graph = make_cloth_graph(test::skirt_actor(), kHeld);
  ASSERT_EQ(graph.n_particles(), test::kAround * test::kRings);
  EXPECT_TRUE(graph.followers.empty());
  // Vertex (ring 5, place 7) of a grid whose quads are cut from the lower left to the upper right.
  const auto at = [](int ring, int k) { return ring * test::kAround + k; };
  const std::set<std::pair<int, bool>> expected = {
      {at(5, 6), false}, {at(5, 8), false}, {at(4, 7), false}, {at(6, 7), false}, {at(4, 8), false}, {at(6, 6), false},
      {at(4, 6), true},  {at(6, 8), true},  {at(3, 8), true},  {at(7, 6), true},  {at(4, 9), true},  {at(6, 5), true}};
  EXPECT_EQ(links_of(graph, at(5, 7)), expected);
}

TEST(ClothGraph, TheSeamAndWhatHardlyFollowsTheLegsIsHeld) {
  const ClothGraph graph = make_cloth_graph(test::skirt_actor(), kHeld);
  for (int p = 0; p < graph.n_particles(); ++p) {
    const int ring = graph.vertices[p] / test::kAround;
    EXPECT_EQ(graph.held[p] != 0, ring <= 1) << "ring " << ring;  // leg weights 0.1 a ring
  }
}

// A skirt with a lining: the rings again 20 mm further in, turned inside out and sewn to the hem.
TEST(ClothGraph, ALiningFollows) {
  Actor actor = test::skirt_actor();
  const int n = actor.n_vertices();
  for (int i = 0; i < n; ++i) {
    const float* p = actor.mesh.positions.data() + 3 * i;
    const float shrink = 1 - 20 / std::hypot(p[0], p[2]);
    actor.mesh.positions.insert(actor.mesh.positions.end(), {p[0] * shrink, p[1] - 5, p[2] * shrink});
    for (int k = 0; k < 4; ++k) {
      actor.skin.bones.push_back(actor.skin.bones[4 * i + k]);
      actor.skin.weights.push_back(actor.skin.weights[4 * i + k]);
    }
    actor.rigidity.push_back(1);
  }
  const std::vector<int32_t> outside = actor.mesh.triangles;
  for (size_t t = 0; t < outside.size(); t += 3)
    actor.mesh.triangles.insert(actor.mesh.triangles.end(), {outside[t] + n, outside[t + 2] + n, outside[t + 1] + n});
  const ClothGraph graph = make_cloth_graph(actor, kHeld);
  EXPECT_EQ(graph.n_particles(), n);
  ASSERT_EQ(int(graph.followers.size()), n);
  for (size_t f = 0; f < graph.followers.size(); ++f) {
    EXPECT_EQ(graph.vertices[graph.followed[4 * f]], graph.followers[f] - n) << "the nearest is the one outside";
    float sum = 0;
    for (size_t k = 4 * f; k < 4 * f + 4; ++k) sum += graph.followed_weights[k];
    EXPECT_NEAR(sum, 1, 1e-5f);
  }
}

// A lid below the hem, going inwards and a little down: it faces down, and barely outwards.
TEST(ClothGraph, ALidFollows) {
  Actor actor = test::skirt_actor();
  const int n = actor.n_vertices(), hem = n - test::kAround;
  for (int k = 0; k < test::kAround; ++k) {
    const float* p = actor.mesh.positions.data() + 3 * (hem + k);
    const float shrink = 1 - 15 / std::hypot(p[0], p[2]);
    actor.mesh.positions.insert(actor.mesh.positions.end(), {p[0] * shrink, p[1] - 2, p[2] * shrink});
    actor.skin.bones.insert(actor.skin.bones.end(), {1, 0, 0, 0});
    actor.skin.weights.insert(actor.skin.weights.end(), {1, 0, 0, 0});
    actor.rigidity.push_back(1);
    const int a = hem + k, b = hem + (k + 1) % test::kAround, c = n + k, d = n + (k + 1) % test::kAround;
    actor.mesh.triangles.insert(actor.mesh.triangles.end(), {a, c, b, b, c, d});
  }
  const ClothGraph graph = make_cloth_graph(actor, kHeld);
  EXPECT_EQ(graph.n_particles(), n);
  EXPECT_EQ(int(graph.followers.size()), test::kAround);
}

// Three rings of a lid between the hem and a fourth of skin.
TEST(ClothGraph, ALidGoesWithTheClothAtItsRimAndWithTheLegsAtTheOther) {
  Actor actor = test::skirt_actor();
  const int n = actor.n_vertices(), hem = n - test::kAround;
  for (int ring = 1; ring <= 4; ++ring) {
    for (int k = 0; k < test::kAround; ++k) {
      const float* p = actor.mesh.positions.data() + 3 * (hem + k);
      const float shrink = 1 - 30 * float(ring) / std::hypot(p[0], p[2]);
      actor.mesh.positions.insert(actor.mesh.positions.end(), {p[0] * shrink, p[1] - 2 * float(ring), p[2] * shrink});
      actor.skin.bones.insert(actor.skin.bones.end(), {1, 0, 0, 0});
      actor.skin.weights.insert(actor.skin.weights.end(), {1, 0, 0, 0});
      actor.rigidity.push_back(ring < 4 ? 1.0f : 200.0f);
      const int before = ring == 1 ? hem : n + (ring - 2) * test::kAround, now = n + (ring - 1) * test::kAround;
      const int a = before + k, b = before + (k + 1) % test::kAround, c = now + k, d = now + (k + 1) % test::kAround;
      actor.mesh.triangles.insert(actor.mesh.triangles.end(), {a, c, b, b, c, d});
    }
  }
  const ClothGraph graph = make_cloth_graph(actor, kHeld);
  ASSERT_EQ(int(graph.followers.size()), 3 * test::kAround);
  SkinWeights carried = actor.skin;  // cloth by bone 2, lids by bone 3
  for (int i = 0; i < actor.n_vertices(); ++i) carried.bones[4 * i] = i < n ? 2 : 3;
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 4; ++k) carried.weights[4 * i + k] = k == 0 ? 1.0f : 0.0f;
  const SkinWeights weights = with_followers(actor, graph, carried, 0.25f);
  for (size_t f = 0; f < graph.followers.size(); ++f) {
    const int follower = graph.followers[f], ring = (follower - n) / test::kAround + 1;
    const double share = 1 - ring / 4.0;  // a grid: what is harmonic is linear
    EXPECT_NEAR(graph.follower_shares[f], share, test::kMeanWeight) << ring;
    double by_bone[4] = {};
    for (int k = 4 * follower; k < 4 * follower + 4; ++k) by_bone[weights.bones[k]] += weights.weights[k];
    EXPECT_NEAR(by_bone[2], 0.75 * share, test::kMeanWeight) << "the cloth's";
    EXPECT_NEAR(by_bone[1], 0.75 * (1 - share), test::kMeanWeight) << "the actor's own";
    EXPECT_NEAR(by_bone[3], 0.25, test::kMeanWeight) << "what it is carried by itself";
  }
  for (int i = 0; i < 4 * n; ++i) EXPECT_EQ(weights.weights[i], carried.weights[i]) << "cloth keeps its own";
}

TEST(ClothGraph, WhatHangsFromNothingIsNoParticle) {
  Actor actor = test::skirt_actor();
  // Cut between rings 6 and 7.
  std::vector<int32_t> kept;
  for (size_t t = 0; t < actor.mesh.triangles.size(); t += 3) {
    const auto first = actor.mesh.triangles.begin() + t;
    const auto [low, high] = std::minmax_element(first, first + 3);
    if (*low / test::kAround != 6 || *high / test::kAround != 7) kept.insert(kept.end(), first, first + 3);
  }
  actor.mesh.triangles = kept;
  const ClothGraph graph = make_cloth_graph(actor, kHeld);
  EXPECT_EQ(graph.n_particles(), 7 * test::kAround);
  EXPECT_EQ(int(graph.followers.size()), (test::kRings - 7) * test::kAround);
}

TEST(ClothGraph, IsEmptyWithoutHangingClothOrHips) {
  Actor trousers = test::skirt_actor();
  trousers.rigidity.assign(trousers.rigidity.size(), 2.0f);
  EXPECT_EQ(make_cloth_graph(trousers, kHeld).n_particles(), 0);
  Actor hipless = test::skirt_actor();
  hipless.skeleton.bones[4].name = "stick";
  EXPECT_EQ(make_cloth_graph(hipless, kHeld).n_particles(), 0);
  EXPECT_EQ(make_cloth_graph(test::builtin_actor("trousers"), kHeld).n_particles(), 0);
}

TEST(ClothGraph, TheBuiltInSkirtHangsFromItsWaist) {
  const Actor& actor = test::builtin_actor("skirt");
  const ClothGraph graph = make_cloth_graph(actor, kHeld);
  std::set<int> all(graph.vertices.begin(), graph.vertices.end());
  all.insert(graph.followers.begin(), graph.followers.end());
  EXPECT_EQ(all.size(), graph.vertices.size() + graph.followers.size());
  float lowest_held = 1e9f, highest_free = -1e9f;
  for (int i = 0; i < actor.n_vertices(); ++i)
    if (hangs(actor, i)) EXPECT_TRUE(all.count(i)) << i;
  for (int p = 0; p < graph.n_particles(); ++p) {
    const float y = actor.mesh.positions[3 * graph.vertices[p] + 1];
    if (graph.held[p])
      lowest_held = std::min(lowest_held, y);
    else
      highest_free = std::max(highest_free, y);
  }
  // The four nearest, by looking at all.
  const auto place = [&](int i) { return Eigen::Map<const Eigen::Vector3f>(actor.mesh.positions.data() + 3 * i); };
  for (size_t f = 0; f < graph.followers.size(); f += 7) {
    std::vector<std::pair<float, int>> all_of_them;
    for (int p = 0; p < graph.n_particles(); ++p)
      all_of_them.emplace_back((place(graph.followers[f]) - place(graph.vertices[p])).norm(), p);
    std::sort(all_of_them.begin(), all_of_them.end());
    for (int k = 0; k < 4; ++k) EXPECT_EQ(graph.followed[4 * f + k], all_of_them[k].second) << f << " " << k;
  }
  const double hips = middle_of_the_hips(actor.skeleton)->y();
  EXPECT_GT(lowest_held, hips - 150);
  EXPECT_LT(highest_free, hips + 100);
  EXPECT_GT(graph.n_particles(), 800);
}

}  // namespace
}  // namespace livecap
