// What src/pose/pose_solver.cpp prepares for a solve that starts where the one before ended, on the device: doubt, the
// best t' and which soles rest. By one work-group of LC_POSE_GROUP. tests/pose/round_start_test.cpp holds it to the
// host.
#ifndef LC_POSE_ROUND_START_H
#define LC_POSE_ROUND_START_H
#include "pose/chain.h"
#if LC_POSE_TAKES_STEPS
#include "pose/round_weights.h"

// Detections lie best on the keypoints when moved by so much: best_t_prime() of src/pose/targets.h, of other arrays.
// targets: see layout.h.
static double3 best_t_prime(Chain c, local const float* targets) {
  double3 sum = (double3)(0.0, 0.0, 0.0);
  double total = 0.0;
  for (int k = 0; k < LC_POSE_KEYPOINTS; ++k) {
    local const float* target = targets + LC_POSE_TARGET * k;
    const double root = target[LC_POSE_TARGET_ROOT_3D], weight = root * root;
    sum += weight * (vload3(k, c.keypoints) - convert_double3(vload3(0, target + 2)));
    total += weight;
  }
  return total > 0.0 ? sum / total : sum;
}

// How sure point i of the soles is to rest, as standing() of src/pose/floor.h. soles [3*n_soles] from the origin
// `root`; before: the same a frame ago, camera frame.
static double standing(PoseLayout layout, int i, double3 root, local const int* bones, local const float* soles,
                       local const float* ground, global const float* before) {
  const double3 up = convert_double3(vload3(0, ground)), now = root + convert_double3(vload3(i, soles));
  const double height = dot(up, now) + ground[3];
  double lowest = height;
  for (int k = 0; k < layout.n_soles; ++k)
    if (bones[k] == bones[i]) lowest = fmin(lowest, dot(up, root + convert_double3(vload3(k, soles))) + ground[3]);
  const double3 move = now - convert_double3(vload3(i, before));
  const double3 across = move - now * (dot(now, move) / dot(now, now));
  return stands_by(height, lowest, sqrt(dot(across, across)));
}

// is_first: of the steps; otherwise nothing happens. c, step: of that pose. soles_before [3*n_soles]: mm, camera frame,
// a frame ago. Out: targets' 3D weights, the soles of `ground`, t' in state and step.
static void start_round(bool is_first, PoseLayout layout, PoseStepsArg steps, global const float* soles_before, Chain c,
                        local double* state, local float* step, local float* targets, local float* ground) {
  const int id = get_local_id(0), sole = first_from(LC_POSE_GROUP / 2);
  const bool continues = is_first && steps.continues;
  double root_3d = 0.0;
  for (int i = id; is_first && i < 3 * LC_POSE_KEYPOINTS; i += LC_POSE_GROUP) c.start[i] = c.keypoints[i];
  if (continues && id < LC_POSE_KEYPOINTS) {
    root_3d = targets[LC_POSE_TARGET * id + LC_POSE_TARGET_ROOT_3D];
    if (steps.doubt_mm > 0.0f) {
      const double3 detection = convert_double3(vload3(0, targets + LC_POSE_TARGET * id + 2));
      const double3 r = vload3(id, c.keypoints) - detection - best_t_prime(c, targets);
      root_3d /= sqrt(cauchy_doubt(dot(r, r), steps.doubt_mm));
    }
  }
  if (continues && steps.rests && sole < layout.n_soles)
    ground[LC_POSE_GROUND_STANDS + sole] = (float)standing(layout, sole, vload3(0, state + LC_POSE_STATE_ROOT),
                                                           c.links + LC_POSE_LINKS_POINTS(layout) + LC_POSE_KEYPOINTS,
                                                           step + LC_POSE_STEP_SOLES(layout), ground, soles_before);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (continues && id < LC_POSE_KEYPOINTS) targets[LC_POSE_TARGET * id + LC_POSE_TARGET_ROOT_3D] = (float)root_3d;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (continues && id == 0) {
    const double3 t_prime = best_t_prime(c, targets);
    vstore3(t_prime, 0, state + LC_POSE_STATE_T_PRIME(layout));
    vstore3(convert_float3(t_prime), 0, step + LC_POSE_STEP_T_PRIME(layout));
  }
  barrier(CLK_LOCAL_MEM_FENCE);
}

#endif
#endif
