// A crop's mask laid over the image, where its box is; 0 elsewhere. The same as warp_affine of src/image on the host.
#include "image/warp_point.h"
#include "shared/bits.h"
#include "shared/wide.h"

typedef struct {
  int width, height;  // of the image
  int x0, y0, x1, y1;
  int size;  // of the crop
} MaskArg;

static int mask_at(global const uchar* restrict crop, int size, int x, int y) {
  return x >= 0 && y >= 0 && x < size && y < size ? crop[y * size + x] : 0;
}

static int laid_at(MaskArg arg, int x, int y, global const uchar* restrict crop, global const int* restrict steps) {
  if (x < arg.x0 || x >= arg.x1 || y < arg.y0 || y >= arg.y1) return 0;
  const WarpPoint p = warp_point(steps, arg.x1 - arg.x0, x - arg.x0, y - arg.y0);
  return warp_mix(p, mask_at(crop, arg.size, p.x, p.y), mask_at(crop, arg.size, p.x + 1, p.y),
                  mask_at(crop, arg.size, p.x, p.y + 1), mask_at(crop, arg.size, p.x + 1, p.y + 1));
}

#if LC_CPU

// Pixels and what is beside each, from p[i] on.
static inline int16 pairs_at(global const uchar* restrict p, int16 i) {
  int at[16];
  ushort pairs[16];
  vstore16(i, 0, at);
#pragma unroll
  for (int k = 0; k < 16; ++k) pairs[k] = as_ushort(vload2(0, p + at[k]));
  return convert_int16(vload16(0, pairs));
}

// What sixteen pixels show that are near each other in the crop, when it is the same there all around them: mostly it
// is. -1: it is not, or they may lie outside. from, to: of the first and the last.
static inline int same_around(WarpPoint from, WarpPoint to, int size, global const uchar* restrict crop) {
  const int x = min(from.x, to.x), y = min(from.y, to.y), end_x = max(from.x, to.x) + 2, end_y = max(from.y, to.y) + 2;
  if (x < 0 || y < 0 || x + 8 > size || end_x - x > 8 || end_y > size || end_y - y > 8) return -1;
  const ulong row = as_ulong(vload8(0, crop + y * size + x));
  ulong other = row ^ (row & 255) * 0x0101010101010101UL;
  for (int v = y + 1; v < end_y; ++v) other |= row ^ as_ulong(vload8(0, crop + v * size + x));
  return other ? -1 : (int)(row & 255);
}

// Over (width / 16, height), sixteen pixels each. steps: of the box.
kernel void lay_mask(MaskArg arg, global const uchar* restrict crop, global const int* restrict steps,
                     global uchar* restrict mask) {
  const int x = 16 * (int)get_global_id(0), y = get_global_id(1);
  if (x >= arg.width || y >= arg.height) return;
  global uchar* to = mask + y * arg.width + x;
  if (x >= arg.x0 && x + 16 <= arg.x1 && y >= arg.y0 && y < arg.y1) {
    global const int* restrict columns = steps + 2 * (x - arg.x0);
    global const int* restrict row = steps + 2 * (arg.x1 - arg.x0 + y - arg.y0);
    const int n_columns = arg.x1 - arg.x0;
    const int same = same_around(warp_point(steps, n_columns, x - arg.x0, y - arg.y0),
                                 warp_point(steps, n_columns, x - arg.x0 + 15, y - arg.y0), arg.size, crop);
    if (same >= 0) {
      store_uchar16((uchar16)(uchar)same, to);
      return;
    }
    const int16 a = vload16(0, columns), b = vload16(1, columns);
    const int16 at_x = ((int16)(a.even, b.even) + row[0]) >> 5, at_y = ((int16)(a.odd, b.odd) + row[1]) >> 5;
    const int16 px = at_x >> 5, py = at_y >> 5, last = arg.size - 2;
    if (!any_of_16(px < 0 || py < 0 || px > last || py > last)) {
      const int16 at = py * arg.size + px;
      const int16 above = pairs_at(crop, at), below = pairs_at(crop + arg.size, at);
      const int16 right = at_x & 31, left = 32 - right, down = at_y & 31;
      const int16 top = (above & 255) * left + (above >> 8) * right,
                  bottom = (below & 255) * left + (below >> 8) * right;
      store_uchar16(convert_uchar16((top * (32 - down) + bottom * down + 512) >> 10), to);
      return;
    }
  } else if (x + 16 <= arg.width && (x + 16 <= arg.x0 || x >= arg.x1 || y < arg.y0 || y >= arg.y1)) {
    store_uchar16((uchar16)0, to);
    return;
  }
  for (int k = 0; k < min(16, arg.width - x); ++k) to[k] = (uchar)laid_at(arg, x + k, y, crop, steps);
}

#else

// Over (width, height). steps: of the box.
kernel void lay_mask(MaskArg arg, global const uchar* restrict crop, global const int* restrict steps,
                     global uchar* restrict mask) {
  const int x = get_global_id(0), y = get_global_id(1);
  if (x >= arg.width || y >= arg.height) return;
  mask[y * arg.width + x] = (uchar)laid_at(arg, x, y, crop, steps);
}

#endif
