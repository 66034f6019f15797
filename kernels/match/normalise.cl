// Local normalisation: what is left of a picture when mean and contrast of the 25 x 25 pixels around each pixel (of
// half and quarter resolution 13 x 13 and 7 x 7) are taken out, which lighting changes and texture does not. Pixels
// that are not of the person count in no window.
#include "match/layout.h"
#include "shared/bits.h"
#include "shared/plain_math.h"
#include "shared/wide.h"

#if LC_CPU
typedef float16 window_t;
#define LOAD_PIXELS(p) vload16(0, p)
#define SUMS_SPACE global
// Rows of a work-item: windows are summed anew at the first and carried on from there.
#define BAND LC_MATCH_BAND
#else
typedef float window_t;
#define LOAD_PIXELS(p) (*(p))
#define SUMS_SPACE local
// A work-group has TILE_WIDTH x TILE pixels and, at their sides, what their windows reach.
#define TILE LC_MATCH_TILE
#ifndef TILE_WIDTH
#define TILE_WIDTH TILE
#endif
#define TILE_ITEMS (TILE_WIDTH * TILE)
// Pixels with sides, and how many of them a work-item loads at most.
#define WITH_SIDES ((TILE_WIDTH + 2 * LC_MATCH_RADIUS) * (TILE + 2 * LC_MATCH_RADIUS))
#define PER_ITEM ((WITH_SIDES + TILE_ITEMS - 1) / TILE_ITEMS)
#endif

// Sums over a window: pixels that count, their light, its square.
typedef struct {
  window_t n, s, ss;
} Sums;

static inline void add_row(Sums* sums, window_t light, window_t weight) {
  sums->n += weight;
  sums->s += light;
  sums->ss += light * light;
}

// (light - mean) / sqrt(variance + floor) of neighbouring pixels, 0 where there is nobody and nowhere else. sums: three
// planes of column sums.
static inline window_t normalised(SUMS_SPACE const float* restrict sums, int plane, int radius, window_t light,
                                  window_t weight, float variance_floor) {
  window_t n = 0.0f, s = 0.0f, ss = 0.0f;
#if !LC_CPU
#pragma unroll 5
#endif
  for (int k = -radius; k <= radius; ++k) {
    n += LOAD_PIXELS(sums + k);
    s += LOAD_PIXELS(sums + plane + k);
    ss += LOAD_PIXELS(sums + 2 * plane + k);
  }
  n = LC_GREATER(n, (window_t)1.0f);
  const window_t mean = s / n;
  const window_t unbounded = ss / n - mean * mean;
  const window_t variance = LC_GREATER(unbounded, (window_t)0.0f);
  const window_t contrast = (light - mean) / sqrt(variance + variance_floor), none = 0.0f, tiny = 1e-12f;
  return (contrast != none ? contrast : tiny) * weight;
}

// light, weight: the box of a level, from `at` on. Out: normal = box, likewise, 0 in the margins.
#if LC_CPU

static inline void remove_row(Sums* sums, window_t light, window_t weight) {
  sums->n -= weight;
  sums->s -= light;
  sums->ss -= light * light;
}

// From row y - 1 to row y of a band that begins at row `first`. light, weight: at the column's top.
static inline void move_down(Sums* sums, int y, int first, MatchBox box, int radius, global const float* restrict light,
                             global const float* restrict weight) {
  const int enters = (y + radius) * box.width, leaves = (y - radius - 1) * box.width;
  if (y + radius < box.height) add_row(sums, LOAD_PIXELS(light + enters), LOAD_PIXELS(weight + enters));
  if (y > first && y - radius - 1 >= 0) remove_row(sums, LOAD_PIXELS(light + leaves), LOAD_PIXELS(weight + leaves));
}

// What a band's first row has in its window before move_down.
static inline Sums sums_above(int first, MatchBox box, int radius, global const float* restrict light,
                              global const float* restrict weight) {
  Sums sums = {0.0f, 0.0f, 0.0f};
  for (int y = max(first - radius, 0); y < min(first + radius, box.height); ++y)
    add_row(&sums, LOAD_PIXELS(light + y * box.width), LOAD_PIXELS(weight + y * box.width));
  return sums;
}

// Over the bands. sums: scratch, three rows of the box and LC_MATCH_PAD for each band.
kernel void normalise(MatchBox box, int level, int at, float variance_floor, global const float* restrict light,
                      global const float* restrict weight, global float* restrict sums, global float* restrict normal) {
  const int first = BAND * (int)get_global_id(0);
  if (first >= box.height) return;
  const int width = box.width, plane = width + LC_MATCH_PAD;
  const int radius = LC_MATCH_RADIUS >> level, margin = LC_MATCH_MARGIN >> level;
  light += at;
  weight += at;
  normal += at;
  sums += get_global_id(0) * 3 * plane + LC_MATCH_PAD / 2;
  for (int x = 0; x < width; x += 16) {
    const Sums above = sums_above(first, box, radius, light + x, weight + x);
    store16(above.n, sums + x);
    store16(above.s, sums + plane + x);
    store16(above.ss, sums + 2 * plane + x);
  }
  const int16 lane = (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  for (int y = first; y < min(first + BAND, box.height); ++y) {
    for (int x = 0; x < width; x += 16) {
      Sums column = {vload16(0, sums + x), vload16(0, sums + plane + x), vload16(0, sums + 2 * plane + x)};
      move_down(&column, y, first, box, radius, light + x, weight + x);
      store16(column.n, sums + x);
      store16(column.s, sums + plane + x);
      store16(column.ss, sums + 2 * plane + x);
    }
    for (int x = 0; x < width; x += 16) {
      const int p = y * width + x;
      const int16 inside = x + lane >= margin && x + lane < width - margin;
      const float16 counts = select((float16)0.0f, vload16(0, weight + p), inside);
      float16 value = 0.0f;
      if (any_of_16(counts > 0.0f))
        value =
            select(value, normalised(sums + x, plane, radius, vload16(0, light + p), counts, variance_floor), inside);
      store16(value, normal + p);
    }
  }
}

#else

// A tile, by TILE_ITEMS work-items: `id` of them.
// near: [LC_MATCH_TILE_LOCAL(TILE_WIDTH)]. somebody: 0 before; whether a pixel of the tile counts.
static inline void normalise_tile(int tile_x, int tile_y, int id, MatchBox box, int level, float variance_floor,
                                  global const float* restrict light, global const float* restrict weight,
                                  local float* near, local int* somebody, global float* restrict normal) {
  local float* lights = near;
  local float* weights = lights + WITH_SIDES;
  local float* sums = weights + WITH_SIDES;  // over the rows around each of TILE
  const int radius = LC_MATCH_RADIUS >> level, margin = LC_MATCH_MARGIN >> level;
  const int reach = TILE_WIDTH + 2 * radius, n_near = reach * (TILE + 2 * radius);
  const int x0 = tile_x * TILE_WIDTH - radius, y0 = tile_y * TILE - radius;
  float near_light[PER_ITEM], near_weight[PER_ITEM];  // loaded all at once: none waits for another
#pragma unroll
  for (int k = 0; k < PER_ITEM; ++k) {
    const int i = id + k * TILE_ITEMS, at_x = x0 + i % reach, at_y = y0 + i / reach;
    const bool inside = i < n_near && at_x >= 0 && at_x < box.width && at_y >= 0 && at_y < box.height;
    near_light[k] = inside ? light[at_y * box.width + at_x] : 0.0f;
    near_weight[k] = inside ? weight[at_y * box.width + at_x] : 0.0f;
  }
#pragma unroll
  for (int k = 0; k < PER_ITEM; ++k) {
    const int i = id + k * TILE_ITEMS;
    if (i >= n_near) continue;
    lights[i] = near_light[k];
    weights[i] = near_weight[k];
    const int own_x = i % reach - radius, own_y = i / reach - radius;
    if (near_weight[k] > 0.0f && own_x >= 0 && own_x < TILE_WIDTH && own_y >= 0 && own_y < TILE) *somebody = 1;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const int counts_any = *somebody;  // otherwise nobody asks for sums
  for (int i = id; counts_any && i < TILE * reach; i += TILE_ITEMS) {
    Sums column = {0.0f, 0.0f, 0.0f};
#pragma unroll 5
    for (int k = 0; k <= 2 * radius; ++k) add_row(&column, lights[i + k * reach], weights[i + k * reach]);
    sums[i] = column.n;
    sums[TILE * reach + i] = column.s;
    sums[2 * TILE * reach + i] = column.ss;
  }
  barrier(CLK_LOCAL_MEM_FENCE);
  const int x = tile_x * TILE_WIDTH + id % TILE_WIDTH, y = tile_y * TILE + id / TILE_WIDTH;
  if (x < box.width && y < box.height) {
    const int here = id / TILE_WIDTH * reach + id % TILE_WIDTH + radius;
    const int middle = here + radius * reach;
    const int counts = x >= margin && x < box.width - margin && weights[middle] > 0.0f;
    normal[y * box.width + x] =
        counts ? normalised(sums + here, TILE * reach, radius, lights[middle], weights[middle], variance_floor) : 0.0f;
  }
}

// Over (box.width, box.height).
kernel __attribute__((reqd_work_group_size(TILE, TILE, 1))) void normalise(MatchBox box, int level, int at,
                                                                           float variance_floor,
                                                                           global const float* restrict light,
                                                                           global const float* restrict weight,
                                                                           global float* restrict normal) {
  local float near[LC_MATCH_TILE_LOCAL(TILE_WIDTH)];
  local int somebody;
  if (get_local_id(0) == 0 && get_local_id(1) == 0) somebody = 0;
  barrier(CLK_LOCAL_MEM_FENCE);
  normalise_tile(get_group_id(0), get_group_id(1), get_local_id(1) * TILE + get_local_id(0), box, level, variance_floor,
                 light + at, weight + at, near, &somebody, normal + at);
}

#endif
