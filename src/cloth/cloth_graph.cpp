#include "cloth/cloth_graph.h"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <limits>
#include <map>
#include <optional>
#include <utility>

#include "cloth/hanging_cloth.h"

namespace livecap {
namespace {

using Edge = std::pair<int, int>;

constexpr int kFollowed = 4;
constexpr int kSweeps = 400;         // Gauss-Seidel; a lid of twenty rings is right within a hundredth then
constexpr float kDownwards = -0.6f;  // the vertical part of a normal; linings and lids lie below it

Eigen::Vector3f vertex(const std::vector<float>& positions, int i) {
  return {positions[3 * i], positions[3 * i + 1], positions[3 * i + 2]};
}

// The edges of the triangles of outer cloth and its seam, which is above the hips: each with the vertices opposite.
std::map<Edge, std::vector<int>> cloth_edges(const Actor& actor, const std::vector<char>& outer, float hips_y) {
  std::map<Edge, std::vector<int>> edges;
  const auto is_part = [&](int i) {
    return outer[i] || (!hangs(actor, i) && actor.mesh.positions[3 * i + 1] > hips_y);
  };
  for (int t = 0; t < actor.mesh.n_triangles(); ++t) {
    const int* corner = actor.mesh.triangles.data() + 3 * t;
    if (!std::any_of(corner, corner + 3, [&](int i) { return outer[i]; }) || !std::all_of(corner, corner + 3, is_part))
      continue;
    for (int k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(corner[k], corner[(k + 1) % 3]);
      edges[{low, high}].push_back(corner[(k + 2) % 3]);
    }
  }
  return edges;
}

// Both ways, whether across, per vertex.
using Links = std::vector<std::map<int, char>>;

Links links_of(int n_vertices, const std::map<Edge, std::vector<int>>& edges) {
  Links links(n_vertices);
  const auto link = [&](int i, int j, char across) {
    links[i].emplace(j, across);
    links[j].emplace(i, across);
  };
  for (const auto& [edge, opposite] : edges) link(edge.first, edge.second, 0);
  for (const auto& [edge, opposite] : edges)
    if (opposite.size() == 2) link(opposite[0], opposite[1], 1);
  return links;
}

std::vector<char> reached_from(const std::vector<char>& held, const Links& links) {
  std::vector<char> reached = held;
  std::vector<int> waiting;
  for (size_t i = 0; i < held.size(); ++i)
    if (held[i]) waiting.push_back(int(i));
  while (!waiting.empty()) {
    const int i = waiting.back();
    waiting.pop_back();
    for (const auto& [j, across] : links[i]) {
      if (reached[j]) continue;
      reached[j] = 1;
      waiting.push_back(j);
    }
  }
  return reached;
}

// The particles nearest to a place, looked for from its height on upwards and downwards.
class NearestParticles {
 public:
  NearestParticles(const Actor& actor, const ClothGraph& graph) {
    for (int p = 0; p < graph.n_particles(); ++p)
      by_height_.emplace_back(vertex(actor.mesh.positions, graph.vertices[p]), p);
    std::sort(by_height_.begin(), by_height_.end(), [](auto& a, auto& b) { return a.first.y() < b.first.y(); });
  }

  // Distance and particle, nearest first.
  std::array<std::pair<float, int>, kFollowed> to(const Eigen::Vector3f& place) const {
    std::array<std::pair<float, int>, kFollowed> near;
    near.fill({std::numeric_limits<float>::infinity(), -1});
    const auto take = [&](const std::pair<Eigen::Vector3f, int>& particle) {
      if (std::abs(particle.first.y() - place.y()) > near.back().first) return false;
      const std::pair<float, int> candidate{(place - particle.first).norm(), particle.second};
      if (candidate < near.back()) {
        near.back() = candidate;
        std::sort(near.begin(), near.end());
      }
      return true;
    };
    const auto middle = std::lower_bound(by_height_.begin(), by_height_.end(), place.y(),
                                         [](auto& particle, float y) { return particle.first.y() < y; });
    for (auto up = middle; up != by_height_.end() && take(*up); ++up) {
    }
    for (auto down = middle; down != by_height_.begin() && take(*std::prev(down)); --down) {
    }
    return near;
  }

 private:
  std::vector<std::pair<Eigen::Vector3f, int>> by_height_;
};

void add_follower(const Actor& actor, int i, const NearestParticles& nearest, ClothGraph& graph) {
  const auto near = nearest.to(vertex(actor.mesh.positions, i));
  float sum = 0;
  for (int k = 0; k < kFollowed; ++k) sum += 1 / (near[k].first + 1);
  graph.followers.push_back(i);
  for (int k = 0; k < kFollowed; ++k) {
    graph.followed.push_back(near[k].second);
    graph.followed_weights.push_back(1 / (near[k].first + 1) / sum);
  }
}

std::vector<float> shares_of_followers(const Actor& actor, const ClothGraph& graph) {
  std::vector<float> shares(actor.n_vertices(), 0.0f);
  for (const std::vector<int32_t>* cloth : {&graph.vertices, &graph.followers})
    for (const int i : *cloth) shares[i] = 1;
  const OneRing ring = one_ring(actor.n_vertices(), actor.mesh.triangles);
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    for (const int i : graph.followers) {
      const int begin = ring.offsets[i], n = ring.offsets[i + 1] - begin;
      float sum = 0;
      for (int k = begin; k < begin + n; ++k) sum += shares[ring.neighbors[k]];
      if (n > 0) shares[i] = sum / float(n);
    }
  }
  std::vector<float> of_followers;
  for (const int i : graph.followers) of_followers.push_back(shares[i]);
  return of_followers;
}

// [n_vertices] 1 for hanging cloth (cloth/hanging_cloth.h) whose normals in the rest pose point away from the line
// through the middle of the hips and not downwards: what is seen from outside. None for a skeleton without hips.
std::vector<char> outer_cloth(const Actor& actor) {
  std::vector<char> outer(actor.n_vertices(), 0);
  const std::optional<Eigen::Vector3d> middle = middle_of_the_hips(actor.skeleton);
  if (!middle) return outer;
  const Eigen::Vector3f hips = middle->cast<float>();
  const std::vector<float> normals = vertex_normals(actor.mesh.positions, actor.mesh.triangles);
  for (int i = 0; i < actor.n_vertices(); ++i) {
    const Eigen::Vector3f normal = vertex(normals, i), from_hips = vertex(actor.mesh.positions, i) - hips;
    outer[i] =
        hangs(actor, i) && normal.y() > kDownwards && normal.x() * from_hips.x() + normal.z() * from_hips.z() > 0;
  }
  return outer;
}

}  // namespace

ClothGraph make_cloth_graph(const Actor& actor, float max_held_leg_weight) {
  ClothGraph graph;
  const std::optional<Eigen::Vector3d> hips = middle_of_the_hips(actor.skeleton);
  if (!hips) return graph;
  const std::vector<float> legs = leg_weights(actor);
  const std::vector<char> outer = outer_cloth(actor);
  const Links links = links_of(actor.n_vertices(), cloth_edges(actor, outer, float(hips->y())));

  std::vector<char> held(actor.n_vertices(), 0);
  for (int i = 0; i < actor.n_vertices(); ++i)
    held[i] = !links[i].empty() && (!outer[i] || legs[i] <= max_held_leg_weight);
  const std::vector<char> reached = reached_from(held, links);
  std::vector<int> particle(actor.n_vertices(), -1);
  for (int i = 0; i < actor.n_vertices(); ++i) {
    if (!reached[i]) continue;
    particle[i] = graph.n_particles();
    graph.vertices.push_back(i);
    graph.held.push_back(held[i]);
  }
  if (std::count(graph.held.begin(), graph.held.end(), char(0)) == 0 || graph.n_particles() < kFollowed) return {};

  graph.links.offsets = {0};
  for (const int i : graph.vertices) {
    for (const auto& [j, across] : links[i]) {
      graph.links.neighbors.push_back(particle[j]);
      graph.across.push_back(across);
    }
    graph.links.offsets.push_back(int(graph.links.neighbors.size()));
  }
  const NearestParticles nearest(actor, graph);
  for (int i = 0; i < actor.n_vertices(); ++i)
    if (hangs(actor, i) && particle[i] < 0) add_follower(actor, i, nearest, graph);
  graph.follower_shares = shares_of_followers(actor, graph);
  return graph;
}

SkinWeights with_followers(const Actor& actor, const ClothGraph& graph, const SkinWeights& carried, float looseness) {
  SkinWeights weights = carried;
  for (size_t f = 0; f < graph.followers.size(); ++f) {
    std::map<int, float> of_bones;
    const auto add = [&](const SkinWeights& from, int i, float times) {
      for (int k = kMaxInfluences * i; k < kMaxInfluences * (i + 1); ++k)
        of_bones[from.bones[k]] += times * from.weights[k];
    };
    const float share = graph.follower_shares[f];
    for (size_t k = kFollowed * f; k < kFollowed * (f + 1); ++k)
      add(carried, graph.vertices[graph.followed[k]], (1 - looseness) * share * graph.followed_weights[k]);
    add(actor.skin, graph.followers[f], (1 - looseness) * (1 - share));
    add(carried, graph.followers[f], looseness);
    std::vector<std::pair<float, int>> influences;
    for (const auto& [bone, weight] : of_bones) influences.emplace_back(weight, bone);
    set_strongest(weights, graph.followers[f], std::move(influences));
  }
  return weights;
}

}  // namespace livecap
