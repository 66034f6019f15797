// Forward kinematics on the device, in double as on the host (src/geometry/skeleton.h): from the unknowns to what the
// row kernels need of a pose. By one work-group of LC_POSE_GROUP, all of whose memory is local.
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
  double cosine;
  const double sine = sincos(0.5 * angle, &cosine);
  return (double4)(sine * axis, cosine);
}

// The largest of values that are not negative, [n], n a multiple of 4.
static double largest_of(int n, local const double* values) {
  double4 most = 0.0;
#pragma unroll 4
  for (int k = 0; k < n; k += 4) {
    const double4 v = vload4(0, values + k);
    most = most < v ? v : most;
  }
  return fmax(fmax(most.x, most.y), fmax(most.z, most.w));
}

// Of each bone in the camera's axes and from the root's origin: its turning, then its origin; how each joint turns by
// itself, and what the joints of its bone before it do; and how each bone turns by itself. In local memory,
// [LC_POSE_CHAIN_LOCAL].
typedef struct {
  local double* constants;  // see layout.h
  local int* links;         // likewise
  local double* turn;       // [4*n_bones]
  local double* origin;     // [3*n_bones]
  local double* joint;      // [4*n_dofs]
  local double* before;     // [4*n_dofs]
  local double* bone;       // [4*n_bones]
  local double* keypoints;  // [3*LC_POSE_KEYPOINTS] camera frame, mm
  local double* start;      // [3*LC_POSE_KEYPOINTS] likewise, of the first pose
  local double* moved_px;   // [LC_POSE_MOVED] since the pose before
} Chain;

// Without constants and links. For use after a barrier.
static Chain chain_in(PoseLayout layout, local double* memory) {
  Chain c;
  c.constants = memory;
  c.turn = c.constants + LC_POSE_CHAIN_SIZE(layout);
  c.origin = c.turn + 4 * layout.n_bones;
  c.joint = c.origin + 3 * layout.n_bones;
  c.before = c.joint + 4 * layout.n_dofs;
  c.bone = c.before + 4 * layout.n_dofs;
  c.keypoints = c.bone + 4 * layout.n_bones;
  c.start = c.keypoints + 3 * LC_POSE_KEYPOINTS;
  c.moved_px = c.start + 3 * LC_POSE_KEYPOINTS;
  c.links = (local int*)(c.moved_px + LC_POSE_MOVED);
  for (int i = LC_POSE_KEYPOINTS + (int)get_local_id(0); i < LC_POSE_MOVED; i += LC_POSE_GROUP) c.moved_px[i] = 0.0;
  return c;
}

// state: see layout.h. needed: whether anything is done.
static void pose_chain(bool needed, PoseLayout layout, local const double* state, Chain c) {
  const int id = get_local_id(0);
  local const int* first_joint = c.links + LC_POSE_LINKS_FIRST(layout);
  local const int* next_joint = c.links + LC_POSE_LINKS_NEXT(layout);
  local const double* axes = c.constants + LC_POSE_CHAIN_AXES(layout);
  for (int k = id; needed && k < layout.n_dofs; k += LC_POSE_GROUP)
    vstore4(quat_about(vload3(k, axes), state[LC_POSE_STATE_ANGLES + k]), k, c.joint);
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int b = id; needed && b < layout.n_bones; b += LC_POSE_GROUP) {
    double4 q = (double4)(0.0, 0.0, 0.0, 1.0);
    for (int k = first_joint[b]; k < layout.n_dofs; k = next_joint[k]) {
      vstore4(q, k, c.before);
      q = quat_product(q, vload4(k, c.joint));
    }
    vstore4(q, b, c.bone);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  for (int b = id; needed && b < layout.n_bones; b += LC_POSE_GROUP) {
    double4 q = vload4(b, c.bone);
    double3 p = vload3(0, c.constants + b * LC_POSE_CHAIN_BONE);
    for (int up = c.links[b]; up >= 0; up = c.links[up]) {
      const double4 turn = vload4(up, c.bone);
      q = quat_product(turn, q);
      p = quat_turn(turn, p) + vload3(0, c.constants + up * LC_POSE_CHAIN_BONE);
    }
    const double4 root = vload4(0, state);
    vstore4(quat_product(root, q), b, c.turn);
    vstore3(quat_turn(root, p), b, c.origin);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

// A keypoint or point of the soles, from the root's origin.
static double3 chain_point(PoseLayout layout, int point, Chain c) {
  const int bone = c.links[LC_POSE_LINKS_POINTS(layout) + point];
  if (bone < 0) return (double3)(0.0, 0.0, 0.0);
  return vload3(bone, c.origin) +
         quat_turn(vload4(bone, c.turn), vload3(point, c.constants + LC_POSE_CHAIN_POINTS(layout)));
}

// The first of a work-item's numbers when work begins at work-item `begin`: different work is for different ones.
static int first_from(int begin) {
  return (get_local_id(0) + LC_POSE_GROUP - begin) % LC_POSE_GROUP;
}

static void write_columns(PoseLayout layout, local const double* state, Chain c, local float* step) {
  local const int* dof_bones = c.links + LC_POSE_LINKS_DOFS(layout);
  const double3 zero = (double3)(0.0, 0.0, 0.0);
  for (int column = get_local_id(0); column < layout.n_columns; column += LC_POSE_GROUP) {
    const int k = column - 6;
    double3 axis = zero, moment = zero;
    if (column < 3) {
      axis = (double3)(column == 0 ? 1.0 : 0.0, column == 1 ? 1.0 : 0.0, column == 2 ? 1.0 : 0.0);
    } else if (column < 6) {
      moment = (double3)(column == 3 ? 1.0 : 0.0, column == 4 ? 1.0 : 0.0, column == 5 ? 1.0 : 0.0);
    } else if (k < layout.n_dofs) {
      const int bone = dof_bones[k], parent = c.links[bone];
      const double4 above = parent < 0 ? vload4(0, state) : vload4(parent, c.turn);
      axis = quat_turn(above, quat_turn(vload4(k, c.before), vload3(k, c.constants + LC_POSE_CHAIN_AXES(layout))));
      moment = cross(vload3(bone, c.origin), axis);
    }
    const double values[6] = {axis.x, axis.y, axis.z, moment.x, moment.y, moment.z};
#pragma unroll
    for (int i = 0; i < 6; ++i) step[i * layout.n_columns + column] = (float)values[i];
  }
}

// The motion of bone b from rest, moved on by `by`: a dual quaternion.
static float8 bone_motion(int b, double3 by, Chain c) {
  local const double* bone_from_rest = c.constants + b * LC_POSE_CHAIN_BONE + 3;
  const double4 turn = vload4(b, c.turn);
  double4 real = quat_product(turn, vload4(0, bone_from_rest));
  if (real.w < 0.0) real = -real;
  const double3 move = by + vload3(b, c.origin) + quat_turn(turn, vload3(0, bone_from_rest + 4));
  const double4 dual = quat_product((double4)(0.5 * move, 0.0), real);
  return (float8)(convert_float4(real.wxyz), convert_float4(dual.wxyz));
}

static void write_bones(PoseLayout layout, Chain c, local float* step) {
  for (int b = first_from(LC_POSE_GROUP / 4); b < layout.n_bones; b += LC_POSE_GROUP) {
    const float8 motion = bone_motion(b, (double3)(0.0, 0.0, 0.0), c);
    vstore4(motion.lo, 2 * b, step + LC_POSE_STEP_DUAL_QUATS(layout));
    vstore4(motion.hi, 2 * b + 1, step + LC_POSE_STEP_DUAL_QUATS(layout));
  }
}

// How far keypoint k goes in the picture; infinite where it is not before the camera, 0 where the actor has none.
static double way_px(PoseLayout layout, float4 camera, int k, Chain c, double3 from, double3 to) {
  const double2 way = convert_double2(camera.xy) * (to.xy / to.z - from.xy / from.z);
  const bool seen = c.links[LC_POSE_LINKS_POINTS(layout) + k] >= 0;
  return !seen ? 0.0 : from.z > 0.0 && to.z > 0.0 ? sqrt(dot(way, way)) : (double)INFINITY;
}

// And how far each keypoint of the actor went in the picture since the last call.
static void write_points(PoseLayout layout, float4 camera, local const double* state, Chain c, local float* step) {
  for (int k = first_from(LC_POSE_GROUP / 2); k < LC_POSE_KEYPOINTS + layout.n_soles; k += LC_POSE_GROUP) {
    const double3 point = chain_point(layout, k, c);
    const bool is_keypoint = k < LC_POSE_KEYPOINTS;
    const int at =
        is_keypoint ? LC_POSE_STEP_KEYPOINTS(layout) + 3 * k : LC_POSE_STEP_SOLES(layout) + 3 * (k - LC_POSE_KEYPOINTS);
    vstore3(convert_float3(point), 0, step + at);
    if (!is_keypoint) continue;
    const double3 from = vload3(k, c.keypoints), to = point + vload3(0, state + LC_POSE_STATE_ROOT);
    c.moved_px[k] = way_px(layout, camera, k, c, from, to);
    vstore3(to, k, c.keypoints);
  }
}

// Writes the step (layout.h) of a posed chain, if needed. Returns how far the keypoint went that went furthest, see
// write_points.
static double write_step(bool needed, PoseLayout layout, float4 camera, local const double* state, Chain c,
                         local float* step) {
  if (needed) {
    write_columns(layout, state, c, step);
    write_bones(layout, c, step);
    write_points(layout, camera, state, c, step);
  }
  const int i = first_from(LC_POSE_GROUP - 64);
  for (int k = i; needed && k < layout.n_dofs; k += LC_POSE_GROUP)
    step[LC_POSE_STEP_ANGLES(layout) + k] = (float)state[LC_POSE_STATE_ANGLES + k];
  if (needed && i < 3) {
    step[LC_POSE_STEP_ROOT(layout) + i] = (float)state[LC_POSE_STATE_ROOT + i];
    step[LC_POSE_STEP_T_PRIME(layout) + i] = (float)state[LC_POSE_STATE_T_PRIME(layout) + i];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  return largest_of(LC_POSE_MOVED, c.moved_px);
}

#endif
#endif
