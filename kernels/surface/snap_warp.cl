// Vertex snapping, second half (paper, "Vertex Snapping"): non-boundary vertices follow by a Laplacian warp in a band
// of a few edge rings around the snapped ones. The moves of the band solve the graph Laplace equation with the snapped
// moves given and zero beyond the band: a first guess that falls off linearly, then Jacobi sweeps.
#include "shared/lanes.h"
//
#include "surface/rings.h"

// Vertices not reached yet that have a neighbour of ring - 1 become `ring`; their move is the mean of those neighbours'
// times `fall`. All others are copied.
static inline void spread_row(int row, int stride, float ring, float fall, global const int* slice_offsets,
                              global const int* neighbors, global const float* rings, global const float* moves,
                              global float* rings_after, global float* moves_after) {
  REAL new_ring = LOAD(rings, row);
  REAL new_x = LOAD(moves, row);
  REAL new_y = LOAD(moves, row + stride);
  LaneInt open = new_ring == RING_FREE;
  if (ANY_LANE(open)) {
    REAL zero = 0.0f, one = 1.0f;
    REAL count = zero, x = zero, y = zero;
    int begin = slice_offsets[row / SLICE];
    int end = slice_offsets[row / SLICE + 1];
    for (int base = begin; base < end; base += SLICE) {
      LaneInt j = LOAD(neighbors, base + row % SLICE);
      LaneInt near = gather(rings, j) == ring - 1.0f;
      count += near ? one : zero;
      x += near ? gather(moves, j) : zero;
      y += near ? gather(moves + stride, j) : zero;
    }
    LaneInt reached = open && count > zero;
    REAL scale = fall / fmax(count, one);
    new_ring = reached ? ring * one : new_ring;
    new_x = reached ? x * scale : new_x;
    new_y = reached ? y * scale : new_y;
  }
  STORE(new_ring, rings_after, row);
  STORE(new_x, moves_after, row);
  STORE(new_y, moves_after, row + stride);
}

// One Jacobi sweep: the move of a band vertex (ring 1 .. n_rings) becomes the mean over its neighbours. Other rows of
// `after` must already equal `before`.
static inline void relax_row(int row, int stride, float n_rings, global const int* slice_offsets,
                             global const int* neighbors, global const float* rings, global const float* before,
                             global float* after) {
  REAL ring = LOAD(rings, row);
  LaneInt free = ring > 0.0f && ring <= n_rings;
  if (!ANY_LANE(free)) return;
  REAL zero = 0.0f, one = 1.0f;
  REAL count = zero, x = zero, y = zero;
  LaneInt own = row + LANE_IDS;
  int begin = slice_offsets[row / SLICE];
  int end = slice_offsets[row / SLICE + 1];
  for (int base = begin; base < end; base += SLICE) {
    LaneInt j = LOAD(neighbors, base + row % SLICE);
    LaneInt real = j != own;  // padding names its own row
    count += real ? one : zero;
    x += real ? gather(before, j) : zero;
    y += real ? gather(before + stride, j) : zero;
  }
  REAL scale = one / fmax(count, one);
  REAL new_x = free ? x * scale : LOAD(before, row);
  REAL new_y = free ? y * scale : LOAD(before, row + stride);
  STORE(new_x, after, row);
  STORE(new_y, after, row + stride);
}

#if LC_CPU
kernel void snap_spread(int n_rows, int stride, float ring, float fall, global const int* restrict slice_offsets,
                        global const int* restrict neighbors, global const float* restrict rings,
                        global const float* restrict moves, global float* restrict rings_after,
                        global float* restrict moves_after) {
  int row = FIRST_ROW;
  if (row < n_rows)
    spread_row(row, stride, ring, fall, slice_offsets, neighbors, rings, moves, rings_after, moves_after);
}

kernel void snap_relax(int n_rows, int stride, float n_rings, global const int* restrict slice_offsets,
                       global const int* restrict neighbors, global const float* restrict rings,
                       global const float* restrict before, global float* restrict after) {
  int row = FIRST_ROW;
  if (row < n_rows) relax_row(row, stride, n_rings, slice_offsets, neighbors, rings, before, after);
}

#else
#include "shared/all_arrived.h"

// Rounds first..end-1: n_rings of spreading, then of relaxing, each from one set of moves into the other; work-groups
// wait for each other between them. Even rounds read rings and moves. arrived, state: see all_arrived.h.
kernel void snap_rounds(int first, int end, int arrived, int n_rows, int stride, int n_rings,
                        global const int* restrict slice_offsets, global const int* restrict neighbors,
                        global float* rings, global float* rings_after, global float* moves, global float* moves_after,
                        volatile global int* state) {
  local int given_up;
  for (int round = first; round < end; ++round) {
    if (round > first) {
      arrived += get_num_groups(0);
      if (!all_arrived(1, state, arrived, &given_up)) return;
    }
    const bool even = round % 2 == 0;
    global const float* before = even ? moves : moves_after;
    global float* after = even ? moves_after : moves;
    // Linear fall-off to zero at n_rings + 1.
    const float fall = (float)(n_rings - round) / (float)(n_rings + 1 - round);
    for (int row = get_global_id(0); row < n_rows; row += get_global_size(0)) {
      if (round < n_rings)
        spread_row(row, stride, (float)(round + 1), fall, slice_offsets, neighbors, even ? rings : rings_after, before,
                   even ? rings_after : rings, after);
      else
        relax_row(row, stride, (float)n_rings, slice_offsets, neighbors, n_rings % 2 == 0 ? rings : rings_after, before,
                  after);
    }
  }
}
#endif
