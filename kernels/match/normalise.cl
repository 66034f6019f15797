// Local normalisation: what is left of a picture when mean and contrast of the 25 x 25 pixels around each pixel are
// taken out, which lighting changes and texture does not. Pixels that are not of the person count in no window.
#include "match/layout.h"
#include "match/wide.h"

// Rows of a work-item: windows are summed anew at the first and carried on from there.
#define BAND LC_MATCH_BAND(LC_CPU)

#if LC_CPU
typedef float16 pix_t;
#define LOAD(p) vload16(0, p)
#else
typedef float pix_t;
#define LOAD(p) (*(p))
#endif

// Sums over a window: pixels that count, their light, its square.
typedef struct {
  pix_t n, s, ss;
} Sums;

static inline void add_row(Sums* sums, pix_t light, pix_t weight) {
  sums->n += weight;
  sums->s += light;
  sums->ss += light * light;
}

static inline void remove_row(Sums* sums, pix_t light, pix_t weight) {
  sums->n -= weight;
  sums->s -= light;
  sums->ss -= light * light;
}

// From row y - 1 to row y of a band that begins at row `first`. light, weight: at the column's top.
static inline void move_down(Sums* sums, int y, int first, MatchBox box, global const float* restrict light,
                             global const float* restrict weight) {
  const int enters = (y + LC_MATCH_RADIUS) * box.width, leaves = (y - LC_MATCH_RADIUS - 1) * box.width;
  if (y + LC_MATCH_RADIUS < box.height) add_row(sums, LOAD(light + enters), LOAD(weight + enters));
  if (y > first && y - LC_MATCH_RADIUS - 1 >= 0) remove_row(sums, LOAD(light + leaves), LOAD(weight + leaves));
}

// What a band's first row has in its window before move_down.
static inline Sums sums_above(int first, MatchBox box, global const float* restrict light,
                              global const float* restrict weight) {
  Sums sums = {0.0f, 0.0f, 0.0f};
  for (int y = max(first - LC_MATCH_RADIUS, 0); y < min(first + LC_MATCH_RADIUS, box.height); ++y)
    add_row(&sums, LOAD(light + y * box.width), LOAD(weight + y * box.width));
  return sums;
}

// (light - mean) / sqrt(variance + floor) of neighbouring pixels, 0 where there is nobody. sums: three planes of column
// sums.
static inline pix_t normalised(global const float* restrict sums, int plane, pix_t light, pix_t weight,
                               float variance_floor) {
  pix_t n = 0.0f, s = 0.0f, ss = 0.0f;
#pragma unroll
  for (int k = -LC_MATCH_RADIUS; k <= LC_MATCH_RADIUS; ++k) {
    n += LOAD(sums + k);
    s += LOAD(sums + plane + k);
    ss += LOAD(sums + 2 * plane + k);
  }
  n = fmax(n, 1.0f);
  const pix_t mean = s / n;
  const pix_t variance = fmax(ss / n - mean * mean, 0.0f);
  return (light - mean) / sqrt(variance + variance_floor) * weight;
}

static inline int in_margin(int x, int width) {
  return x < LC_MATCH_MARGIN || x >= width - LC_MATCH_MARGIN;
}

// light, weight: box. Out: normal = box, 0 in the margins.
#if LC_CPU

// Over the bands. sums: scratch, three rows of the box for each band.
kernel void normalise(MatchBox box, float variance_floor, global const float* restrict light,
                      global const float* restrict weight, global float* restrict sums, global float* restrict normal) {
  const int first = BAND * (int)get_global_id(0);
  if (first >= box.height) return;
  const int width = box.width;
  sums += get_global_id(0) * 3 * width;
  for (int x = 0; x < width; x += 16) {
    const Sums above = sums_above(first, box, light + x, weight + x);
    store16(above.n, sums + x);
    store16(above.s, sums + width + x);
    store16(above.ss, sums + 2 * width + x);
  }
  for (int y = first; y < min(first + BAND, box.height); ++y) {
    for (int x = 0; x < width; x += 16) {
      Sums column = {vload16(0, sums + x), vload16(0, sums + width + x), vload16(0, sums + 2 * width + x)};
      move_down(&column, y, first, box, light + x, weight + x);
      store16(column.n, sums + x);
      store16(column.s, sums + width + x);
      store16(column.ss, sums + 2 * width + x);
    }
    for (int x = 0; x < width; x += 16) {
      const int at = y * width + x;
      const float16 counts = vload16(0, weight + at);
      float16 value = 0.0f;
      if (!in_margin(x, width) && any(counts > 0.0f))
        value = normalised(sums + x, width, vload16(0, light + at), counts, variance_floor);
      store16(value, normal + at);
    }
  }
}

#else

// Over (box.width, bands). Out: sums over the 25 rows around each pixel, 3 planes of the box.
kernel void column_sums(MatchBox box, global const float* restrict light, global const float* restrict weight,
                        global float* restrict sums) {
  const int x = get_global_id(0);
  const int first = BAND * (int)get_global_id(1);
  if (x >= box.width || first >= box.height) return;
  const int plane = box.width * box.height;
  Sums column = sums_above(first, box, light + x, weight + x);
  for (int y = first; y < min(first + BAND, box.height); ++y) {
    const int at = y * box.width + x;
    move_down(&column, y, first, box, light + x, weight + x);
    sums[at] = column.n;
    sums[plane + at] = column.s;
    sums[2 * plane + at] = column.ss;
  }
}

// Over (box.width, box.height).
kernel void normalise_rows(MatchBox box, float variance_floor, global const float* restrict light,
                           global const float* restrict weight, global const float* restrict sums,
                           global float* restrict normal) {
  const int x = get_global_id(0), y = get_global_id(1);
  if (x >= box.width || y >= box.height) return;
  const int at = y * box.width + x;
  normal[at] = in_margin(x, box.width) || !(weight[at] > 0.0f)
                   ? 0.0f
                   : normalised(sums + at, box.width * box.height, light[at], weight[at], variance_floor);
}

#endif

// Over (half_width / 8, half_height) of a level, eight pixels each. It lies at `to` in the pyramid, the level above at
// `from`: means of 2 x 2 pixels.
kernel void halve(int width, int half_width, int half_height, int from, int to, global float* restrict pyramid) {
  const int x = 8 * (int)get_global_id(0), y = get_global_id(1);
  if (x >= half_width || y >= half_height) return;
  global const float* p = pyramid + from + 2 * y * width + 2 * x;
  const float16 top = vload16(0, p), bottom = vload16(0, p + width);
  store8(0.25f * (top.even + top.odd + bottom.even + bottom.odd), pyramid + to + y * half_width + x);
}

// The same for depths: the first of the 2 x 2 pixels.
kernel void halve_depth(int width, int half_width, int half_height, int from, int to, global float* restrict pyramid) {
  const int x = 8 * (int)get_global_id(0), y = get_global_id(1);
  if (x >= half_width || y >= half_height) return;
  const float16 depth = vload16(0, pyramid + from + 2 * y * width + 2 * x);
  store8(depth.even, pyramid + to + y * half_width + x);
}
