// Body-part mask (paper, "Stage II", body part mask): the part of each pixel, each part grown by a square of half-side
// `radius`, the torso over everything else. Sets of parts are bit masks (bit p = part p), so growing is a bitwise or.
// Padded planes: row stride `stride`, LC_PART_PAD columns before and `radius` rows above and below the picture, all
// zero.
#include "raster/layout.h"
#include "shared/bits.h"
#include "shared/gather.h"
#include "shared/wide.h"

#ifdef LC_DEVICE

// One work-item per LC_PART_PIXELS of a row. drawn: on CPUs the columns that depth.cl covers of each strip of rows.
kernel void part_bits(int width, int height, int stride, int radius, global const int* restrict drawn,
                      global const int* restrict ids, global const int* restrict triangle_part,
                      global uchar* restrict bits) {
  const int x0 = LC_PART_PIXELS * (int)get_global_id(0);
  const int y = get_global_id(1);
  if (x0 >= width || y >= height) return;
  ids += y * width;
  bits += (y + radius) * stride + LC_PART_PAD;
#if !LC_CPU
  (void)drawn;
#else
  const int strip = y / LC_STRIP_ROWS;
  if (x0 > drawn[2 * strip + 1] || x0 + LC_PART_PIXELS <= drawn[2 * strip]) {
    store_uchar16((uchar16)0, bits + x0);  // the planes have room
    return;
  }
  if (x0 + LC_PART_PIXELS <= width) {
    const int16 id = vload16(0, ids + x0), drawn = id >= 0;
    int16 bit = 0;
    if (any_of_16(drawn)) bit = drawn & ((int16)1 << gather_int16(triangle_part, max(id, 0)));
    store_uchar16(convert_uchar16(bit), bits + x0);
    return;
  }
#endif
  for (int x = x0; x < min(x0 + LC_PART_PIXELS, width); ++x)
    bits[x] = ids[x] < 0 ? 0 : (uchar)(1 << triangle_part[ids[x]]);
}

// One work-item per LC_PART_PIXELS of a row; n_groups of them make a row.
kernel void part_grow_rows(int n_groups, int height, int stride, int radius, global const uchar* restrict bits,
                           global uchar* restrict grown) {
  const int group = get_global_id(0);
  const int y = get_global_id(1);
  if (group >= n_groups || y >= height) return;
  const int at = (y + radius) * stride + LC_PART_PAD + LC_PART_PIXELS * group;
  // Mostly there is nobody in reach of any of them.
  const ulong2 near =
      as_ulong2(vload16(0, bits + at - LC_PART_PAD) | vload16(0, bits + at) | vload16(0, bits + at + LC_PART_PAD));
  uchar16 set = 0;
  if (near.x | near.y) {
    for (int d = -radius; d <= radius; ++d) set |= vload16(0, bits + at + d);
  }
  store_uchar16(set, grown + at);
}

// The torso (part 1) where it reaches, else the part drawn there, else the lowest part that reaches it.
static inline uchar16 decide_part(uchar16 reaching, uchar16 own) {
  uchar16 set = select(reaching, own, own != (uchar16)0);
  set = select(set, (uchar16)2, (reaching & (uchar16)2) != (uchar16)0);
  set &= (uchar16)(~set + (uchar16)1);  // lowest bit
  // Index of a single bit.
  const uchar16 none = 0;
  return select((uchar16)1, none, (set & (uchar16)0xaa) == none) |
         select((uchar16)2, none, (set & (uchar16)0xcc) == none) |
         select((uchar16)4, none, (set & (uchar16)0xf0) == none);
}

// Grows along columns and decides. One work-item per LC_PART_PIXELS of LC_PART_ROWS rows, which share most of the rows
// that reach them. Rows of `bits` and `grown`: radius more above the picture, radius + LC_PART_ROWS below. part_image:
// [w*h], 0 = none.
kernel void part_grow_columns(int n_groups, int width, int height, int stride, int radius,
                              global const uchar* restrict bits, global const uchar* restrict grown,
                              global uchar* restrict part_image) {
  const int group = get_global_id(0);
  const int y0 = (int)get_global_id(1) * LC_PART_ROWS;
  if (group >= n_groups || y0 >= height) return;
  const int at = (y0 + radius) * stride + LC_PART_PAD + LC_PART_PIXELS * group;
  // What reaches all rows, if the square is that large; then for each row what is above and below of that.
  const int first = LC_PART_ROWS - 1 - radius, last = radius;
  uchar16 all_rows = 0;
  for (int d = first; d <= last; ++d) all_rows |= vload16(0, grown + at + d * stride);
  for (int k = 0; k < LC_PART_ROWS && y0 + k < height; ++k) {
    uchar16 reaching = first <= last ? all_rows : (uchar16)0;
    for (int d = k - radius; d < min(first, k + radius + 1); ++d) reaching |= vload16(0, grown + at + d * stride);
    for (int d = max(last + 1, k - radius); d <= k + radius; ++d) reaching |= vload16(0, grown + at + d * stride);
    const ulong2 any_part = as_ulong2(reaching);
    uchar16 part = 0;
    if (any_part.x | any_part.y) part = decide_part(reaching, vload16(0, bits + at + k * stride));
    global uchar* to = part_image + (y0 + k) * width + LC_PART_PIXELS * group;
    if (LC_PART_PIXELS * (group + 1) <= width) {
      store_uchar16(part, to);
    } else {
      uchar lanes[LC_PART_PIXELS];
      vstore16(part, 0, lanes);
      for (int j = 0; LC_PART_PIXELS * group + j < width; ++j) to[j] = lanes[j];
    }
  }
}

#endif
