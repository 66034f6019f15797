// The person's mask (paper, "Input Stream Processing"): difference from the background with shadows left out, the
// network's mask as gate and second opinion, smoothing, decision, trimmed border. One work-item handles 16 pixels of a
// row, so that a CPU's byte lanes are full and rows are read in whole vectors; work-items past the end do nothing.
#include "image/layout.h"
#include "shared/plain_math.h"
#include "shared/wide.h"

#ifdef LC_DEVICE
// The tests compare with the same formulas in C++, rounded after every operation.
#pragma OPENCL FP_CONTRACT OFF

// The first n of 16 values, zero beyond; n <= 0: none.
static inline uchar16 load_bytes(global const uchar* from, int n) {
  if (n >= LC_LANES) return vload16(0, from);
  uchar lanes[LC_LANES];
  for (int k = 0; k < LC_LANES; ++k) lanes[k] = k < n ? from[k] : (uchar)0;
  return vload16(0, lanes);
}

static inline float16 load_floats(global const float* from, int n) {
  if (n >= LC_LANES) return vload16(0, from);
  float lanes[LC_LANES];
  for (int k = 0; k < LC_LANES; ++k) lanes[k] = k < n ? from[k] : 0.0f;
  return vload16(0, lanes);
}

static inline void store_bytes(uchar16 value, global uchar* to, int n) {
  if (n >= LC_LANES) {
    store_uchar16(value, to);
    return;
  }
  uchar lanes[LC_LANES];
  vstore16(value, 0, lanes);
  for (int k = 0; k < n; ++k) to[k] = lanes[k];
}

// Four cells, each of which stands for four pixels.
static inline uchar16 spread_cells(global const uchar* cells, int n) {
  uchar4 four = 0;
  if (n >= 4) {
    four = vload4(0, cells);
  } else {
    if (n > 0) four.x = cells[0];
    if (n > 1) four.y = cells[1];
    if (n > 2) four.z = cells[2];
  }
  return (uchar16)((uchar4)four.x, (uchar4)four.y, (uchar4)four.z, (uchar4)four.w);
}

static inline int is_any(uchar16 value) {
  const ulong2 bits = as_ulong2(value);
  return (bits.x | bits.y) != 0;
}

// Adds how many of the first n are not zero.
static inline void count_bytes(uchar16 values, int n, global int* count) {
  if (!is_any(values)) return;
  uchar lanes[LC_LANES];
  vstore16(values, 0, lanes);
  int sum = 0;
  for (int k = 0; k < LC_LANES; ++k) sum += k < n && lanes[k];
  if (sum) atomic_add(count, sum);
}

static inline float16 squared(float16 x) {
  return x * x;
}

static inline uchar16 quantized(float16 value, float scale) {
  return convert_uchar16(convert_int16_rtz(LC_LESSER((float16)255.0f, scale * value)));
}

// coarse[cell]: rounded mean of the cell's pixels of fine: [w*h]; cells at the border may be smaller. One work-item per
// four cells of a row, n_groups of them in a row.
kernel void coarse_means(int n_groups, int width, int height, int coarse_width, int coarse_height,
                         global const uchar* restrict fine, global uchar* restrict coarse) {
  const int group = get_global_id(0), row = get_global_id(1);
  if (group >= n_groups || row >= coarse_height) return;
  const int x0 = group * LC_LANES, y0 = row * LC_COARSE;
  const int rows = min(LC_COARSE, height - y0);
  global uchar* to = coarse + row * coarse_width + 4 * group;
  ushort16 sum = 0;
  for (int y = 0; y < rows; ++y) sum += convert_ushort16(load_bytes(fine + (y0 + y) * width + x0, width - x0));
  const ushort8 two = sum.even + sum.odd;
  const ushort4 four = two.even + two.odd;
  if (rows == LC_COARSE && x0 + LC_LANES <= width) {
    vstore4(convert_uchar4((four + (ushort)8) >> (ushort)4), 0, to);
    return;
  }
  ushort sums[4];
  vstore4(four, 0, sums);
  for (int k = 0; k < 4 && x0 + k * LC_COARSE < width; ++k) {
    const int area = rows * min(LC_COARSE, width - x0 - k * LC_COARSE);
    to[k] = (uchar)((2 * sums[k] + area) / (2 * area));
  }
}

typedef struct {
  int width, height;             // of the picture
  int x0, n_groups, y0, n_rows;  // what is looked at: columns from x0 (a multiple of 16) on in groups of 16
  int stride, pad;               // of the padded planes: pixel (x, y) is at (y + pad) * stride + pad + x
  int coarse_width;
  int n_layers;  // Gaussians per pixel, at least 1
  int has_network;
  float inverse_gain[3];
  float least_variance;
  float shadow_darkest, doubt_darkest;
  float at_threshold;  // squared deviations to 8 bits
  float trust;
} ForegroundArg;

// layers: per Gaussian four planes [w*h], means of red, green, blue, variance. edge_variance: [w*h]. network: [w*h],
// gate, core: cells. score: padded; 129 and more = person. contrast: padded; colour difference / 2. beyond: padded;
// 255 = not the background, yet outside the gate. doubtful: [w*h]; 255 = person only if it is no shadow that keeps as
// little as doubt_darkest of the light, and the network sees nobody there. counts: of the pixels of the last two.
// Without the network none of these is written.
kernel void foreground_score(ForegroundArg a, global const uchar* restrict rgb, global const uchar* restrict network,
                             global const uchar* restrict gate, global const uchar* restrict core,
                             global const float* restrict layers, global const float* restrict edge_variance,
                             global uchar* restrict score, global uchar* restrict contrast,
                             global uchar* restrict beyond, global uchar* restrict doubtful,
                             global int* restrict counts) {
  const int group = get_global_id(0), row = get_global_id(1);
  if (group >= a.n_groups || row >= a.n_rows) return;
  const int x = a.x0 + group * LC_LANES, y = a.y0 + row;
  const int n = min(LC_LANES, a.width - x);
  const int p = y * a.width + x;
  const int plane = a.width * a.height;
  const uchar16 c0 = load_bytes(rgb + 3 * p, 3 * n);
  const uchar16 c1 = load_bytes(rgb + 3 * p + 16, 3 * n - 16);
  const uchar16 c2 = load_bytes(rgb + 3 * p + 32, 3 * n - 32);
  const float16 r = a.inverse_gain[0] * convert_float16((uchar16)(c0.s0369, c0.scf, c1.s258b, c1.se, c2.s147, c2.sad));
  const float16 g = a.inverse_gain[1] * convert_float16((uchar16)(c0.s147a, c0.sd, c1.s0369, c1.scf, c2.s258, c2.sbe));
  const float16 b = a.inverse_gain[2] * convert_float16((uchar16)(c0.s258b, c0.se, c1.s147a, c1.sd, c2.s0369, c2.scf));
  const float16 edge = load_floats(edge_variance + p, n);
  float16 difference = 1e9f, plain = 1e9f, shadow = 1e9f, dark = 1e9f;
  for (int k = 0; k < a.n_layers; ++k) {
    global const float* layer = layers + 4 * k * plane + p;
    const float16 mr = load_floats(layer, n), mg = load_floats(layer + plane, n);
    const float16 mb = load_floats(layer + 2 * plane, n), trained = load_floats(layer + 3 * plane, n);
    const float16 inverse = 1.0f / (LC_GREATER(trained, (float16)a.least_variance) + edge);
    const float16 squares = squared(r - mr) + squared(g - mg) + squared(b - mb);
    difference = LC_LESSER(difference, squares);
    const float16 unlike = squares * inverse;
    plain = LC_LESSER(plain, unlike);
    // A shadow is the background darkened by one factor in all channels.
    const float16 factor = (r * mr + g * mg + b * mb + 1.0f) / (mr * mr + mg * mg + mb * mb + 1.0f);
    const float16 colour = squared(r - factor * mr) + squared(g - factor * mg) + squared(b - factor * mb);
    const float16 shadowed = select(colour * inverse, (float16)1e9f, factor > 1.0f);
    const float16 light = select(shadowed, (float16)1e9f, factor < a.shadow_darkest);
    shadow = LC_LESSER(shadow, LC_LESSER(unlike, light));
    dark = LC_LESSER(dark, select(shadowed, (float16)1e9f, factor < a.doubt_darkest));
  }
  const uchar16 without = quantized(shadow, a.at_threshold);
  const int at = (y + a.pad) * a.stride + a.pad + x;
  store_uchar16(quantized(sqrt(difference), 0.5f), contrast + at);
  if (!a.has_network) {
    store_uchar16(without, score + at);
    return;
  }
  // What the network calls person is no shadow and needs less of a difference; nobody is outside the gate, and the core
  // is the person in any case.
  const uchar16 m = load_bytes(network + p, n);
  const int cell = y / LC_COARSE * a.coarse_width + x / LC_COARSE;
  const uchar16 may_be = spread_cells(gate + cell, a.coarse_width - x / LC_COARSE);
  const uchar16 is = spread_cells(core + cell, a.coarse_width - x / LC_COARSE);
  const int16 weight = 256 + convert_int16_rtz(convert_float16((convert_int16(m) - 128) * 2) * a.trust);  // in 1/256
  const int16 trusted = min(255, (convert_int16(quantized(plain, a.at_threshold)) * weight) >> 8);
  const uchar16 s = select(without, convert_uchar16(trusted), m >= (uchar)128);
  store_uchar16((s & may_be) | is, score + at);
  const uchar16 differs = select((uchar16)0, ~may_be, without >= (uchar)128);
  store_uchar16(differs, beyond + at);
  const uchar16 unexplained = select((uchar16)0, may_be, (without >= (uchar)128) & (m < (uchar)128));
  const uchar16 in_doubt = select((uchar16)0, unexplained, quantized(dark, a.at_threshold) < (uchar)128);
  store_bytes(in_doubt, doubtful + p, n);
  count_bytes(differs, n, counts);
  count_bytes(in_doubt, n, counts + 1);
}

// Copies the network's mask to where scores are.
kernel void network_score(ForegroundArg a, global const uchar* restrict network, global uchar* restrict score) {
  const int group = get_global_id(0), row = get_global_id(1);
  if (group >= a.n_groups || row >= a.n_rows) return;
  const int x = a.x0 + group * LC_LANES, y = a.y0 + row;
  store_uchar16(load_bytes(network + y * a.width + x, a.width - x), score + (y + a.pad) * a.stride + a.pad + x);
}

static inline int mirrored(int i, int n) {
  if (n == 1) return 0;
  while (i < 0 || i >= n) i = i < 0 ? -i : 2 * n - 2 - i;
  return i;
}

// Fills `reach` pixels around what is looked at: the picture's border mirrors, elsewhere there is nobody. One work-item
// per row, the rows above and below first.
kernel void score_border(ForegroundArg a, int reach, global uchar* restrict score) {
  const int i = get_global_id(0);
  if (i >= a.n_rows + 2 * reach) return;
  const int y = i < reach ? a.y0 - 1 - i : i < 2 * reach ? a.y0 + a.n_rows + i - reach : a.y0 + i - 2 * reach;
  const int x1 = min(a.x0 + a.n_groups * LC_LANES, a.width);
  const int outside = y < a.y0 || y >= a.y0 + a.n_rows;
  const int empty_row = outside && y >= 0 && y < a.height;
  const int from = (mirrored(y, a.height) + a.pad) * a.stride + a.pad;
  const int to = (y + a.pad) * a.stride + a.pad;
  if (outside) {
    for (int x = a.x0; x < x1; ++x) score[to + x] = empty_row ? (uchar)0 : score[from + x];
  }
  for (int k = 0; k < reach; ++k) {
    const int left = a.x0 - 1 - k, right = x1 + k;
    score[to + left] = empty_row || left >= 0 ? (uchar)0 : score[from + mirrored(left, a.width)];
    score[to + right] = empty_row || right < a.width ? (uchar)0 : score[from + mirrored(right, a.width)];
  }
}

// Smoothing in 8.8 bits, along rows. weights: [reach + 1] from the middle on, of 256 in all. One work-item per 16
// pixels of a row, `reach` rows above and below included.
kernel void smooth_rows(ForegroundArg a, int reach, global const ushort* restrict weights,
                        global const uchar* restrict score, global ushort* restrict smoothed) {
  const int group = get_global_id(0), row = get_global_id(1);
  if (group >= a.n_groups || row >= a.n_rows + 2 * reach) return;
  const int at = (a.y0 + row - reach + a.pad) * a.stride + a.pad + a.x0 + group * LC_LANES;
  ushort16 sum = weights[0] * convert_ushort16(vload16(0, score + at));
  for (int k = 1; k <= reach; ++k)
    sum += weights[k] * (convert_ushort16(vload16(0, score + at - k)) + convert_ushort16(vload16(0, score + at + k)));
  store_ushort16(sum, smoothed + at);
}

// Along columns, and the decision: 255 where more than half. decided: padded; 0 beyond the picture's right border.
kernel void decide(ForegroundArg a, int reach, global const ushort* restrict weights,
                   global const ushort* restrict smoothed, global uchar* restrict decided) {
  const int group = get_global_id(0), row = get_global_id(1);
  if (group >= a.n_groups || row >= a.n_rows) return;
  const int x = a.x0 + group * LC_LANES;
  const int at = (a.y0 + row + a.pad) * a.stride + a.pad + x;
  uint16 sum = weights[0] * convert_uint16(vload16(0, smoothed + at)) + 32768u;
  for (int k = 1; k <= reach; ++k)
    sum += weights[k] * (convert_uint16(vload16(0, smoothed + at - k * a.stride)) +
                         convert_uint16(vload16(0, smoothed + at + k * a.stride)));
  const int16 lane = (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const int16 person = ((sum >> 16) > 128u) & (x + lane < a.width);
  store_uchar16(convert_uchar16(person & 255), decided + at);
}

// A pixel that the person covers by less than half still differs from the background. Takes off border pixels whose
// contrast is less than `share` of the largest within two pixels. Not within two pixels of the picture's border, nor
// with share = 0. mask: [w*h].
kernel void trim_border(ForegroundArg a, float share, global const uchar* restrict decided,
                        global const uchar* restrict contrast, global uchar* restrict mask) {
  const int group = get_global_id(0), row = get_global_id(1);
  if (group >= a.n_groups || row >= a.n_rows) return;
  const int x = a.x0 + group * LC_LANES, y = a.y0 + row;
  const int at = (y + a.pad) * a.stride + a.pad + x;
  uchar16 person = vload16(0, decided + at);
  if (share > 0.0f && y >= 2 && y < a.height - 2 && is_any(person)) {
    uchar16 inner = 255;
    for (int dy = -1; dy <= 1; ++dy) {
      const int beside = at + dy * a.stride;
      inner &= vload16(0, decided + beside - 1) & vload16(0, decided + beside) & vload16(0, decided + beside + 1);
    }
    if (is_any(person & ~inner)) {
      uchar16 largest = 0;
      for (int dy = -2; dy <= 2; ++dy) {
        for (int dx = -2; dx <= 2; ++dx) largest = max(largest, vload16(0, contrast + at + dy * a.stride + dx));
      }
      const int16 lane = (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
      const int16 border = (convert_int16(person & ~inner) != 0) & (x + lane >= 2) & (x + lane < a.width - 2);
      const int16 weak = convert_float16(vload16(0, contrast + at)) < share * convert_float16(largest);
      person = select(person, (uchar16)0, convert_uchar16(border & weak & 255) != (uchar16)0);
    }
  }
  store_bytes(person, mask + y * a.width + x, a.width - x);
}

#endif
