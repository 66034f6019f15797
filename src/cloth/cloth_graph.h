// What of an actor hangs, and what it is linked with: particles for the cloth that is seen from outside, and which of
// them the rest of it (hems, linings, lids) follows.
#pragma once

#include <cstdint>
#include <vector>

#include "actor/actor.h"
#include "geometry/mesh.h"

namespace livecap {

struct ClothGraph {
  std::vector<int32_t> vertices;  // [n_particles] of the template
  std::vector<char> held;         // [n_particles] fastened to the skinned surface
  // Along the edges of the mesh and across them, between the two vertices that an edge's triangles do not share.
  OneRing links;
  std::vector<char> across;  // [links.neighbors.size()]
  // Vertices that hang but are no particles. Each moves as its four nearest particles do, nearer ones more.
  std::vector<int32_t> followers;       // [n_followers]
  std::vector<int32_t> followed;        // [4*n_followers] particles
  std::vector<float> followed_weights;  // [4*n_followers], 1 in sum
  // [n_followers] How far they are the cloth's and not the body's: harmonic over the mesh between particles (1) and
  // what does not hang (0), 1 for what is joined to neither.
  std::vector<float> follower_shares;

  int n_particles() const { return static_cast<int>(vertices.size()); }
};

// Particles are the outer cloth and the seam it is sewn to. Held are the seam and what
// has weights of at most max_held_leg_weight on the legs; what is linked to nothing held is no particle. Empty without
// any, or for a skeleton without hips.
ClothGraph make_cloth_graph(const Actor& actor, float max_held_leg_weight);

// The weights that hanging cloth is carried by (HangingCloth) with those of its followers from both their ends: as far
// as they are the cloth's, the mean of the particles' that they follow, and for the rest the actor's own, with which
// legs go where they go. looseness: 0 all of that, 1 what they are carried by themselves.
SkinWeights with_followers(const Actor& actor, const ClothGraph& graph, const SkinWeights& carried, float looseness);

}  // namespace livecap
