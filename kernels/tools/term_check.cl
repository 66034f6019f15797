// Every term's flat function as a kernel over a batch of instances: the device side of the term tests. One line per
// term file; sizes as in src/solve/term_table.cpp.
#include "terms/acceleration.cl"
#include "terms/anatomic.cl"
#include "terms/depth.cl"
#include "terms/edge.cl"
#include "terms/floor.cl"
#include "terms/keypoint_2d.cl"
#include "terms/keypoint_3d.cl"
#include "terms/match.cl"
#include "terms/photo.cl"
#include "terms/rest.cl"
#include "terms/shading.cl"
#include "terms/silhouette.cl"
#include "terms/smooth.cl"
#include "terms/temporal.cl"
#include "terms/velocity.cl"

// n instances; x [n*n_unknowns], params [n*n_params]; out r [n*n_residuals], J [n*n_residuals*n_unknowns] row major.
#define LC_CHECK_TERM(term, n_residuals, n_unknowns, n_params)                                             \
  kernel void check_##term(int n, global const float* restrict x, global const float* restrict params,     \
                           global float* restrict r, global float* restrict J) {                           \
    const int i = get_global_id(0);                                                                        \
    if (i >= n) return;                                                                                    \
    float in[n_unknowns], constants[n_params], residuals[n_residuals], jacobian[n_residuals * n_unknowns]; \
    for (int k = 0; k < n_unknowns; ++k) in[k] = x[i * n_unknowns + k];                                    \
    for (int k = 0; k < n_params; ++k) constants[k] = params[i * n_params + k];                            \
    term##_flat(in, constants, residuals, jacobian);                                                       \
    for (int k = 0; k < n_residuals; ++k) r[i * n_residuals + k] = residuals[k];                           \
    for (int k = 0; k < n_residuals * n_unknowns; ++k) J[i * n_residuals * n_unknowns + k] = jacobian[k];  \
  }

LC_CHECK_TERM(keypoint_2d, 2, 3, 6)
LC_CHECK_TERM(keypoint_3d, 3, 6, 3)
LC_CHECK_TERM(silhouette, 1, 3, 10)
LC_CHECK_TERM(match, 2, 3, 9)
LC_CHECK_TERM(floor, 1, 3, 5)
LC_CHECK_TERM(temporal, 3, 3, 3)
LC_CHECK_TERM(anatomic, 1, 1, 2)
LC_CHECK_TERM(rest, 1, 1, 1)
LC_CHECK_TERM(photo, 3, 3, 19)
LC_CHECK_TERM(shading, 1, 3, 10)
LC_CHECK_TERM(smooth, 3, 6, 6)
LC_CHECK_TERM(edge, 1, 6, 1)
LC_CHECK_TERM(depth, 1, 3, 3)
LC_CHECK_TERM(velocity, 3, 3, 3)
LC_CHECK_TERM(acceleration, 3, 3, 6)
