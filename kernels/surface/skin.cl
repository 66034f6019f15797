// Dual quaternion skinning of a whole template, its inverse for displacements, and vertex normals. Over the vertices,
// LANES each.
#include "shared/lanes.h"
//
#include "shared/gather_dual_quat.h"

// The blended (not normalised) motion of the vertices i; signs follow the strongest influence.
static inline DualQuat blended_motion(LaneInt i, global const int* restrict bones, global const float* restrict weights,
                                      global const float* restrict dual_quats) {
  DualQuat first = dual_quat_zero();
  DualQuat sum = dual_quat_zero();
  const Vec4 shares = gather_vec4(weights, 4 * i);
  const IntVec4 movers = gather_int_vec4(bones, 4 * i);
  const REAL share[4] = {shares.x, shares.y, shares.z, shares.w};
  const LaneInt mover[4] = {movers.x, movers.y, movers.z, movers.w};
  LC_UNROLL
  for (int k = 0; k < 4; ++k) {
    const REAL w = share[k];
    if (k > 0 && !ANY_LANE(w != 0.0f)) continue;
    const LaneInt at = 8 * mover[k];
    const DualQuat q = gather_dual_quat(dual_quats, at);
    if (k == 0) first = q;
    sum = dual_quat_add_scaled(sum, q, dual_quat_real_dot(first, q) < 0.0f ? -w : w);
  }
  return sum;
}

// See skin_vertices; the lanes from vertex `first` < n on.
static inline void skin_lanes(int first, int n, global const float* restrict rest,
                              global const float* restrict displacement, global const int* restrict bones,
                              global const float* restrict weights, global const float* restrict dual_quats,
                              global float* restrict out) {
  const LaneInt i = lane_rows(first, n);
  const Vec3 p = add3(gather_vec3(rest, i), gather_vec3(displacement, i));
  store_vec3(dual_quat_transform(blended_motion(i, bones, weights, dual_quats), p), out, first, n);
}

// out = DQS(rest + displacement). All [3n] mm.
kernel void skin_vertices(int n, global const float* restrict rest, global const float* restrict displacement,
                          global const int* restrict bones,         // [4n]
                          global const float* restrict weights,     // [4n]
                          global const float* restrict dual_quats,  // [8 n_bones]
                          global float* restrict out) {
  if (FIRST_ROW < n) skin_lanes(FIRST_ROW, n, rest, displacement, bones, weights, dual_quats, out);
}

// out = share R^-1 (deformed - skinned), R the blended rotation. All [3n] mm.
kernel void unskin_displacement(int n, global const float* restrict deformed, global const float* restrict skinned,
                                global const float* restrict share,       // [n] 0..1
                                global const int* restrict bones,         // [4n]
                                global const float* restrict weights,     // [4n]
                                global const float* restrict dual_quats,  // [8 n_bones]
                                global float* restrict out) {
  const int first = FIRST_ROW;
  if (first >= n) return;
  const LaneInt i = lane_rows(first, n);
  const Vec3 d = scale3(sub3(gather_vec3(deformed, i), gather_vec3(skinned, i)), gather(share, i));
  store_vec3(dual_quat_unrotate(blended_motion(i, bones, weights, dual_quats), d), out, first, n);
}

// Products and sums of normals are rounded one by one, as the built-in cross() and dot() of PoCL round them.
#pragma OPENCL FP_CONTRACT OFF

static inline void store_unit(Vec3 sum, global float* restrict out, int first, int n) {
  const REAL length2 = sum.x * sum.x + sum.y * sum.y + sum.z * sum.z, one = 1.0f;
  store_vec3(scale3(sum, length2 > 0.0f ? 1.0f / sqrt(length2) : one), out, first, n);
}

// The normal of a triangle, as long as twice its area.
static inline Vec3 doubled_area(Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 d = sub3(b, a), e = sub3(c, a);
  return vec3(d.y * e.z - d.z * e.y, d.z * e.x - d.x * e.z, d.x * e.y - d.y * e.x);
}

// Area-weighted unit normals; zero where a vertex has no area.
#if LC_CPU

// doubled_area of every triangle: [4n], the fourth value zero. Over the triangles, LANES each.
kernel void triangle_normals(int n, global const float* restrict positions,
                             global const int* restrict triangles,  // [3n]
                             global float* restrict out) {
  const int first = FIRST_ROW;
  if (first >= n) return;
  const LaneInt t = lane_rows(first, n);
  const IntVec3 corner = gather_int_vec3(triangles, t);
  const Vec3 area = doubled_area(gather_vec3(positions, corner.x), gather_vec3(positions, corner.y),
                                 gather_vec3(positions, corner.z));
  const REAL zero = 0.0f;
  store_vec4(area.x, area.y, area.z, zero, out, first, n);
}

kernel void vertex_normals(int n, global const float* restrict areas,  // [4*n_triangles]
                           global const int* restrict fan_offsets,     // [n+1]
                           global const int* restrict fan_triangles,   // [fan_offsets[n]]
                           global float* restrict out) {
  const int first = FIRST_ROW;
  if (first >= n) return;
  const LaneInt i = lane_rows(first, n), none = 0;
  const LaneInt end = gather_int(fan_offsets, i + 1);
  const REAL zero = 0.0f;
  Vec3 sum = vec3(zero, zero, zero);
  for (LaneInt f = gather_int(fan_offsets, i); ANY_LANE(f < end); f += 1) {
    const LaneInt is_one = f < end;
    const LaneInt t = gather_int(fan_triangles, is_one ? f : none);
    const Vec4 area = gather_vec4(areas, 4 * t);
    sum.x += is_one ? area.x : zero;
    sum.y += is_one ? area.y : zero;
    sum.z += is_one ? area.z : zero;
  }
  store_unit(sum, out, first, n);
}

#else

// See vertex_normals; of vertex i.
static inline void normal_of_vertex(int i, int n, global const float* restrict positions,
                                    global const int* restrict fan_offsets, global const int* restrict fan_triangles,
                                    global float* restrict out) {
  Vec3 sum = vec3(0.0f, 0.0f, 0.0f);
  const int end = fan_offsets[i + 1];
  for (int first = fan_offsets[i]; first < end; first += 4) {
    Vec3 areas[4];  // loaded at once; those beyond the last are the last again
#pragma unroll
    for (int k = 0; k < 4; ++k) {
      const int3 corners = vload3(min(first + k, end - 1), fan_triangles);
      areas[k] = doubled_area(gather_vec3(positions, corners.x), gather_vec3(positions, corners.y),
                              gather_vec3(positions, corners.z));
    }
#pragma unroll
    for (int k = 0; k < 4; ++k)
      if (first + k < end) sum = add3(sum, areas[k]);
  }
  store_unit(sum, out, i, n);
}

kernel void vertex_normals(int n, global const float* restrict positions,
                           global const int* restrict fan_offsets,    // [n+1]
                           global const int* restrict fan_triangles,  // [3 fan_offsets[n]] corners
                           global float* restrict out) {
  const int i = get_global_id(0);
  if (i < n) normal_of_vertex(i, n, positions, fan_offsets, fan_triangles, out);
}

#endif
