// Forward kinematics on the device, in double as on the host (src/geometry/skeleton.h): from the unknowns to what the
// row kernels need of a pose. By one work-group of LC_POSE_GROUP.
#ifndef LC_POSE_CHAIN_H
#define LC_POSE_CHAIN_H
#include "pose/layout.h"
#if LC_POSE_TAKES_STEPS
#pragma OPENCL EXTENSION cl_khr_fp64 : enable

// Quaternions are x, y, z, w.
static double4 quat_product(double4 a, double4 b) {
  return (double4)(a.w * b.xyz + b.w * a.xyz + cross(a.xyz, b.xyz), a.w * b.w - dot(a.xyz, b.xyz));
}

static double3 quat_turn(double4 q, double3 v) {
  const double3 t = 2.0 * cross(q.xyz, v);
  return v + q.w * t + cross(q.xyz, t);
}

static double4 quat_about(double3 axis, double angle) {
  return (double4)(sin(0.5 * angle) * axis, cos(0.5 * angle));
}

// Of each bone in the camera's axes and from the root's origin: its turning, then its origin; and how each joint and
// each bone turns by itself. In local memory, [LC_POSE_CHAIN_LOCAL].
typedef struct {
  local double* turn;       // [4*n_bones]
  local double* origin;     // [3*n_bones]
  local double* joint;      // [4*n_dofs]
  local double* bone;       // [4*n_bones]
  local double* keypoints;  // [3*LC_POSE_KEYPOINTS] camera frame, mm
  local double* moved_px;   // [LC_POSE_KEYPOINTS] since the pose before
} Chain;

static Chain chain_in(PoseLayout layout, local double* memory) {
  Chain c;
  c.turn = memory;
  c.origin = c.turn + 4 * layout.n_bones;
  c.joint = c.origin + 3 * layout.n_bones;
  c.bone = c.joint + 4 * layout.n_dofs;
  c.keypoints = c.bone + 4 * layout.n_bones;
  c.moved_px = c.keypoints + 3 * LC_POSE_KEYPOINTS;
  return c;
}

// state: see layout.h. constants [LC_POSE_CHAIN_SIZE] and links: layout.h.
static void pose_chain(PoseLayout layout, global const double* restrict constants, global const int* restrict links,
                       local const double* state, Chain c) {
  const int id = get_local_id(0);
  global const int* dof_bones = links + LC_POSE_LINKS_DOFS(layout);
  global const double* axes = constants + LC_POSE_CHAIN_AXES(layout);
  for (int k = id; k < layout.n_dofs; k += LC_POSE_GROUP)
    vstore4(quat_about(vload3(k, axes), state[LC_POSE_STATE_ANGLES + k]), k, c.joint);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int b = id; b < layout.n_bones; b += LC_POSE_GROUP) {
    double4 q = (double4)(0.0, 0.0, 0.0, 1.0);
    for (int k = 0; k < layout.n_dofs; ++k)
      if (dof_bones[k] == b) q = quat_product(q, vload4(k, c.joint));
    vstore4(q, b, c.bone);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int b = id; b < layout.n_bones; b += LC_POSE_GROUP) {
    double4 q = vload4(b, c.bone);
    double3 p = vload3(0, constants + b * LC_POSE_CHAIN_BONE);
    for (int up = links[b]; up >= 0; up = links[up]) {
      const double4 turn = vload4(up, c.bone);
      q = quat_product(turn, q);
      p = quat_turn(turn, p) + vload3(0, constants + up * LC_POSE_CHAIN_BONE);
    }
    const double4 root = vload4(0, state);
    vstore4(quat_product(root, q), b, c.turn);
    vstore3(quat_turn(root, p), b, c.origin);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

// A keypoint or point of the soles, from the root's origin.
static double3 chain_point(PoseLayout layout, int point, global const double* restrict constants,
                           global const int* restrict links, Chain c) {
  const int bone = links[LC_POSE_LINKS_POINTS(layout) + point];
  if (bone < 0) return (double3)(0.0, 0.0, 0.0);
  return vload3(bone, c.origin) +
         quat_turn(vload4(bone, c.turn), vload3(point, constants + LC_POSE_CHAIN_POINTS(layout)));
}

// Writes the step (layout.h) of a posed chain.
static void write_step(PoseLayout layout, global const double* restrict constants, global const int* restrict links,
                       local const double* state, Chain c, global float* step) {
  const int id = get_local_id(0);
  global const int* dof_bones = links + LC_POSE_LINKS_DOFS(layout);
  const double3 zero = (double3)(0.0, 0.0, 0.0);
  for (int column = id; column < layout.n_columns; column += LC_POSE_GROUP) {
    const int k = column - 6;
    double3 axis = zero, moment = zero;
    if (column < 3) {
      axis = (double3)(column == 0 ? 1.0 : 0.0, column == 1 ? 1.0 : 0.0, column == 2 ? 1.0 : 0.0);
    } else if (column < 6) {
      moment = (double3)(column == 3 ? 1.0 : 0.0, column == 4 ? 1.0 : 0.0, column == 5 ? 1.0 : 0.0);
    } else if (k < layout.n_dofs) {
      const int bone = dof_bones[k], parent = links[bone];
      double4 q = parent < 0 ? vload4(0, state) : vload4(parent, c.turn);
      for (int before = 0; before < k; ++before)
        if (dof_bones[before] == bone) q = quat_product(q, vload4(before, c.joint));
      axis = quat_turn(q, vload3(k, constants + LC_POSE_CHAIN_AXES(layout)));
      moment = cross(vload3(bone, c.origin), axis);
    }
    const double values[6] = {axis.x, axis.y, axis.z, moment.x, moment.y, moment.z};
    for (int i = 0; i < 6; ++i) step[i * layout.n_columns + column] = (float)values[i];
  }
  for (int b = id; b < layout.n_bones; b += LC_POSE_GROUP) {
    global const double* bone_from_rest = constants + b * LC_POSE_CHAIN_BONE + 3;
    const double4 turn = vload4(b, c.turn);
    double4 real = quat_product(turn, vload4(0, bone_from_rest));
    if (real.w < 0.0) real = -real;
    const double3 move = vload3(b, c.origin) + quat_turn(turn, vload3(0, bone_from_rest + 4));
    const double4 dual = quat_product((double4)(0.5 * move, 0.0), real);
    vstore4(convert_float4(real.wxyz), 2 * b, step + LC_POSE_STEP_DUAL_QUATS(layout));
    vstore4(convert_float4(dual.wxyz), 2 * b + 1, step + LC_POSE_STEP_DUAL_QUATS(layout));
  }
  for (int point = id; point < LC_POSE_KEYPOINTS + layout.n_soles; point += LC_POSE_GROUP) {
    const int at = point < LC_POSE_KEYPOINTS ? LC_POSE_STEP_KEYPOINTS(layout) + 3 * point
                                             : LC_POSE_STEP_SOLES(layout) + 3 * (point - LC_POSE_KEYPOINTS);
    vstore3(convert_float3(chain_point(layout, point, constants, links, c)), 0, step + at);
  }
  for (int i = id; i < 3; i += LC_POSE_GROUP) {
    step[LC_POSE_STEP_ROOT(layout) + i] = (float)state[LC_POSE_STATE_ROOT + i];
    step[LC_POSE_STEP_T_PRIME(layout) + i] = (float)state[LC_POSE_STATE_T_PRIME(layout) + i];
  }
  for (int k = id; k < layout.n_dofs; k += LC_POSE_GROUP)
    step[LC_POSE_STEP_ANGLES(layout) + k] = (float)state[LC_POSE_STATE_ANGLES + k];
  barrier(CLK_GLOBAL_MEM_FENCE);
}

// Furthest that a keypoint of the actor went in the picture since the last call; infinite for one that is not before
// the camera.
static double keypoints_moved_px(PoseLayout layout, float4 camera, global const double* restrict constants,
                                 global const int* restrict links, local const double* state, Chain c) {
  for (int k = get_local_id(0); k < LC_POSE_KEYPOINTS; k += LC_POSE_GROUP) {
    const double3 from = vload3(k, c.keypoints);
    const double3 to = chain_point(layout, k, constants, links, c) + vload3(0, state + LC_POSE_STATE_ROOT);
    const double2 way = convert_double2(camera.xy) * (to.xy / to.z - from.xy / from.z);
    const bool seen = links[LC_POSE_LINKS_POINTS(layout) + k] >= 0;
    c.moved_px[k] = !seen ? 0.0 : from.z > 0.0 && to.z > 0.0 ? length(way) : (double)INFINITY;
    vstore3(to, k, c.keypoints);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  double most = 0.0;
  for (int k = 0; k < LC_POSE_KEYPOINTS; ++k) most = most < c.moved_px[k] ? c.moved_px[k] : most;
  return most;
}

#endif
#endif
