// Body-part mask (paper, "Stage II", body part mask): the part of each pixel, each part grown by a square of half-side
// `radius`, the torso over everything else. Sets of parts are bit masks (bit p = part p), so growing is a bitwise or.
// Padded planes: row stride `stride`, LC_PAD columns before and `radius` rows above and below the picture, all zero.
#ifdef LC_DEVICE

#define LC_PAD 16

// One work-item per pixel.
kernel void part_bits(int width, int height, int stride, int radius, global const int* restrict ids,
                      global const int* restrict triangle_part, global uchar* restrict bits) {
  const int x = get_global_id(0);
  const int y = get_global_id(1);
  if (x >= width || y >= height) return;
  const int id = ids[y * width + x];
  bits[(y + radius) * stride + LC_PAD + x] = id < 0 ? 0 : (uchar)(1 << triangle_part[id]);
}

// One work-item per 16 pixels of a row; n_groups of them make a row.
kernel void part_grow_rows(int n_groups, int height, int stride, int radius, global const uchar* restrict bits,
                           global uchar* restrict grown) {
  const int group = get_global_id(0);
  const int y = get_global_id(1);
  if (group >= n_groups || y >= height) return;
  const int at = (y + radius) * stride + LC_PAD + 16 * group;
  uchar16 set = 0;
  for (int d = -radius; d <= radius; ++d) set |= vload16(0, bits + at + d);
  vstore16(set, 0, grown + at);
}

// Grows along columns and decides: the torso (part 1) where it reaches, else the part drawn there, else the lowest part
// that reaches it. part_image: [w*h], 0 = none.
kernel void part_grow_columns(int n_groups, int width, int height, int stride, int radius,
                              global const uchar* restrict bits, global const uchar* restrict grown,
                              global uchar* restrict part_image) {
  const int group = get_global_id(0);
  const int y = get_global_id(1);
  if (group >= n_groups || y >= height) return;
  const int at = (y + radius) * stride + LC_PAD + 16 * group;
  uchar16 reaching = 0;
  for (int d = -radius; d <= radius; ++d) reaching |= vload16(0, grown + at + d * stride);
  const uchar16 own = vload16(0, bits + at);
  uchar16 set = select(reaching, own, own != (uchar16)0);
  set = select(set, (uchar16)2, (reaching & (uchar16)2) != (uchar16)0);
  set &= (uchar16)(~set + (uchar16)1);  // lowest bit
  // Index of a single bit below 128.
  uchar16 part = 0;
  for (uchar p = 1; p < 8; ++p) part = select(part, (uchar16)p, set == (uchar16)(1 << p));
  if (16 * group + 16 <= width) {
    vstore16(part, 0, part_image + y * width + 16 * group);
  } else {
    uchar lanes[16];
    vstore16(part, 0, lanes);
    for (int k = 0; 16 * group + k < width; ++k) part_image[y * width + 16 * group + k] = lanes[k];
  }
}

#endif
