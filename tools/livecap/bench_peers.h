// Times of widely used libraries for work of the kind and size that a captured frame contains, on one thread: what our
// own stages are compared with on the same machine in the same minute.
#pragma once

#include "actor/actor.h"

namespace livecap::tools {

// Medians, ms.
struct PeerTimes {
  double distance_transform_ms = 0;  // OpenCV, exact Euclidean, both sides of a silhouette
  double gaussian_blur_ms = 0;       // OpenCV, kernels 15, 9 and 3 of a float RGB picture
  double conjugate_gradient_ms = 0;  // Eigen, 3 x 4 iterations on three unknowns per vertex, Jacobi preconditioner
};

// width, height: of the picture, px. The system is I + L of the actor's mesh, the sparsity of stage II.
PeerTimes time_peers(const Actor& actor, int width, int height);

}  // namespace livecap::tools
