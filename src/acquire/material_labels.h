// The material of each vertex (LIP ids): voted by label images, or without any guessed from body part and colour.
#pragma once

#include <cstdint>
#include <vector>

#include "acquire/body_rig.h"
#include "meshing/actor_glb.h"
#include "scan/volume.h"
#include "texture/surface_views.h"

namespace livecap::acquire {

struct MaterialLabels {
  std::vector<uint8_t> labels;  // [n_vertices]
  int n_unseen = 0;             // vertices with too few votes; they take the label that is nearest along the surface
  double foreign = 0;           // share of the pixels looked at whose value is no LIP id
};

// Majority over the views that see a vertex (kEdgeOn), each weighted by how straight it looks at it; background does
// not vote, pixels beside those of another label little.
MaterialLabels vote_labels(const meshing::Surface& surface, const std::vector<View>& views,
                           const std::vector<ViewCoverage>& coverage);

// [n_vertices] 1: the views together see it as well as a few of all would from straight ahead. Fewer see edges: a built
// hem is mm beside the true one.
std::vector<char> well_seen(const std::vector<ViewCoverage>& coverage);

struct GuessInput {
  const meshing::Surface& surface;
  const std::vector<meshing::Influences>& weights;
  const BodyJoints& joints;
  const Volume& volume;                        // the body's inside
  const std::vector<Eigen::Vector3d>& colors;  // [n_vertices] sRGB in [0,1]; all the same: no colour
  int nose_vertex = -1;                        // -1: not known
  std::vector<char> seen;                      // [n_vertices] of well_seen; empty: all are
};

// No parsing network: the body part from the skin weights, cloth against skin and hair by the colour of the face, the
// waist where the colours above and below differ most, a skirt where the space between the thighs is filled. What is
// not well seen takes the label that is nearest along the surface. Knows face, hair, upper clothes, pants, skirt, arms,
// legs, shoes.
std::vector<uint8_t> guess_labels(const GuessInput& input);

}  // namespace livecap::acquire
