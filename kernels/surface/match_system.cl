// E_match of the surface stage: adds every matched vertex's share of J^T J and -J^T F.
#include "match/layout.h"
#include "surface/add_system.h"
#include "terms/match.cl"

// matches [LC_MATCH*n]: mesh order. v: 3 planes; blocks (6 planes) and rhs (3 planes) are added to; energy (1 plane) is
// set.
kernel void match_system(int n, int n_rows, int stride, float weight, Pinhole cam, global const int* restrict order,
                         global const float* restrict matches, global const float* restrict v,
                         global float* restrict blocks, global float* restrict rhs, global float* restrict energy) {
  int row = get_global_id(0);
  if (row >= n_rows) return;
  energy[row] = 0.0f;
  if (row >= n || weight <= 0.0f) return;
  global const float* m = matches + LC_MATCH * order[row];
  if (!(m[LC_MATCH_WEIGHT_PX] > 0.0f)) return;
  Vec3 p = vec3(v[row], v[stride + row], v[2 * stride + row]);
  if (!(p.z > LC_MIN_DEPTH_MM)) return;
  Vec2 target = {m[0], m[1]};
  MatchRow r = match_row(p, cam, target, m[2], m[3], m[4]);
  float w = weight * m[LC_MATCH_CORRELATION];
  VertexSystem s = empty_system();
  LC_UNROLL
  for (int i = 0; i < 2; ++i) s = add_row(s, w, r.r[i], vec3(r.J[i][0], r.J[i][1], r.J[i][2]));
  add_system(s, row, stride, blocks, rhs);
  energy[row] = w * (r.r[0] * r.r[0] + r.r[1] * r.r[1]);
}
