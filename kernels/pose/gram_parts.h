// What work-groups of gauss_newton.cl make of their rows of J and add up: tagged, so that a group waits for the numbers
// that it needs and for nothing else. Each group then has the whole sum in local memory.
#ifndef LC_POSE_GRAM_PARTS_H
#define LC_POSE_GRAM_PARTS_H
#include "pose/gram.cl"
#include "shared/tagged.h"

// The part of the normal equations of LC_POSE_GROUP_ROWS rows of J, [n_tiles][8][8] tagged: 2 x 2 entries at a time.
// rows: n_columns / 2 each.
static void gram_of_rows(int n_columns, local const float2* rows, uint tag, volatile global ulong* part) {
  const int n_tiles = n_columns / 8 * (n_columns / 8 + 1) / 2;
  for (int i = get_local_id(0); i < n_tiles * 16; i += LC_POSE_GROUP) {
    const int2 corner = tile_corner(i / 16, n_columns / 8);
    const int y = i % 16 / 4 * 2, x = i % 4 * 2;
    local const float2* above = rows + (corner.x + y) / 2;
    local const float2* beside = rows + (corner.y + x) / 2;
    float2 sums[2] = {0.0f, 0.0f};
#pragma unroll 8
    for (int row = 0; row < LC_POSE_GROUP_ROWS; ++row) {
      const float2 left = above[row * (n_columns / 2)], right = beside[row * (n_columns / 2)];
      sums[0] += left.x * right;
      sums[1] += left.y * right;
    }
    for (int k = 0; k < 2; ++k) {
      volatile global ulong* to = part + i / 16 * 64 + (y + k) * 8 + x;
      to[0] = tagged(sums[k].x, tag);
      to[1] = tagged(sums[k].y, tag);
    }
  }
}

// Of entries that a group adds at a time.
#define ADDED 32
#define PARTS_APART (LC_POSE_GROUP / ADDED)

// gram [n] of parts [n_parts][n], both tagged, n a multiple of ADDED: so many entries a group at a time, in PARTS_APART
// sums each. sums: LC_POSE_GROUP.
static void add_parts(int n, int n_parts, volatile global const ulong* parts, uint tag, volatile global ulong* gram,
                      volatile global int* state, local int* given_up, local float* sums) {
  const int id = get_local_id(0), end = n * n_parts;
  for (int first = ADDED * get_group_id(0); first < n; first += ADDED * get_num_groups(0)) {
    float sum = 0.0f;
    for (int p = id / ADDED; p < n_parts; p += PARTS_APART * TAGGED_AT_ONCE) {
      float values[TAGGED_AT_ONCE];
      if (!take_tagged(TAGGED_AT_ONCE, p * n + first + id % ADDED, PARTS_APART * n, end, parts, tag, state, values))
        *given_up = 1;
#pragma unroll
      for (int k = 0; k < TAGGED_AT_ONCE; ++k) sum += values[k];
    }
    sums[id] = sum;
    barrier(CLK_LOCAL_MEM_FENCE);
    if (id < ADDED && !*given_up) {  // else the others wait in vain, as they should
      for (int k = 1; k < PARTS_APART; ++k) sum += sums[ADDED * k + id];
      gram[first + id] = tagged(sum, tag);
    }
    barrier(CLK_LOCAL_MEM_FENCE | CLK_GLOBAL_MEM_FENCE);
  }
}

#define GRAM_AT_ONCE 4

// near [n] of gram, tagged. Returns whether no wait was given up.
static int take_gram(int n, volatile global const ulong* gram, uint tag, volatile global int* state,
                     local int* given_up, local float* near) {
  const int id = get_local_id(0);
  for (int first = id; first < n; first += GRAM_AT_ONCE * LC_POSE_GROUP) {
    float values[TAGGED_AT_ONCE];
    if (!take_tagged(GRAM_AT_ONCE, first, LC_POSE_GROUP, n, gram, tag, state, values)) *given_up = 1;
#pragma unroll
    for (int k = 0; k < GRAM_AT_ONCE; ++k)
      if (first + k * LC_POSE_GROUP < n) near[first + k * LC_POSE_GROUP] = values[k];
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  return !*given_up;
}

#endif
