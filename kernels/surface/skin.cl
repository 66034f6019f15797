// Dual quaternion skinning of a whole template, its inverse for displacements, and vertex normals.
// One work-item per vertex; any work-group size.
#include "shared/dual_quat.h"

// The blended (not normalised) motion of vertex i; signs follow the strongest influence.
static inline DualQuat blended_motion(int i, global const int* restrict bones, global const float* restrict weights,
                                      global const float* restrict dual_quats) {
  DualQuat first = dual_quat_zero();
  DualQuat sum = dual_quat_zero();
  for (int k = 0; k < 4; ++k) {
    float8 v = vload8(bones[4 * i + k], dual_quats);
    DualQuat q = {v.s0, v.s1, v.s2, v.s3, v.s4, v.s5, v.s6, v.s7};
    if (k == 0) first = q;
    float w = weights[4 * i + k];
    sum = dual_quat_add_scaled(sum, q, dual_quat_real_dot(first, q) < 0.0f ? -w : w);
  }
  return sum;
}

// out = DQS(rest + displacement). All [3n] mm.
kernel void skin_vertices(int n, global const float* restrict rest, global const float* restrict displacement,
                          global const int* restrict bones,         // [4n]
                          global const float* restrict weights,     // [4n]
                          global const float* restrict dual_quats,  // [8 n_bones]
                          global float* restrict out) {
  int i = get_global_id(0);
  if (i >= n) return;
  float3 p = vload3(i, rest) + vload3(i, displacement);
  Vec3 v = dual_quat_transform(blended_motion(i, bones, weights, dual_quats), vec3(p.x, p.y, p.z));
  vstore3((float3)(v.x, v.y, v.z), i, out);
}

// out = share R^-1 (deformed - skinned), R the blended rotation. All [3n] mm.
kernel void unskin_displacement(int n, global const float* restrict deformed, global const float* restrict skinned,
                                global const float* restrict share,       // [n] 0..1
                                global const int* restrict bones,         // [4n]
                                global const float* restrict weights,     // [4n]
                                global const float* restrict dual_quats,  // [8 n_bones]
                                global float* restrict out) {
  int i = get_global_id(0);
  if (i >= n) return;
  float3 d = share[i] * (vload3(i, deformed) - vload3(i, skinned));
  Vec3 v = dual_quat_unrotate(blended_motion(i, bones, weights, dual_quats), vec3(d.x, d.y, d.z));
  vstore3((float3)(v.x, v.y, v.z), i, out);
}

// Area-weighted unit normals; zero where a vertex has no area.
kernel void vertex_normals(int n, global const float* restrict positions,
                           global const int* restrict fan_offsets,    // [n+1]
                           global const int* restrict fan_triangles,  // [3 fan_offsets[n]] corners
                           global float* restrict out) {
  int i = get_global_id(0);
  if (i >= n) return;
  float3 sum = (float3)(0.0f);
  for (int f = fan_offsets[i]; f < fan_offsets[i + 1]; ++f) {
    float3 a = vload3(fan_triangles[3 * f], positions);
    float3 b = vload3(fan_triangles[3 * f + 1], positions);
    float3 c = vload3(fan_triangles[3 * f + 2], positions);
    sum += cross(b - a, c - a);
  }
  float length2 = dot(sum, sum);
  vstore3(length2 > 0.0f ? sum * (1.0f / sqrt(length2)) : sum, i, out);
}
