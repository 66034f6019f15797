// The material of each vertex (LIP ids): voted by label images, or without any guessed from body part and colour.
#pragma once

#include <cstdint>
#include <vector>

#include "acquire/body_rig.h"
#include "acquire/surface_views.h"
#include "meshing/actor_glb.h"

namespace livecap::acquire {

struct MaterialLabels {
  std::vector<uint8_t> labels;  // [n_vertices]
  int n_unseen = 0;             // vertices without a vote; they take their neighbours' label
};

// Majority over the views that see a vertex, each weighted by how straight it looks at it; background does not vote.
MaterialLabels vote_labels(const meshing::Surface& surface, const std::vector<View>& views,
                           const std::vector<ViewCoverage>& coverage);

// No network: the body part from the skin weights, cloth against skin and hair by colour. colors: [n_vertices] sRGB in
// [0,1].
std::vector<uint8_t> guess_labels(const meshing::Surface& surface, const std::vector<meshing::Influences>& weights,
                                  const BodyJoints& joints, const std::vector<Eigen::Vector3d>& colors);

}  // namespace livecap::acquire
