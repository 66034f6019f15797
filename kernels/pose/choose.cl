// Which contour vertices, matches and vertices of skin a solve has rows for, chosen on GPUs from what the picture's
// kernels left there. Elsewhere the host reads all that and chooses (src/pose/row_inputs.cpp), the same to the bit. Of
// each kind the vertices are dealt out to several work-groups, a slice each, and their work-items have a run of
// neighbours each; they choose by sums over those before, for which the groups of a kind wait for each other.
#if !LC_CPU && defined(cl_khr_fp64)
#pragma OPENCL EXTENSION cl_khr_fp64 : enable
#include "match/layout.h"
#include "pose/layout.h"
#include "pose/thinning.h"
#include "shared/all_arrived.h"
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

// The slices of a kind, and what they tell each other.
typedef struct {
  int n, own, n_waits, together;
  global long2* told;  // [n]
  global long* limbs;  // [LC_SKIN_LIMBS*n]
  volatile global int* state;
  local int* given_up;
} Slices;

// Returns once all slices have come here; after a wait that was given up, which the kernel for the steps tells, what
// the others tell may be anything.
static void wait_for_slices(Slices* s) {
  ++s->n_waits;
  if (s->n > 1) s->together = all_arrived(s->together, s->state, s->n_waits * s->n, s->given_up);
}

// What the slices before have, of what each has; all: all of them.
static long2 of_slices_before(long2 value, Slices* s, local long2* sums, long2* all) {
  const int id = get_local_id(0);
  if (id == 0) s->told[s->own] = value;
  wait_for_slices(s);
  barrier(CLK_GLOBAL_MEM_FENCE);
  sums_before(id < s->n ? s->told[id] : (long2)(0), sums, all);
  s->told += s->n;  // the next time elsewhere: some may still read here
  return s->own > 0 ? sums[s->own - 1] : (long2)(0);
}

// The sum over the PER_LIMB work-items of each limb, for the first LC_SKIN_LIMBS.
static long of_limb(long value, local long2* sums) {
  const int id = get_local_id(0);
  barrier(CLK_LOCAL_MEM_FENCE);
  sums[id].x = value;
  barrier(CLK_LOCAL_MEM_FENCE);
  long sum = 0;
  for (int k = 0; id < LC_SKIN_LIMBS && k < PER_LIMB; ++k) sum += sums[PER_LIMB * id + k].x;
  return sum;
}

// px^2 (LC_EXACT) that each limb shows in all slices, for the first LC_SKIN_LIMBS work-items. first, end: of this
// slice.
static long px_of_limbs(const Seen* s, Slices* slices, int first, int end, local long2* sums) {
  const int id = get_local_id(0), limb = id / PER_LIMB;
  long px_here = 0, px = 0;
  for (int i = first + id % PER_LIMB; i < end; i += PER_LIMB) {
    const float seen_px = s->skin[LC_SKIN * i + LC_SKIN_PX];
    if (s->skin_limbs[i] / 2 == limb && seen_px > 0.0f) px_here += LC_EXACT(seen_px);
  }
  px_here = of_limb(px_here, sums);
  if (id < LC_SKIN_LIMBS) slices->limbs[LC_SKIN_LIMBS * slices->own + id] = px_here;
  wait_for_slices(slices);
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (int k = id % PER_LIMB; k < slices->n; k += PER_LIMB) px += slices->limbs[LC_SKIN_LIMBS * k + limb];
  return of_limb(px, sums);
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

// Vertex i as the place-th of its kind: what rows are made of (layout.h). weight: that it stands for.
static void write_chosen(const Seen* s, PoseInputs at, int i, int place, float weight, global float* inputs) {
  if (s->kind == CONTOUR) {
    inputs[at.contour_vertices + place] = as_float(i);
    return;
  }
  const float root = row_root(s->numbers[s->kind], weight);
  if (s->kind == MATCHES) {
    global float* to = inputs + at.match_targets + LC_POSE_MATCH * place;
    global const float* match = s->matches + LC_MATCH * i;
    inputs[at.match_vertices + place] = as_float(i);
    for (int k = 0; k < LC_POSE_MATCH; ++k) to[k] = k < 2 ? match[k] : root * match[k];
    return;
  }
  const int light = s->skin_limbs[i] % 2;
  global float* to = inputs + at.shaded_targets + LC_POSE_SHADED * place;
  inputs[at.shaded_vertices + place] = as_float(s->skin_vertices[i]);
  for (int k = 0; k < LC_POSE_LIGHT - 1; ++k) to[k] = s->lights[LC_POSE_LIGHT * light + 1 + k];
  to[9] = in_deviations(s->skin[LC_SKIN * i + LC_SKIN_BRIGHTNESS], s->numbers[LC_POSE_CHOICE_DEVIATIONS + light]);
  to[10] = root;
}

// A run of vertices that are neighbours; the runs of all work-items in turn are all of them.
typedef struct {
  int begin, end;
  float weight;  // of the first one
} Run;

static float weight_in(const Seen* s, Run run, int i) {
  return i == run.begin ? run.weight : weight_of(s, i);
}

// How many of a run are seen, and their weights (LC_EXACT).
static long2 seen_in(const Seen* s, Run run) {
  long2 sum = 0;
  for (int i = run.begin; i < run.end; ++i) {
    const float weight = weight_in(s, run, i);
    if (weight > 0.0f) sum += (long2)(1, LC_EXACT(weight));
  }
  return sum;
}

// The weight that a vertex stands for, 0 where it is not chosen. before: of it; all: see seen_in.
static float weight_for(const Seen* s, float weight, long2 before, long2 all, Shares shares) {
  const int most = s->choice.most[s->kind];
  if (all.x <= most) return weight;
  const double n_shares = shares_until(before.y + LC_EXACT(weight), shares) - shares_until(before.y, shares);
  const int is_chosen = s->kind == CONTOUR ? is_spread(before.x, all.x, most) : n_shares >= 1.0;
  return !is_chosen ? 0.0f : s->kind == CONTOUR ? weight : (float)(n_shares * shares.each * LC_EXACT_UNIT);
}

// How many vertices of a run are chosen; from `place` on, if that is not negative, they are written.
static int choose_in(const Seen* s, Run run, long2 before, long2 all, Shares shares, int place, PoseInputs at,
                     global float* inputs) {
  int n_chosen = 0;
  for (int i = run.begin; i < run.end; ++i) {
    const float weight = weight_in(s, run, i);
    if (!(weight > 0.0f)) continue;
    const float stands_for = weight_for(s, weight, before, all, shares);
    before += (long2)(1, LC_EXACT(weight));
    if (!(stands_for > 0.0f)) continue;
    if (place >= 0 && place + n_chosen < s->choice.most[s->kind])  // sums that overflow may choose more
      write_chosen(s, at, i, place + n_chosen, stands_for, inputs);
    ++n_chosen;
  }
  return n_chosen;
}

// contour [n] 1 for contour vertices, matches [LC_MATCH*n], skin [LC_SKIN*n], of as many as `choice` says;
// skin_vertices [n]; skin_limbs [n]: twice the limb and 1 for the second light. inputs: what is chosen by, and out what
// is chosen, see layout.h. moved, least_moved_px: see PoseStepsArg. told: [LC_POSE_CHOICE_TOLD] for each slice; state:
// of each kind, see all_arrived.h, 0 before. Where a wait is given up some of what is chosen is missing, and there is
// what was in `inputs` before. sums: [GROUP]; limb_px: [LC_SKIN_LIMBS].
kernel __attribute__((reqd_work_group_size(GROUP, 1, 1))) void pose_choose(
    PoseInputs at, PoseChoice choice, float least_moved_px, global const float* restrict moved,
    global const int* restrict contour, global const float* restrict matches, global const float* restrict skin,
    global const int* restrict skin_vertices, global const int* restrict skin_limbs, global float* inputs,
    global long* told, volatile global int* state, local long2* sums, local double* limb_px) {
  const int id = get_local_id(0), n_slices = get_num_groups(0) / 3, kind = get_group_id(0) / n_slices;
  local int given_up;
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
  Slices slices = {n_slices,
                   get_group_id(0) % n_slices,
                   0,
                   1,
                   (global long2*)(told) + 2 * n_slices * kind,
                   told + 12 * n_slices,
                   state + 2 * kind,
                   &given_up};
  if (moved[0] < least_moved_px) return;
  const int n = choice.n[kind], in_slice = (n + n_slices - 1) / n_slices, each = (in_slice + GROUP - 1) / GROUP;
  const int first = min(in_slice * slices.own, n), end = min(first + in_slice, n);
  if (kind == SKIN) {
    const long px = px_of_limbs(&seen, &slices, first, end, sums);
    if (id < LC_SKIN_LIMBS) limb_px[id] = limb_px_of_one(px, choice.limb_area_px);
  }
  barrier(CLK_LOCAL_MEM_FENCE);

  Run run = {min(first + id * each, end), min(first + id * each + each, end), 0.0f};
  if (run.begin < run.end) run.weight = weight_of(&seen, run.begin);
  long missed = 0;  // px^2
  for (int i = run.begin; kind == MATCHES && i < run.end; ++i) missed += missed_px(matches + LC_MATCH * i);
  long2 added, all, chosen;
  long2 before = sums_before(seen_in(&seen, run), sums, &added);
  before += of_slices_before(added, &slices, sums, &all);
  const Shares shares = shares_of(all.y, choice.most[kind]);
  const int n_chosen = choose_in(&seen, run, before, all, shares, -1, at, inputs);
  long2 place = sums_before((long2)(n_chosen, missed), sums, &added);
  place += of_slices_before(added, &slices, sums, &chosen);
  if (slices.together) choose_in(&seen, run, before, all, shares, (int)place.x, at, inputs);
  if (id > 0 || slices.own > 0) return;
  if (!slices.together) chosen = 0;
  chosen.x = min(chosen.x, (long)choice.most[kind]);
  inputs[at.counts + kind] = as_float((int)chosen.x);
  if (kind == CONTOUR)
    inputs[at.counts + LC_POSE_COUNT_CONTOUR_ROOT] =
        contour_row_root(seen.numbers[CONTOUR], (double)all.x, (double)chosen.x);
  if (kind == MATCHES) {
    const double missed_weight = (double)chosen.y * LC_EXACT_UNIT / seen.numbers[LC_POSE_CHOICE_MATCH_AREA];
    inputs[at.counts + LC_POSE_COUNT_MISSED] = (float)missed_weight;
    inputs[at.counts + LC_POSE_COUNT_SEEN] = (float)((double)all.y * LC_EXACT_UNIT + missed_weight);
  }
}
#endif
