// Which contour vertices, matches and vertices of skin a solve has rows for, chosen on GPUs from what the picture's
// kernels left there. Elsewhere the host reads all that and chooses (src/pose/row_inputs.cpp), the same to the bit. A
// work-group for each kind; its work-items have a run of vertices each and choose by sums over those before.
#if !LC_CPU && defined(cl_khr_fp64)
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#include "match/layout.h"
#include "pose/layout.h"
#include "pose/thinning.h"

#define GROUP LC_POSE_CHOICE_GROUP
#define CONTOUR 0
#define MATCHES 1
#define SKIN 2
#define PER_LIMB (GROUP / LC_POSE_LIMBS)  // work-items

// Of one kind; see the kernel.
typedef struct {
  int kind;
  PoseChoice choice;
  global const int* contour;
  global const float* matches;
  global const float* skin;
  global const int* skin_vertices;
  global const int* skin_limbs;
  local const double* limb_px;  // that each limb shows, but at least choice.limb_area_px
  global const float* lights;
  global const double* numbers;
} Seen;

// px^2 (LC_EXACT) that a limb shows by every PER_LIMB-th vertex from `first` on.
static long px_of_limb(const Seen* s, int limb, int first) {
  long sum = 0;
  for (int i = first; i < s->choice.n[SKIN]; i += PER_LIMB) {
    const float px = s->skin[LC_SKIN * i + 4];
    if (s->skin_limbs[i] / 2 == limb && px > 0.0f) sum += LC_EXACT(px);
  }
  return sum;
}

// The sum of the work-items before; all: of all. sums: [GROUP].
static long sum_before(long value, local long* sums, long* all) {
  const int id = get_local_id(0);
  barrier(CLK_LOCAL_MEM_FENCE);
  sums[id] = value;
  for (int by = 1; by < GROUP; by *= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    const long before = id >= by ? sums[id - by] : 0;
    barrier(CLK_LOCAL_MEM_FENCE);
    sums[id] += before;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  *all = sums[GROUP - 1];
  return sums[id] - value;
}

// Of vertex i, 0 where it is not seen. Divided in double, and by a double: floats, or doubles that were floats, are
// divided less exactly than on the host.
static float weight_of(const Seen* s, int i) {
  if (s->kind == CONTOUR) return s->contour[i] ? 1.0f : 0.0f;
  if (s->kind == MATCHES) {
    const float px = s->matches[LC_MATCH * i + 5];
    return px > 0.0f ? (float)((double)px / s->numbers[LC_POSE_CHOICE_MATCH_AREA]) : 0.0f;
  }
  const float px = s->skin[LC_SKIN * i + 4];
  const int limb = s->skin_limbs[i];
  const int is_known = as_int(s->lights[LC_POSE_LIGHT * (limb % 2)]);
  return px > 0.0f && is_known ? (float)((double)px / s->limb_px[limb / 2]) : 0.0f;
}

// What rows are made of (layout.h): vertex i as the place-th of its kind.
static void write_chosen(const Seen* s, PoseInputs at, int i, int place, float weight, global float* inputs) {
  if (s->kind == CONTOUR) {
    inputs[at.contour_vertices + place] = as_float(i);
    return;
  }
  const float root = (float)sqrt(s->numbers[s->kind] * (double)weight);
  if (s->kind == MATCHES) {
    global const float* match = s->matches + LC_MATCH * i;
    global float* to = inputs + at.match_targets + LC_POSE_MATCH * place;
    inputs[at.match_vertices + place] = as_float(i);
    for (int k = 0; k < LC_POSE_MATCH; ++k) to[k] = k < 2 ? match[k] : root * match[k];
    return;
  }
  const int light = s->skin_limbs[i] % 2;
  global float* to = inputs + at.shaded_targets + LC_POSE_SHADED * place;
  inputs[at.shaded_vertices + place] = as_float(s->skin_vertices[i]);
  for (int k = 0; k < LC_POSE_LIGHT - 1; ++k) to[k] = s->lights[LC_POSE_LIGHT * light + 1 + k];
  to[9] = (float)((double)s->skin[LC_SKIN * i + 3] / s->numbers[LC_POSE_CHOICE_DEVIATIONS + light]);
  to[10] = root;
}

// Of what is seen.
typedef struct {
  long place, sum;  // how many there are, and their weights (LC_EXACT), before a work-item's
  long n, total;    // in all
} Before;

// Chooses among the vertices `first` + begin..end-1, whose weights these are from `first` on. Returns how many; writes
// them from `place` on unless that is negative.
static int choose(const Seen* s, PoseInputs at, int first, int begin, int end, local const float* weights, Before b,
                  int place, global float* inputs) {
  const int most = s->choice.most[s->kind];
  const double share = (double)b.total / (double)most;
  int n = 0;
  for (int i = begin; i < end; ++i) {
    float weight = weights[i];
    if (!(weight > 0.0f)) continue;
    const long exact = LC_EXACT(weight);
    int is_chosen = 1;
    if (b.n > most && s->kind == CONTOUR) {
      is_chosen = is_spread(b.place, b.n, most);
    } else if (b.n > most) {
      const double n_shares = shares_until(b.sum + exact, share) - shares_until(b.sum, share);
      is_chosen = n_shares >= 1.0;
      weight = (float)(n_shares * share * LC_EXACT_UNIT);
    }
    ++b.place;
    b.sum += exact;
    if (!is_chosen) continue;
    if (place >= 0) write_chosen(s, at, first + i, place + n, weight, inputs);
    ++n;
  }
  return n;
}

// contour [n] 1 for contour vertices, matches [LC_MATCH*n], skin [LC_SKIN*n], of as many as `choice` says;
// skin_vertices [n]; skin_limbs [n]: twice the limb and 1 for the second light. inputs: what is chosen by, and out what
// is chosen, see layout.h. sums: [GROUP]; limb_px: [LC_POSE_LIMBS]; weights: [LC_POSE_CHOICE_RUN].
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void pose_choose(
    PoseInputs at, PoseChoice choice, global const int* restrict contour, global const float* restrict matches,
    global const float* restrict skin, global const int* restrict skin_vertices, global const int* restrict skin_limbs,
    global float* inputs, local long* sums, local double* limb_px, local float* weights) {
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
  if (kind == SKIN) sums[id] = px_of_limb(&seen, id / PER_LIMB, id % PER_LIMB);
  barrier(CLK_LOCAL_MEM_FENCE);
  if (id < LC_POSE_LIMBS) {
    long px = 0;
    for (int k = 0; k < PER_LIMB; ++k) px += sums[PER_LIMB * id + k];
    limb_px[id] = fmax((double)px * LC_EXACT_UNIT, (double)choice.limb_area_px);
  }
  barrier(CLK_LOCAL_MEM_FENCE);

  Before all = {0, 0, 0, 0};
  long missed = 0;  // px^2
#pragma unroll 4
  for (int i = id; i < n; i += GROUP) {
    const float weight = weight_of(&seen, i);
    if (i < LC_POSE_CHOICE_RUN) weights[i] = weight;
    if (kind == MATCHES)
      missed += LC_EXACT(matches[LC_MATCH * i + 7]) - LC_EXACT(fmax(matches[LC_MATCH * i + 5], 0.0f));
    if (weight > 0.0f) ++all.n;
    all.total += LC_EXACT(weight);
  }
  sum_before(all.n, sums, &all.n);
  sum_before(all.total, sums, &all.total);
  sum_before(missed, sums, &missed);

  int n_chosen = 0;
  for (int first = 0; first < n; first += LC_POSE_CHOICE_RUN) {
    const int n_here = min(n - first, LC_POSE_CHOICE_RUN), run = (n_here + GROUP - 1) / GROUP;
    const int begin = min(id * run, n_here), end = min(begin + run, n_here);
    for (int i = id; first > 0 && i < n_here; i += GROUP) weights[i] = weight_of(&seen, first + i);
    barrier(CLK_LOCAL_MEM_FENCE);
    Before before = all;
    long places = 0, sum = 0, added;
    for (int i = begin; i < end; ++i) {
      if (weights[i] > 0.0f) ++places;
      sum += LC_EXACT(weights[i]);
    }
    before.place += sum_before(places, sums, &added);
    all.place += added;
    before.sum += sum_before(sum, sums, &added);
    all.sum += added;
    const int n_mine = choose(&seen, at, first, begin, end, weights, before, -1, inputs);
    const int place = n_chosen + (int)sum_before(n_mine, sums, &added);
    n_chosen += (int)added;
    choose(&seen, at, first, begin, end, weights, before, place, inputs);
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  if (id > 0) return;
  inputs[at.counts + kind] = as_float(n_chosen);
  if (kind == CONTOUR)
    inputs[at.counts + LC_POSE_COUNT_CONTOUR_ROOT] =
        n_chosen > 0 ? (float)sqrt(seen.numbers[CONTOUR] * (double)all.n / (double)n_chosen) : 0.0f;
  if (kind == MATCHES)
    inputs[at.counts + LC_POSE_COUNT_MISSED] =
        (float)((double)missed * LC_EXACT_UNIT / seen.numbers[LC_POSE_CHOICE_MATCH_AREA]);
}
#endif
