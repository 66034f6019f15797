// Vertex snapping, second half (paper, "Vertex Snapping"): non-boundary vertices follow by a Laplacian warp in a band
// of a few edge rings around the snapped ones. The moves of the band solve the graph Laplace equation with the snapped
// moves given and zero beyond the band: a first guess that falls off linearly, then Jacobi sweeps.
#include "shared/lanes.h"

#define RING_FREE 1000.0f

// Vertices not reached yet that have a neighbour of ring - 1 become `ring`; their move is the mean of those neighbours'
// times `fall`. All others are copied.
kernel void snap_spread(int n_rows, int stride, float ring, float fall, global const int* restrict slice_offsets,
                        global const int* restrict neighbors, global const float* restrict rings,
                        global const float* restrict moves, global float* restrict rings_after,
                        global float* restrict moves_after) {
  int row = FIRST_ROW;
  if (row >= n_rows) return;
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
kernel void snap_relax(int n_rows, int stride, float n_rings, global const int* restrict slice_offsets,
                       global const int* restrict neighbors, global const float* restrict rings,
                       global const float* restrict before, global float* restrict after) {
  int row = FIRST_ROW;
  if (row >= n_rows) return;
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
