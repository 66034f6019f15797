// A row of J for a skinned vertex: the vertex with the parts of its blend, and the row's derivative summed up per bone.
#ifndef LC_POSE_SKINNED_ROW_H
#define LC_POSE_SKINNED_ROW_H
#include "pose/layout.h"
#include "pose/skinned_gradient.h"

// Square root of the Huber weight of a residual of this length.
LC_FN float huber_factor(float length, float threshold) {
  return threshold > 0.0f && length > threshold ? sqrt(threshold / length) : 1.0f;
}

typedef struct {
  Vec3 rest;         // mm, template frame
  Vec3 position;     // mm, root-relative
  DualQuat blend;    // sum of the parts
  DualQuat part[4];  // weighted dual quaternion of each bone; signs follow the strongest one (slot 0)
  int packed_bones;  // a byte each
} SkinnedVertex;

// dual_quats [8*n_bones] root-relative, bones and weights [4*n_vertices].
LC_FN SkinnedVertex skinned_vertex(int vertex, Vec3 rest, global const float* restrict dual_quats,
                                   global const int* restrict bones, global const float* restrict weights) {
  SkinnedVertex s;
  s.rest = rest;
  s.blend = dual_quat_zero();
  s.packed_bones = 0;
  DualQuat first = dual_quat_zero();
#pragma unroll
  for (int j = 0; j < 4; ++j) {
    const int bone = bones[4 * vertex + j];
    const float8 values = vload8(bone, dual_quats);
    const DualQuat turn = {values.s0, values.s1, values.s2, values.s3, values.s4, values.s5, values.s6, values.s7};
    if (j == 0) first = turn;
    const float w = weights[4 * vertex + j];
    s.part[j] = dual_quat_add_scaled(dual_quat_zero(), turn, dual_quat_real_dot(first, turn) < 0.0f ? -w : w);
    s.blend = dual_quat_add_scaled(s.blend, s.part[j], 1.0f);
    s.packed_bones |= bone << (8 * j);
  }
  s.position = dual_quat_transform(s.blend, rest);
  return s;
}

// g: the row's gradient by the vertex. record [LC_POSE_RECORD].
LC_FN void write_skinned_row(global float* restrict record, const SkinnedVertex* s, Vec3 g) {
  const DualQuat c = dual_quat_transform_gradient(s->blend, s->rest, s->position, g);
#pragma unroll
  for (int j = 0; j < 4; ++j) {
    const Wrench w = dual_quat_turn_wrench(c, s->part[j]);
    record[6 * j + 0] = w.torque.x;
    record[6 * j + 1] = w.torque.y;
    record[6 * j + 2] = w.torque.z;
    record[6 * j + 3] = w.force.x;
    record[6 * j + 4] = w.force.y;
    record[6 * j + 5] = w.force.z;
  }
  record[LC_POSE_RECORD_BONES] = as_float(s->packed_bones);
}

LC_FN void write_empty_row(global float* restrict record) {
  for (int j = 0; j < LC_POSE_RECORD; ++j) record[j] = 0.0f;
}

#endif
