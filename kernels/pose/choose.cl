// Which contour vertices, matches and vertices of skin a solve has rows for, chosen on GPUs from what the picture's
// kernels left there. Elsewhere the host reads all that and chooses (src/pose/row_inputs.cpp), the same to the bit. A
// work-group for each kind; its work-items have a run of vertices each and choose by sums over those before.
#if !LC_CPU && defined(cl_khr_fp64)
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#include "match/layout.h"
#include "pose/layout.h"
#include "pose/thinning.h"
#include "shared/seen_weight.h"

#define GROUP LC_POSE_CHOICE_GROUP
#define CONTOUR 0
#define MATCHES 1
#define SKIN 2
#define PER_LIMB (GROUP / LC_SKIN_LIMBS)  // work-items

// Of one kind; see the kernel.
typedef struct {
  int kind;
  PoseChoice choice;
  global const int* contour;
  global const float* matches;
  global const float* skin;
  global const int* skin_vertices;
  global const int* skin_limbs;
  local const double* limb_px;  // of a weight of 1, of each limb
  global const float* lights;
  global const double* numbers;
} Seen;

// px^2 (LC_EXACT) that a limb shows by every PER_LIMB-th vertex from `first` on.
static long px_of_limb(const Seen* s, int limb, int first) {
  long sum = 0;
  for (int i = first; i < s->choice.n[SKIN]; i += PER_LIMB) {
    const float px = s->skin[LC_SKIN * i + LC_SKIN_PX];
    if (s->skin_limbs[i] / 2 == limb && px > 0.0f) sum += LC_EXACT(px);
  }
  return sum;
}

// Sums over the work-items before; all: over all of them. sums: [GROUP].
static long2 sums_before(long2 value, local long2* sums, long2* all) {
  const int id = get_local_id(0);
  barrier(CLK_LOCAL_MEM_FENCE);
  sums[id] = value;
  for (int by = 1; by < GROUP; by *= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    const long2 before = id >= by ? sums[id - by] : (long2)(0);
    barrier(CLK_LOCAL_MEM_FENCE);
    sums[id] += before;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  *all = sums[GROUP - 1];
  return sums[id] - value;
}

// Of vertex i, 0 where it is not seen.
static float weight_of(const Seen* s, int i) {
  if (s->kind == CONTOUR) return s->contour[i] ? 1.0f : 0.0f;
  if (s->kind == MATCHES) {
    const float px = s->matches[LC_MATCH * i + LC_MATCH_WEIGHT_PX];
    return px > 0.0f ? seen_weight(px, s->numbers[LC_POSE_CHOICE_MATCH_AREA]) : 0.0f;
  }
  const float px = s->skin[LC_SKIN * i + LC_SKIN_PX];
  const int limb = s->skin_limbs[i];
  const int is_known = as_int(s->lights[LC_POSE_LIGHT * (limb % 2)]);
  return px > 0.0f && is_known ? seen_weight(px, s->limb_px[limb / 2]) : 0.0f;
}

// px^2 by which a vertex falls short of a perfect match.
static long missed_px(global const float* match) {
  return LC_EXACT(match[LC_MATCH_SEEN_PX]) - LC_EXACT(fmax(match[LC_MATCH_WEIGHT_PX], 0.0f));
}

// Vertex i as the place-th of its kind, and the weight that it stands for, where write_chosen() looks.
static void note_chosen(const Seen* s, PoseInputs at, int i, int place, float weight, global float* inputs) {
  if (s->kind == CONTOUR) {
    inputs[at.contour_vertices + place] = as_float(i);
  } else if (s->kind == MATCHES) {
    inputs[at.match_vertices + place] = as_float(i);
    inputs[at.match_targets + LC_POSE_MATCH * place] = weight;
  } else {
    inputs[at.shaded_vertices + place] = as_float(i);
    inputs[at.shaded_targets + LC_POSE_SHADED * place] = weight;
  }
}

// What rows are made of (layout.h), of what was noted at a place: other work-items than those that choose, so that all
// places are written at once.
static void write_chosen(const Seen* s, PoseInputs at, int place, global float* inputs) {
  if (s->kind == CONTOUR) return;
  if (s->kind == MATCHES) {
    global float* to = inputs + at.match_targets + LC_POSE_MATCH * place;
    global const float* match = s->matches + LC_MATCH * as_int(inputs[at.match_vertices + place]);
    const float root = row_root(s->numbers[s->kind], *to);
    for (int k = 0; k < LC_POSE_MATCH; ++k) to[k] = k < 2 ? match[k] : root * match[k];
    return;
  }
  const int i = as_int(inputs[at.shaded_vertices + place]), light = s->skin_limbs[i] % 2;
  global float* to = inputs + at.shaded_targets + LC_POSE_SHADED * place;
  const float root = row_root(s->numbers[s->kind], *to);
  inputs[at.shaded_vertices + place] = as_float(s->skin_vertices[i]);
  for (int k = 0; k < LC_POSE_LIGHT - 1; ++k) to[k] = s->lights[LC_POSE_LIGHT * light + 1 + k];
  to[9] = in_deviations(s->skin[LC_SKIN * i + LC_SKIN_BRIGHTNESS], s->numbers[LC_POSE_CHOICE_DEVIATIONS + light]);
  to[10] = root;
}

// A run of vertices that are neighbours; the runs of all work-items in turn are all of them.
typedef struct {
  int begin, end;
} Run;

// How many of a run are seen, and their weights (LC_EXACT). weights: see the kernel.
static long2 seen_in(Run run, local const float* weights) {
  long2 sum = 0;
  for (int i = run.begin; i < run.end; ++i)
    if (weights[i] > 0.0f) sum += (long2)(1, LC_EXACT(weights[i]));
  return sum;
}

// Which of the vertices of a run are chosen, a bit each. before, all: see seen_in.
static uint chosen_in(const Seen* s, Run run, local const float* weights, long2 before, long2 all, Shares shares) {
  const int most = s->choice.most[s->kind];
  double n_before = shares_until(before.y, shares);
  uint chosen = 0;
  for (int i = run.begin; i < run.end; ++i) {
    if (!(weights[i] > 0.0f)) continue;
    int is_chosen = 1;
    if (all.x > most && s->kind == CONTOUR) {
      is_chosen = is_spread(before.x, all.x, most);
    } else if (all.x > most) {
      const double n_until = shares_until(before.y + LC_EXACT(weights[i]), shares);
      is_chosen = n_until - n_before >= 1.0;
      n_before = n_until;
    }
    before += (long2)(1, LC_EXACT(weights[i]));
    chosen |= (uint)is_chosen << (i - run.begin);
  }
  return chosen;
}

// The weight that a chosen vertex stands for. before: of it.
static float weight_for(const Seen* s, float weight, long2 before, long2 all, Shares shares) {
  if (all.x <= s->choice.most[s->kind]) return weight;
  const double n_shares = shares_until(before.y + LC_EXACT(weight), shares) - shares_until(before.y, shares);
  return (float)(n_shares * shares.each * LC_EXACT_UNIT);
}

// contour [n] 1 for contour vertices, matches [LC_MATCH*n], skin [LC_SKIN*n], of as many as `choice` says;
// skin_vertices [n]; skin_limbs [n]: twice the limb and 1 for the second light. inputs: what is chosen by, and out what
// is chosen, see layout.h. moved, least_moved_px: see PoseStepsArg. sums: [GROUP]; limb_px: [LC_SKIN_LIMBS]; weights:
// [LC_POSE_CHOICE_RUN].
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void pose_choose(
    PoseInputs at, PoseChoice choice, float least_moved_px, global const float* restrict moved,
    global const int* restrict contour, global const float* restrict matches, global const float* restrict skin,
    global const int* restrict skin_vertices, global const int* restrict skin_limbs, global float* inputs,
    local long2* sums, local double* limb_px, local float* weights) {
  const int id = get_local_id(0), kind = get_group_id(0), n = choice.n[kind];
  const Seen seen = {kind,
                     choice,
                     contour,
                     matches,
                     skin,
                     skin_vertices,
                     skin_limbs,
                     limb_px,
                     inputs + at.lights,
                     (global const double*)(inputs + at.choice)};
  if (moved[0] < least_moved_px) return;
  if (kind == SKIN) sums[id].x = px_of_limb(&seen, id / PER_LIMB, id % PER_LIMB);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (kind == SKIN && id < LC_SKIN_LIMBS) {
    long px = 0;
    for (int k = 0; k < PER_LIMB; ++k) px += sums[PER_LIMB * id + k].x;
    limb_px[id] = limb_px_of_one(px, choice.limb_area_px);
  }
  barrier(CLK_LOCAL_MEM_FENCE);

  // As many at a time as `weights` holds: what is seen of all, then what is chosen.
  long missed = 0;  // px^2
  long2 before = 0, all = 0, chosen = 0, added;
  Shares shares = {0, 0.0, 0.0};  // see thinning.h
  for (int step = 0; step < 2; ++step) {
    long2 passed = 0;
    for (int first = 0; first < n; first += LC_POSE_CHOICE_RUN) {
      const int n_here = min(n - first, LC_POSE_CHOICE_RUN), each = (n_here + GROUP - 1) / GROUP;
      const Run run = {min(id * each, n_here), min(id * each + each, n_here)};
      if (step == 0 || n > LC_POSE_CHOICE_RUN) {
#pragma unroll
        for (int k = 0; k < LC_POSE_CHOICE_RUN / GROUP; ++k) {
          const int i = id + k * GROUP;
          if (i >= n_here) continue;
          weights[i] = weight_of(&seen, first + i);
          if (step == 0 && kind == MATCHES) missed += missed_px(matches + LC_MATCH * (first + i));
        }
        barrier(CLK_LOCAL_MEM_FENCE);
        before = passed + sums_before(seen_in(run, weights), sums, &added);
        passed += added;
      }
      if (step == 0) continue;
      const uint bits = chosen_in(&seen, run, weights, before, all, shares);
      const long2 told = sums_before((long2)(popcount(bits), first == 0 ? missed : 0), sums, &added);
      int place = (int)(chosen.x + told.x);
      chosen += added;
      long2 until = before;
      for (int i = run.begin; i < run.end; ++i) {
        if ((bits >> (i - run.begin) & 1) && place < choice.most[kind])  // sums that overflow may choose more
          note_chosen(&seen, at, first + i, place++, weight_for(&seen, weights[i], until, all, shares), inputs);
        if (weights[i] > 0.0f) until += (long2)(1, LC_EXACT(weights[i]));
      }
      barrier(CLK_LOCAL_MEM_FENCE);
    }
    if (step > 0) break;
    all = passed;
    shares = shares_of(all.y, choice.most[kind]);
  }
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (int place = id; place < min((int)chosen.x, choice.most[kind]); place += GROUP)
    write_chosen(&seen, at, place, inputs);
  if (id > 0) return;
  chosen.x = min(chosen.x, (long)choice.most[kind]);
  inputs[at.counts + kind] = as_float((int)chosen.x);
  if (kind == CONTOUR)
    inputs[at.counts + LC_POSE_COUNT_CONTOUR_ROOT] =
        contour_row_root(seen.numbers[CONTOUR], (double)all.x, (double)chosen.x);
  if (kind == MATCHES)
    inputs[at.counts + LC_POSE_COUNT_MISSED] =
        (float)((double)chosen.y * LC_EXACT_UNIT / seen.numbers[LC_POSE_CHOICE_MATCH_AREA]);
}
#endif
