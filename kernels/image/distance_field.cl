// Exact signed Euclidean distance to the border of a mask, in two passes (after Meijster, Roerdink and Hesselink, "A
// general algorithm for computing distance transforms in linear time", 2000): along columns, then the least over each
// row: on a CPU sixteen pixels at a time look at the columns between the nearest one of the first and of the last, on a
// GPU each pixel at the columns beside it, the nearest first.
#include "image/layout.h"
#include "shared/bits.h"
#include "shared/lanes.h"
#include "shared/plain_math.h"

#ifdef LC_DEVICE

#define LC_NONE 32000  // CPU: no pixel of the other kind in this column
#define LC_NOWHERE (LC_NONE * LC_NONE)
#define LC_INSIDE ((ushort)0x8000)
#define LC_STEPS ((ushort)0x7fff)

typedef struct {
  int width, height;              // of the picture
  int x0, n_columns, y0, n_rows;  // where distances are exact: columns from x0 on, multiples of LC_BLOCK both
  int box_x0, box_x1;             // of these columns those that are results; beyond the distances are extended
  int stride;                     // of the planes: pixel (x, y) is at (y - y0) * stride + x - x0, on a GPU one further
} DistanceArg;

#if LC_CPU

// The kind of the pixels of a row from x on, all bits set inside; beyond the picture's border outside.
static inline ushort16 kinds(global const uchar* row, int n) {
  if (n >= LC_LANES) return as_ushort16(convert_short16(vload16(0, row)) != (short16)0);
  ushort lanes[LC_LANES];
  for (int k = 0; k < LC_LANES; ++k) lanes[k] = k < n && row[k] ? 0xffff : 0;
  return vload16(0, lanes);
}

// One further than the pixel before, 1 where the kind changes.
static inline ushort16 further(ushort16 before, ushort16 changed) {
  return (min(before + (ushort16)1, (ushort16)LC_NONE) & ~changed) | (changed & (ushort)1);
}

// steps: distance along the column to the nearest pixel of the other kind (LC_NONE: there is none), LC_INSIDE added
// inside. mask: [w*h], nonzero = inside. One work-item per n_strip columns, rows after each other: memory is read in
// its order.
kernel void column_steps(DistanceArg a, int n_strip, global const uchar* restrict mask, global ushort* steps) {
  const int first = (int)get_global_id(0) * n_strip;
  if (first >= a.n_columns) return;
  const int end = min(first + n_strip, a.n_columns);
  for (int y = 0; y < a.n_rows; ++y) {
    global const uchar* row = mask + (a.y0 + y) * a.width + a.x0;
    for (int x = first; x < end; x += LC_LANES) {
      global ushort* to = steps + y * a.stride + x;
      const ushort16 inside = kinds(row + x, a.width - a.x0 - x);
      ushort16 distance = LC_NONE;
      if (y > 0) {
        const ushort16 above = vload16(0, to - a.stride);
        distance = further(above & LC_STEPS, inside ^ as_ushort16(as_short16(above) >> (short)15));
      }
      store_ushort16(distance | (inside & LC_INSIDE), to);
    }
  }
  for (int y = a.n_rows - 2; y >= 0; --y) {
    for (int x = first; x < end; x += LC_LANES) {
      global ushort* to = steps + y * a.stride + x;
      const ushort16 down = vload16(0, to), below = vload16(0, to + a.stride);
      const ushort16 up = further(below & LC_STEPS, as_ushort16(as_short16(down ^ below) >> (short)15));
      store_ushort16(min(down & LC_STEPS, up) | (down & LC_INSIDE), to);
    }
  }
}

// First pixel from `from` on that is not of the kind, or `width`.
static inline int end_of_run(global const ushort* row, int from, int width, ushort kind) {
  for (int x = from & ~(LC_LANES - 1); x < width; x += LC_LANES) {
    uint bits = bits_of_16(convert_int16(as_short16(vload16(0, row + x) ^ kind)) < (int16)0);
    if (x < from) bits &= ~0u << (from - x);
    if (bits) return min(x + lowest_bit(bits), width);
  }
  return width;
}

// The column of lo..hi whose nearest pixel of the other kind is the nearest of all to pixel x of the row. heights:
// squares of the distances along the columns. Columns behind hi may be looked at and are further.
static inline int nearest_column(global const int* heights, int x, int lo, int hi) {
  const int16 lane = (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  int16 away = lo - x + lane, least = away * away + vload16(0, heights + lo), at = lo + lane;
  for (int first = lo + LC_LANES; first <= hi; first += LC_LANES) {
    away += LC_LANES;
    const int16 square = away * away + vload16(0, heights + first);
    const int16 nearer = square < least;
    least = nearer ? square : least;
    at = nearer ? first + lane : at;
  }
  const int8 eight = LC_LESSER(least.lo, least.hi);
  const int4 four = LC_LESSER(eight.lo, eight.hi);
  const int2 two = LC_LESSER(four.lo, four.hi);
  int columns[LC_LANES];
  vstore16(at, 0, columns);
  return columns[lowest_bit(bits_of_16(least == (int16)LC_LESSER(two.x, two.y)))];
}

// Squared distances of sixteen pixels from x on, whose nearest columns are among lo..hi; as above.
static inline int16 squares_of(global const int* heights, int x, int lo, int hi) {
  const int16 away = x - lo + (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  int16 square = away * away, step = 2 * away - 1, least = square + heights[lo];
  for (int first = lo; first < hi; first += 4) {  // fewer branches
#pragma unroll
    for (int k = 1; k <= 4; ++k) {
      square -= step;
      step -= 2;
      const int16 other = square + heights[first + k];
      least = LC_LESSER(least, other);
    }
  }
  return least;
}

// One run [begin, end) of one kind in a row. The nearest column moves to the right with the pixel, never back. It is
// looked for at the last pixel of each sixteen, those in the middle first, which bound the others; between two of them
// it is one of those between theirs. nearest: [1 + (end - begin + 15) / 16] scratch; n_inside: pixels of the picture
// from the row's first on.
static inline void run_distances(int begin, int end, int width, int n_inside, float sign, global const int* heights,
                                 global int* nearest, global float* restrict to) {
  const int n = (end - begin + LC_LANES - 1) / LC_LANES, last = min(end, width - 1);
  nearest[0] = max(begin - 1, 0);
  for (int step = 1 << (31 - clz(n)); step > 0; step >>= 1) {
    for (int k = step; k <= n; k += 2 * step)
      nearest[k] = nearest_column(heights, min(begin + LC_LANES * k, end) - 1, nearest[k - step],
                                  k + step <= n ? nearest[k + step] : last);
  }
  for (int k = 0; k < n; ++k) {
    const int x = begin + LC_LANES * k;
    const int16 squares = squares_of(heights, x, nearest[k], nearest[k + 1]);
    const float16 away = sign * (sqrt(convert_float16(squares)) - 0.5f);
    if (x + LC_LANES <= n_inside) {
      store16(away, to + x);  // what is too much is the next run's, or beyond the exact part
    } else {
      float lanes[LC_LANES];
      vstore16(away, 0, lanes);
      for (int i = 0; x + i < end; ++i) to[x + i] = lanes[i];
    }
  }
}

// Words of scratch of a work-item: heights of all columns and of sixteen more, nearest columns.
#define LC_ROW_SCRATCH(n_columns) ((n_columns) + LC_LANES + (n_columns) / LC_LANES + 2)

// One work-item per n_band rows. scratch: [LC_ROW_SCRATCH(n_columns)] per work-item. distance: [w*h] px, half a pixel
// taken off so that the contour lies between the pixels; positive outside, negative inside.
kernel void row_distances(DistanceArg a, int n_band, global const ushort* restrict steps, global int* scratch,
                          global float* restrict distance) {
  const int band = get_global_id(0);
  const int width = min(a.n_columns, a.width - a.x0);
  global int* heights = scratch + band * LC_ROW_SCRATCH(a.n_columns);
  global int* nearest = heights + a.n_columns + LC_LANES;
  store_int16((int16)LC_NOWHERE, heights + a.n_columns);
  for (int y = band * n_band; y < min((band + 1) * n_band, a.n_rows); ++y) {
    global const ushort* row = steps + y * a.stride;
    global float* to = distance + (a.y0 + y) * a.width + a.x0;
    for (int x = 0; x < a.n_columns; x += LC_LANES) {
      const int16 far = convert_int16(vload16(0, row + x) & LC_STEPS);
      store_int16(far * far, heights + x);
    }
    for (int begin = 0, end; begin < width; begin = end) {
      const ushort kind = row[begin] & LC_INSIDE;
      end = end_of_run(row, begin + 1, width, kind);
      // The run's neighbours are of the other kind. A run that goes on beyond the first or last column has none there.
      if (begin > 0) heights[begin - 1] = 0;
      const int height = heights[end];
      if (end < width) heights[end] = 0;
      run_distances(begin, end, width, a.width - a.x0, kind ? -1.0f : 1.0f, heights, nearest, to);
      heights[end] = height;
    }
  }
}

#else

#define LC_NEVER (1 << 30)

// bits[block*columns + x]: bit y = the pixel in row 32 * block + y is inside; rows below the last repeat it.
kernel void column_bits(DistanceArg a, global const uchar* restrict mask, global uint* restrict bits) {
  const int x = get_global_id(0), block = get_global_id(1);
  const int columns = a.n_columns;
  if (x >= columns || block >= (a.n_rows + 31) / 32 || a.x0 + x >= a.width) return;
  uint word = 0;
  for (int k = 0; k < 32; ++k) {
    const int y = a.y0 + min(32 * block + k, a.n_rows - 1);
    word |= (mask[y * a.width + a.x0 + x] ? 1u : 0u) << k;
  }
  bits[block * columns + x] = word;
}

// Squared distance along the column to the nearest pixel inside (outside); 0 for pixels that are inside (outside)
// themselves. One work-item per pixel and for the columns before and behind, where nothing is anywhere near.
kernel void column_squares(DistanceArg a, global const uint* restrict bits, global int* restrict to_inside,
                           global int* restrict to_outside) {
  const int x = (int)get_global_id(0) - 1, y = get_global_id(1);
  const int columns = a.n_columns;
  if (x > columns || y >= a.n_rows) return;
  const int at = y * a.stride + 1 + x;
  if (x < 0 || x >= columns || a.x0 + x >= a.width) {
    to_inside[at] = to_outside[at] = LC_NEVER;
    return;
  }
  const int n_blocks = (a.n_rows + 31) / 32;
  const uint inside = bits[y / 32 * columns + x] >> (y % 32) & 1u;
  const uint all_same = inside ? ~0u : 0u;
  int nearest = 32000;
  // Differences from this pixel's kind, above and below it in its own block, then block by block.
  uint other = (bits[y / 32 * columns + x] ^ all_same) & (0xffffffffu >> (31 - y % 32));
  for (int block = y / 32;; other = bits[block * columns + x] ^ all_same) {
    if (other) {
      nearest = y - (32 * block + 31 - (int)clz(other));
      break;
    }
    if (--block < 0 || y - (32 * block + 31) >= nearest) break;
  }
  other = (bits[y / 32 * columns + x] ^ all_same) & (0xffffffffu << (y % 32));
  for (int block = y / 32;; other = bits[block * columns + x] ^ all_same) {
    if (other) {
      nearest = min(nearest, 32 * block + 31 - (int)clz(other & (~other + 1u)) - y);
      break;
    }
    if (++block >= n_blocks || 32 * block - y >= nearest) break;
  }
  const int far = nearest < 32000 ? nearest * nearest : LC_NEVER;
  to_inside[at] = inside ? 0 : far;
  to_outside[at] = inside ? far : 0;
}

// One work-item per pixel. distance: as above.
kernel void row_distances(DistanceArg a, global const int* restrict to_inside, global const int* restrict to_outside,
                          global float* restrict distance) {
  const int x = get_global_id(0), y = get_global_id(1);
  const int last = a.n_columns;
  if (x >= last || y >= a.n_rows || a.x0 + x >= a.width) return;
  const int inside = to_inside[y * a.stride + 1 + x] == 0;
  global const int* row = (inside ? to_outside : to_inside) + y * a.stride + 1;
  int best = row[x];
  const int reach = max(x + 1, last - x);
  for (int d = 1; d < reach && d * d < best; ++d)
    best = min(best, min(row[max(x - d, -1)], row[min(x + d, last)]) + d * d);
  const float away = sqrt((float)best) - 0.5f;
  distance[(a.y0 + y) * a.width + a.x0 + x] = inside ? -away : away;
}

#endif

// Everything outside the exact part: the value at its nearest pixel and the way there. One work-item per 16 pixels of a
// row of the picture.
kernel void extend_distances(DistanceArg a, int n_groups, global float* restrict distance) {
  const int group = get_global_id(0), y = get_global_id(1);
  if (group >= n_groups || y >= a.height) return;
  const int first = group * LC_LANES, end = min(first + LC_LANES, a.width);
  const int from_y = clamp(y, a.y0, a.y0 + a.n_rows - 1);
  if (from_y == y && first >= a.box_x0 && end <= a.box_x1) return;
  global const float* from = distance + from_y * a.width;
  const float dy = (float)(y - from_y);
  global float* to = distance + y * a.width + first;
  const int n_inside = clamp(a.box_x1, first, end) - clamp(a.box_x0, first, end);
  if (end - first == LC_LANES && (n_inside == 0 || n_inside == LC_LANES)) {
    if (n_inside) {
      store16(vload16(0, from + first) + fabs(dy), to);
    } else {
      const int from_x = first < a.box_x0 ? a.box_x0 : a.box_x1 - 1;
      const float16 lane = (float16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
      const float16 dx = lane + (float)(first - from_x);
      store16(from[from_x] + sqrt(dx * dx + dy * dy), to);
    }
    return;
  }
  for (int x = first; x < end; ++x) {
    const int from_x = clamp(x, a.box_x0, a.box_x1 - 1);
    if (from_x == x && from_y == y) continue;
    const float dx = (float)(x - from_x);
    distance[y * a.width + x] = from[from_x] + sqrt(dx * dx + dy * dy);
  }
}

// Both of them [n] px, of a mask and of a part of it. Sixteen pixels per work-item.
kernel void leave_open(int n, global const float* restrict sure, global float* restrict distance) {
  const int first = (int)get_global_id(0) * LC_LANES;
  if (first >= n) return;
  if (first + LC_LANES <= n) {
    const float16 most = vload16(0, distance + first), least = vload16(0, sure + first);
    store16(select(min(least, 0.0f), most, most > 0.0f), distance + first);
    return;
  }
  for (int i = first; i < n; ++i) distance[i] = distance[i] > 0.0f ? distance[i] : min(sure[i], 0.0f);
}

#endif
