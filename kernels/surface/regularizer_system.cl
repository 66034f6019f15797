// E_smooth, E_edge, E_depth, E_velocity and E_acceleration of the surface stage: completes the diagonal blocks and
// right-hand side that the data terms began, leaves one vector per directed edge for the matrix-free product, inverts
// the blocks (the preconditioner) and starts the conjugate gradients.
//
// Both directions of an edge contribute, so its weight is c_ij = s_ij (1/|N_i| + 1/|N_j|), the same seen from i and j.
#include "shared/lanes.h"
//
#include "surface/direction.h"
#include "surface/system.h"
#include "terms/acceleration.cl"
#include "terms/depth.cl"
#include "terms/edge.cl"
#include "terms/smooth.cl"
#include "terms/velocity.cl"

static inline Vec3 load_planes(global const float* restrict planes, int stride, int at) {
  return vec3(LOAD(planes, at), LOAD(planes, at + stride), LOAD(planes, at + 2 * stride));
}

static inline Vec3 gather_planes(global const float* restrict planes, int stride, LaneInt i) {
  return vec3(gather(planes, i), gather(planes + stride, i), gather(planes + 2 * stride, i));
}

static inline void store_planes(Vec3 value, global float* restrict planes, int stride, int at) {
  STORE(value.x, planes, at);
  STORE(value.y, planes, at + stride);
  STORE(value.z, planes, at + 2 * stride);
}

// slice_offsets [n_rows/16+1], neighbors (rows), edge_weights, rest_lengths, rest_shares: SELL-16 entries, padding has
// weight zero.
// v, skinned, previous, before: 3 planes mm. blocks: 6 planes, in: data terms, out: complete. rhs: 3 planes, likewise.
// rest_shares: how far an edge's length is drawn from the skinned template's to the rest pose's.
// edges: sqrt(w_edge c_ij) times the unit edge, 3 per entry, 16 of each axis together. inverse: 6 planes.
// z, p: 3 planes (p: surface/direction.h), preconditioned rhs; step: 3 planes, zero. products: rhs . z per row.
// has_previous: 1, or 0 where there is no frame before. depth_weights: of each row, 0 where E_depth does not hold;
// velocity_weights: of each row. energies: planes smooth, edge, velocity, acceleration, depth.
kernel void regularizer_system(int n_rows, int stride, float w_smooth, float w_edge, float has_previous,
                               float w_acceleration, float damping, global const int* restrict slice_offsets,
                               global const int* restrict neighbors, global const float* restrict edge_weights,
                               global const float* restrict rest_lengths, global const float* restrict rest_shares,
                               global const float* restrict depth_weights,
                               global const float* restrict velocity_weights, global const float* restrict v,
                               global const float* restrict skinned, global const float* restrict previous,
                               global const float* restrict before, global float* restrict blocks,
                               global float* restrict rhs, global float* restrict edges, global float* restrict inverse,
                               global float* restrict z, global float* restrict p, global float* restrict step,
                               global float* restrict products, global float* restrict energies) {
  int row = FIRST_ROW;
  if (row >= n_rows) return;
  Vec3 v_i = load_planes(v, stride, row);
  Vec3 skinned_i = load_planes(skinned, stride, row);
  Vec3 previous_i = load_planes(previous, stride, row);
  VertexSystem s;
  s.xx = LOAD(blocks, row) + damping;
  s.xy = LOAD(blocks, row + stride);
  s.xz = LOAD(blocks, row + 2 * stride);
  s.yy = LOAD(blocks, row + 3 * stride) + damping;
  s.yz = LOAD(blocks, row + 4 * stride);
  s.zz = LOAD(blocks, row + 5 * stride) + damping;
  s.rhs = load_planes(rhs, stride, row);

  // These rows have a multiple of the identity as Jacobian, so one entry of it tells all.
  VelocityRow velocity = velocity_row(v_i, previous_i);
  AccelerationRow acceleration = acceleration_row(v_i, previous_i, load_planes(before, stride, row));
  const REAL w_velocity = has_previous * LOAD(velocity_weights, row);
  Vec3 r_velocity = vec3(velocity.r[0], velocity.r[1], velocity.r[2]);
  Vec3 r_acceleration = vec3(acceleration.r[0], acceleration.r[1], acceleration.r[2]);
  s.rhs = sub3(s.rhs, scale3(r_velocity, w_velocity * velocity.J[0][0]));
  s.rhs = sub3(s.rhs, scale3(r_acceleration, w_acceleration * acceleration.J[0][0]));
  REAL diagonal =
      w_velocity * velocity.J[0][0] * velocity.J[0][0] + w_acceleration * acceleration.J[0][0] * acceleration.J[0][0];

  DepthRow depth = depth_row(v_i, skinned_i);
  REAL w_depth = LOAD(depth_weights, row);
  s = add_row(s, w_depth, depth.r, vec3(depth.J[0], depth.J[1], depth.J[2]));

  REAL e_smooth = 0.0f, e_edge = 0.0f;
  int begin = slice_offsets[row / SLICE];
  int end = slice_offsets[row / SLICE + 1];
  for (int base = begin; base < end; base += SLICE) {
    int at = base + row % SLICE;
    LaneInt j = LOAD(neighbors, at);
    REAL c = LOAD(edge_weights, at);
    Vec3 v_j = gather_planes(v, stride, j);
    Vec3 skinned_j = gather_planes(skinned, stride, j);
    SmoothRow smooth = smooth_row(v_i, v_j, skinned_i, skinned_j);
    Vec3 r_smooth = vec3(smooth.r[0], smooth.r[1], smooth.r[2]);
    REAL k = w_smooth * c;
    s.rhs = sub3(s.rhs, scale3(r_smooth, k * smooth.J[0][0]));
    diagonal += k * smooth.J[0][0] * smooth.J[0][0];
    e_smooth += k * dot3(r_smooth, r_smooth);

    REAL skinned_length = norm3(sub3(skinned_i, skinned_j));
    REAL length = skinned_length + LOAD(rest_shares, at) * (LOAD(rest_lengths, at) - skinned_length);
    EdgeRow edge = edge_row(v_i, v_j, length);
    Vec3 direction = scale3(vec3(edge.J[0][0], edge.J[0][1], edge.J[0][2]), sqrt(w_edge * c));
    s = add_row(s, w_edge * c, edge.r, vec3(edge.J[0][0], edge.J[0][1], edge.J[0][2]));
    e_edge += w_edge * c * edge.r * edge.r;
    int out = 3 * base + row % SLICE;
    STORE(direction.x, edges, out);
    STORE(direction.y, edges, out + SLICE);
    STORE(direction.z, edges, out + 2 * SLICE);
  }
  s.xx += diagonal;
  s.yy += diagonal;
  s.zz += diagonal;

  // Symmetric inverse by cofactors; the blocks are positive definite.
  REAL cxx = s.yy * s.zz - s.yz * s.yz;
  REAL cxy = s.xz * s.yz - s.xy * s.zz;
  REAL cxz = s.xy * s.yz - s.xz * s.yy;
  REAL inv_det = 1.0f / (s.xx * cxx + s.xy * cxy + s.xz * cxz);
  REAL ixx = cxx * inv_det, ixy = cxy * inv_det, ixz = cxz * inv_det;
  REAL iyy = (s.xx * s.zz - s.xz * s.xz) * inv_det;
  REAL iyz = (s.xy * s.xz - s.xx * s.yz) * inv_det;
  REAL izz = (s.xx * s.yy - s.xy * s.xy) * inv_det;
  Vec3 r = s.rhs;
  Vec3 z_i =
      vec3(ixx * r.x + ixy * r.y + ixz * r.z, ixy * r.x + iyy * r.y + iyz * r.z, ixz * r.x + iyz * r.y + izz * r.z);

  STORE(s.xx, blocks, row);
  STORE(s.xy, blocks, row + stride);
  STORE(s.xz, blocks, row + 2 * stride);
  STORE(s.yy, blocks, row + 3 * stride);
  STORE(s.yz, blocks, row + 4 * stride);
  STORE(s.zz, blocks, row + 5 * stride);
  STORE(ixx, inverse, row);
  STORE(ixy, inverse, row + stride);
  STORE(ixz, inverse, row + 2 * stride);
  STORE(iyy, inverse, row + 3 * stride);
  STORE(iyz, inverse, row + 4 * stride);
  STORE(izz, inverse, row + 5 * stride);
  store_planes(r, rhs, stride, row);
  store_planes(z_i, z, stride, row);
  store_direction(z_i, p, row, stride);
  REAL zero = 0.0f;
  store_planes(vec3(zero, zero, zero), step, stride, row);
  REAL product = dot3(r, z_i);
  STORE(product, products, row);
  // Each undirected edge is met twice with its whole weight.
  e_smooth *= 0.5f;
  e_edge *= 0.5f;
  STORE(e_smooth, energies, row);
  STORE(e_edge, energies, row + stride);
  REAL e_velocity = w_velocity * dot3(r_velocity, r_velocity);
  REAL e_acceleration = w_acceleration * dot3(r_acceleration, r_acceleration);
  STORE(e_velocity, energies, row + 2 * stride);
  STORE(e_acceleration, energies, row + 3 * stride);
  REAL e_depth = w_depth * depth.r * depth.r;
  STORE(e_depth, energies, row + 4 * stride);
}
