// What src/pose/pose_solver.cpp prepares for a solve that starts where the one before ended, on the device: doubt, the
// best t' and which soles rest. By one work-group of LC_POSE_GROUP. tests/pose/round_start_test.cpp holds it to the
// host.
#ifndef LC_POSE_ROUND_START_H
#define LC_POSE_ROUND_START_H
#include "pose/chain.h"
#if LC_POSE_TAKES_STEPS
#include "pose/round_weights.h"

// Of keypoint k, by a work-item each: how far it is from its detection, and the detection's weight. targets: see
// layout.h. parts: [4*LC_POSE_KEYPOINTS].
static void write_t_prime_part(int k, Chain c, local const float* targets, local double* parts) {
  local const float* target = targets + LC_POSE_TARGET * k;
  const double root = target[LC_POSE_TARGET_ROOT_3D];
  const double3 move = vload3(k, c.keypoints) - convert_double3(vload3(0, target + 2));
  vstore4((double4)(move, root * root), k, parts);
}

// Detections lie best on the keypoints when moved by so much: best_t_prime() of src/pose/targets.h.
static double3 best_t_prime(local const double* parts) {
  double3 sum = (double3)(0.0, 0.0, 0.0);
  double total = 0.0;
#pragma unroll 4
  for (int k = 0; k < LC_POSE_KEYPOINTS; ++k) {
    const double4 part = vload4(k, parts);
    sum = fma((double3)(part.w), part.xyz, sum);
    total += part.w;
  }
  return total > 0.0 ? sum / total : sum;
}

// How sure point i of the soles is to rest, as standing() of src/pose/floor.h: first how high it is and how far it
// moved across the line of sight, then the rest, when the heights of all points are there. soles [3*n_soles] from the
// origin `root`; before: where the point was a frame ago, camera frame.
static double2 height_and_move(int i, double3 root, local const float* soles, local const float* ground,
                               float3 before) {
  const double3 up = convert_double3(vload3(0, ground)), now = root + convert_double3(vload3(i, soles));
  const double3 move = now - convert_double3(before);
  const double3 across = move - now * (dot(now, move) / dot(now, now));
  return (double2)(dot(up, now) + ground[3], sqrt(dot(across, across)));
}

static double standing(PoseLayout layout, double least, int i, local const int* bones, local const double* heights,
                       double2 own) {
  double lowest = own.x;
  for (int k = 0; k < layout.n_soles; ++k)
    if (bones[k] == bones[i]) lowest = fmin(lowest, heights[k]);
  return fmax(least, stands_by(own.x, lowest, own.y));
}

// continues: see PoseStepsArg; otherwise nothing happens. c, step: of the pose to start from. soles_before [3*n_soles]:
// mm, camera frame, a frame ago. memory: 4 * LC_POSE_KEYPOINTS + n_soles. Out: targets' 3D weights, the soles of
// `ground`, t' in state and step.
static void start_round(bool continues, PoseLayout layout, PoseStepsArg steps, global const float* soles_before,
                        Chain c, local double* memory, local double* state, local float* step, local float* targets,
                        local float* ground) {
  const int id = get_local_id(0), sole = first_from(LC_POSE_GROUP / 2);
  const bool has_sole = continues && steps.rests && sole < layout.n_soles;
  local double* parts = memory;
  local double* heights = memory + 4 * LC_POSE_KEYPOINTS;
  double root_3d = 0.0;
  double2 own = 0.0;
  if (continues && id < LC_POSE_KEYPOINTS) write_t_prime_part(id, c, targets, parts);
  if (has_sole) {
    own = height_and_move(sole, vload3(0, state + LC_POSE_STATE_ROOT), step + LC_POSE_STEP_SOLES(layout), ground,
                          vload3(sole, soles_before));
    heights[sole] = own.x;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (continues && id < LC_POSE_KEYPOINTS) {
    root_3d = targets[LC_POSE_TARGET * id + LC_POSE_TARGET_ROOT_3D];
    if (steps.doubt_mm > 0.0f) {
      const double3 detection = convert_double3(vload3(0, targets + LC_POSE_TARGET * id + 2));
      const double3 r = vload3(id, c.keypoints) - detection - best_t_prime(parts);
      root_3d /= sqrt(cauchy_doubt(dot(r, r), steps.doubt_mm));
    }
  }
  if (has_sole)
    ground[LC_POSE_GROUND_STANDS + sole] = (float)standing(
        layout, steps.least_stands, sole, c.links + LC_POSE_LINKS_POINTS(layout) + LC_POSE_KEYPOINTS, heights, own);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (continues && id < LC_POSE_KEYPOINTS) {
    targets[LC_POSE_TARGET * id + LC_POSE_TARGET_ROOT_3D] = (float)root_3d;
    write_t_prime_part(id, c, targets, parts);
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  if (continues && id == 0) {
    const double3 t_prime = best_t_prime(parts);
    vstore3(t_prime, 0, state + LC_POSE_STATE_T_PRIME(layout));
    vstore3(convert_float3(t_prime), 0, step + LC_POSE_STEP_T_PRIME(layout));
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

#endif
#endif
