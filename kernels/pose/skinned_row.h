// A row of J for a skinned vertex: the vertex with the parts of its blend, and the row's derivative summed up per bone.
// A slice of vertices at a time: shared/lanes.h comes first.
#ifndef LC_POSE_SKINNED_ROW_H
#define LC_POSE_SKINNED_ROW_H
#include "pose/layout.h"
#include "pose/skinned_gradient.h"
#include "shared/gather_dual_quat.h"

typedef struct {
  Vec3 rest;             // mm, template frame
  Vec3 position;         // mm, root-relative
  DualQuat blend;        // sum of the parts
  DualQuat part[4];      // weighted dual quaternion of each bone; signs follow the strongest one (slot 0)
  LaneInt packed_bones;  // a byte each, LC_POSE_NO_BONE where the weight is 0
} SkinnedVertex;

// The vertices of the lanes from `first` on; lanes beyond the last of n repeat it.
LC_FN LaneInt lane_vertices(global const int* restrict vertices, int first, int n) {
  return gather_int(vertices, lane_rows(first, n));
}

// dual_quats [8*n_bones] root-relative, bones and weights [4*n_vertices].
LC_FN SkinnedVertex skinned_vertex(LaneInt vertex, Vec3 rest, LC_POSE_SPACE const float* restrict dual_quats,
                                   global const int* restrict bones, global const float* restrict weights) {
  SkinnedVertex s;
  s.rest = rest;
  s.blend = dual_quat_zero();
  s.packed_bones = 0;
  DualQuat first = dual_quat_zero();
  const Vec4 shares = gather_vec4(weights, 4 * vertex);
  const IntVec4 movers = gather_int_vec4(bones, 4 * vertex);
  const REAL share[4] = {shares.x, shares.y, shares.z, shares.w};
  const LaneInt mover[4] = {movers.x, movers.y, movers.z, movers.w};
#pragma unroll
  for (int j = 0; j < 4; ++j) {
    const REAL w = share[j];
    const LaneInt weighs = w != 0.0f, none = LC_POSE_NO_BONE;
    s.part[j] = dual_quat_zero();
    const LaneInt bone = mover[j];
    s.packed_bones |= (weighs ? bone : none) << (8 * j);
    if (j > 0 && !ANY_LANE(weighs)) continue;
    const LaneInt at = 8 * bone;
    const DualQuat turn = gather_dual_quat(dual_quats, at);
    if (j == 0) first = turn;
    s.part[j] = dual_quat_add_scaled(dual_quat_zero(), turn, dual_quat_real_dot(first, turn) < 0.0f ? -w : w);
    s.blend = dual_quat_add_scaled(s.blend, s.part[j], 1.0f);
  }
  s.position = dual_quat_transform(s.blend, rest);
  return s;
}

// How a row with the gradient g by the vertex changes with its blend.
LC_FN DualQuat point_gradient(const SkinnedVertex* s, Vec3 g) {
  return dual_quat_transform_gradient(s->blend, s->rest, s->position, g);
}

// The same for a direction that the blend turns from `rest` to `turned`: moving counts for nothing.
LC_FN DualQuat direction_gradient(DualQuat blend, Vec3 rest, Vec3 turned, Vec3 g) {
  blend.dw = blend.dx = blend.dy = blend.dz = 0.0f;
  DualQuat c = dual_quat_transform_gradient(blend, rest, turned, g);
  c.dw = c.dx = c.dy = c.dz = 0.0f;
  return c;
}

// c: one of the gradients above. counts: where false, the row is zero. record: the slice's, see pose/layout.h;
// first: of the lanes.
LC_FN void write_skinned_row(LC_POSE_SPACE float* restrict record, int first, const SkinnedVertex* s, DualQuat c,
                             LaneInt counts) {
  record += first % SLICE;
#pragma unroll
  for (int j = 0; j < 4; ++j) {
    if (!ANY_LANE((s->packed_bones >> (8 * j) & 255) != LC_POSE_NO_BONE)) continue;  // nobody reads it
    const Wrench w = dual_quat_turn_wrench(c, s->part[j]);
    const REAL values[6] = {w.torque.x, w.torque.y, w.torque.z, w.force.x, w.force.y, w.force.z};
#pragma unroll
    for (int k = 0; k < 6; ++k) STORE(counts ? values[k] : (REAL)0.0f, record, (6 * j + k) * SLICE);
  }
  STORE(LANE_BITS_AS_REAL(s->packed_bones), record, LC_POSE_RECORD_BONES * SLICE);
}

#endif
