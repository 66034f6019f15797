// Where the camera's picture shows each visible vertex: 8 x 8 patches of the textured actor are moved, coarse to fine,
// until they lie on the camera's picture (inverse compositional alignment; Baker and Matthews 2004). On a CPU several
// patches at a time, a row of two in one vector; on a GPU a patch by eight work-items, a column each.
#include "match/facing.h"
#include "match/layout.h"
#include "shared/plain_math.h"

#define PATCH LC_MATCH_PATCH
#define HALF (PATCH / 2)
#define LEAST_PIXELS 20.0f  // of a patch that count

typedef struct {
  int width, height;
  global const float* actor;   // normalised
  global const float* depth;   // mm
  global const float* camera;  // normalised
} Level;

// Whether a patch around the pixel lies within the level.
static inline int has_patch(const Level* level, int x, int y) {
  return x >= HALF + 2 && y >= HALF + 2 && x < level->width - HALF - 2 && y < level->height - HALF - 2;
}

typedef struct {
  float xx, xy, yy, n, dx, dy, correlation;
} Aligned;  // see align()

// out: the vertex's match, of which 7 is there; u, v: its pixel.
static inline void write_match(Aligned m, PatchOptions options, float u, float v, global float* restrict out) {
  if (!(m.n > 0.0f) || !(m.correlation >= options.min_correlation)) return;
  if (!(m.dx * m.dx + m.dy * m.dy <= options.max_move_px * options.max_move_px)) return;

  // S (S + softness)^-1: 1 along directions in which the patch has structure, 0 along those in which it has none.
  const float sxx = m.xx / m.n, sxy = m.xy / m.n, syy = m.yy / m.n;
  const float det = (sxx + options.softness) * (syy + options.softness) - sxy * sxy;
  const float wxx = (sxx * (syy + options.softness) - sxy * sxy) / det;
  const float wyy = (syy * (sxx + options.softness) - sxy * sxy) / det;
  const float wxy = options.softness * sxy / det;
  const float a = sqrt(fmax(wxx, 1e-6f));
  const float b = wxy / a;
  const float c = sqrt(fmax(wyy - b * b, 0.0f));

  const float scale = (float)(1 << options.level), wanted = out[LC_MATCH_SEEN_PX];
  const float certain = (m.correlation - options.min_correlation) / (1.0f - options.min_correlation);
  vstore8((float8)(u + m.dx * scale, v + m.dy * scale, a, b, c, certain * wanted, m.correlation, wanted), 0, out);
}

// px^2 that a vertex stands for: its area as the camera sees it.
static inline float seen_px_of(int i, float focal_px, global const float* restrict positions,
                               global const float* restrict normals, global const float* restrict areas,
                               global const float* restrict share) {
  const float3 p = vload3(i, positions);
  return share[i] * seen_area_px(areas[i], fmax(facing_at(p, vload3(i, normals)), 0.0f), focal_px, p.z);
}

#if LC_CPU
// Patches at a time. Two vectors hide each other's latency; with 16 registers of eight floats one is enough.
#if LC_VECTOR == 16
#define TOGETHER 4
typedef float4 each_t;  // a value of each patch
#else
#define TOGETHER 2
typedef float2 each_t;
#endif
#else
typedef float each_t;
#endif

static inline each_t at_most_2(each_t step) {
  const each_t least = -2.0f, most = 2.0f, limited = LC_GREATER(step, least);
  return LC_LESSER(limited, most);
}

// Of patches a and b, from their sums over n pixels.
static inline each_t correlation_of(each_t n, each_t a, each_t b, each_t aa, each_t bb, each_t ab) {
  const each_t ma = a / n, mb = b / n;
  const each_t va = aa / n - ma * ma, vb = bb / n - mb * mb;
  return (ab / n - ma * mb) / sqrt((va + 0.01f) * (vb + 0.01f));
}

#if LC_CPU
#include "match/patch_rows.h"
#else
typedef float row_t;  // one pixel
#endif

// Of the camera's picture between its pixels: how much is of the person, the mean of that times as much. Where nobody
// is the picture is 0 and tells nothing: were it a grey, the silhouette's edge would draw limbs and shoes inwards.
typedef struct {
  row_t seen, counts;
} Seen;

static inline Seen seen_pixel(row_t seen) {
  const row_t none = 0.0f, one = 1.0f;
  const Seen s = {seen, seen != none ? one : none};
  return s;
}

static inline Seen between(Seen a, Seen b, row_t share) {
  const Seen s = {a.seen + share * (b.seen - a.seen), a.counts + share * (b.counts - a.counts)};
  return s;
}

// Of what is of the person; 0 where nobody is.
static inline row_t mean_seen(Seen s) {
  const row_t least = 1e-6f, counts = LC_GREATER(s.counts, least);
  return s.seen / counts;
}

#if LC_CPU

typedef struct {
  each_t xx, xy, yy;  // sums of gradient products
  each_t n;           // pixels that count
} Structure;

// Rows moved by fx of a pixel.
static inline Seen moved_rows(global const float* restrict camera, Places p, int by, row_t fx) {
  return between(seen_pixel(rows_at(camera, p, by)), seen_pixel(rows_at(camera, p, by + 1)), fx);
}

// Moves (dx, dy), px of this level, of the patches around the pixels (x, y), which it has. Returns their structure;
// n = 0 where there is too little to see. correlation: of the actor's patch and the camera's at the end. match_vertex()
// of patch_columns.h does the same a column at a time; tests/match/texture_matcher_test.cpp holds them to each other.
static Structure align(const Level* level, each_int_t x, each_int_t y, each_t depth, PatchOptions options, each_t* dx,
                       each_t* dy, each_t* correlation) {
  const each_t zero = 0.0f;
  const int width = level->width;
  const Places at = places_of((y - HALF) * width + x - HALF);
  const row_t z = along_rows(depth);
  *dx = *dy = *correlation = zero;
  row_t actor[PATCH], gx[PATCH], gy[PATCH], inside[PATCH];
  row_t sxx = 0.0f, sxy = 0.0f, syy = 0.0f, sn = 0.0f;
  global const float* a = level->actor;
  global const float* d = level->depth;
  // Of the rows above and here; each is loaded once.
  row_t a_above = rows_at(a, at, -width), a_here = rows_at(a, at, 0);
  row_t far_above = far_from(rows_at(d, at, -width), z), far_here = far_from(rows_at(d, at, 0), z);
  for (int r = 0; r < PATCH; ++r) {
    const int row = r * width;
    const row_t a_below = rows_at(a, at, row + width), far_below = far_from(rows_at(d, at, row + width), z);
    const row_t beside = larger(far_from(rows_at(d, at, row - 1), z), far_from(rows_at(d, at, row + 1), z));
    const row_t far = larger(far_here, larger(beside, larger(far_above, far_below)));
    inside[r] = far < options.depth_range_mm ? (row_t)1.0f : (row_t)0.0f;
    actor[r] = a_here;
    gx[r] = 0.5f * inside[r] * (rows_at(a, at, row + 1) - rows_at(a, at, row - 1));
    gy[r] = 0.5f * inside[r] * (a_below - a_above);
    a_above = a_here;
    a_here = a_below;
    far_above = far_here;
    far_here = far_below;
    sxx += gx[r] * gx[r];
    sxy += gx[r] * gy[r];
    syy += gy[r] * gy[r];
    sn += inside[r];
  }
  Structure s = {sum_of_rows(sxx), sum_of_rows(sxy), sum_of_rows(syy), sum_of_rows(sn)};
  each_int_t sees = s.n >= LEAST_PIXELS;
  const each_t soft = options.softness * s.n;
  const each_t hxx = s.xx + soft, hyy = s.yy + soft;
  const each_t inv = 1.0f / (hxx * hyy - s.xy * s.xy);
  for (int k = 0; k <= options.iterations; ++k) {
    const each_t px = EACH_REAL(x - HALF) + *dx, py = EACH_REAL(y - HALF) + *dy;
    const each_t fx0 = LC_FLOOR(px), fy0 = LC_FLOOR(py);
    sees = sees && fx0 >= 0.0f && fy0 >= 0.0f && fx0 + (PATCH + 1) < (float)width &&
           fy0 + (PATCH + 1) < (float)level->height;
    if (!any(sees)) break;
    const each_int_t none = 0;
    const Places c = places_of(sees ? EACH_INT(fy0) * width + EACH_INT(fx0) : none);
    const row_t fx = along_rows(px - fx0), fy = along_rows(py - fy0);
    Seen top = moved_rows(level->camera, c, 0, fx);
    if (k == options.iterations) {
      row_t n = 0.0f, a1 = 0.0f, b1 = 0.0f, aa = 0.0f, bb = 0.0f, ab = 0.0f;
      for (int r = 0; r < PATCH; ++r) {
        const Seen bottom = moved_rows(level->camera, c, (r + 1) * width, fx), here = between(top, bottom, fy);
        const row_t counts = inside[r] * here.counts, a = counts * actor[r], b = inside[r] * here.seen;
        top = bottom;
        n += counts;
        a1 += a;
        b1 += b;
        aa += a * actor[r];
        bb += b * mean_seen(here);
        ab += b * actor[r];
      }
      const each_t n_seen = sum_of_rows(n);
      *correlation = n_seen < LEAST_PIXELS ? zero
                                           : correlation_of(n_seen, sum_of_rows(a1), sum_of_rows(b1), sum_of_rows(aa),
                                                            sum_of_rows(bb), sum_of_rows(ab));
      break;
    }
    row_t ex = 0.0f, ey = 0.0f, n = 0.0f;
    for (int r = 0; r < PATCH; ++r) {
      const Seen bottom = moved_rows(level->camera, c, (r + 1) * width, fx), here = between(top, bottom, fy);
      const row_t e = here.seen - here.counts * actor[r];
      top = bottom;
      ex += gx[r] * e;
      ey += gy[r] * e;
      n += inside[r] * here.counts;
    }
    const each_t n_seen = sum_of_rows(n), least = LEAST_PIXELS;
    const each_t step = inv * s.n / LC_GREATER(n_seen, least);
    const each_t bx = sum_of_rows(ex), by = sum_of_rows(ey);
    *dx -= at_most_2((hyy * bx - s.xy * by) * step);
    *dy -= at_most_2((hxx * by - s.xy * bx) * step);
  }
  s.n = sees ? s.n : zero;
  return s;
}

#else
#include "match/patch_columns.h"
#endif

// box, actor, depth: of the level; camera likewise, from `at` on.
// areas [n] mm^2 of the template around each vertex; share [n] its factor, 0 = never matched. Out: matches
// [LC_MATCH*n].
// Over the vertices: on CPUs LC_MATCH_VERTICES a work-item, on GPUs eight work-items each, a multiple of that a group;
// sums: one for each of the group.
#if LC_CPU
kernel void match_patches(int n, MatchBox box, PatchOptions options, int at, float focal_px,
                          global const float* restrict positions, global const float* restrict normals,
                          global const int* restrict visible, global const float* restrict projected,
                          global const float* restrict areas, global const float* restrict share,
                          global const float* restrict actor, global const float* restrict depth,
                          global const float* restrict camera, global float* restrict matches) {
  const int first = (int)get_global_id(0) * LC_MATCH_VERTICES;
  const Level level = {box.width, box.height, actor, depth, camera + at};
  int vertices[LC_MATCH_VERTICES + TOGETHER], xs[LC_MATCH_VERTICES + TOGETHER], ys[LC_MATCH_VERTICES + TOGETHER];
  int n_patches = 0;
  for (int i = first; i < min(first + LC_MATCH_VERTICES, n); ++i) {
    global float* out = matches + LC_MATCH * i;
    vstore8((float8)0.0f, 0, out);
    if (!visible[i] || !(share[i] > 0.0f)) continue;
    out[LC_MATCH_SEEN_PX] = seen_px_of(i, focal_px, positions, normals, areas, share);
    const int x = ((int)LC_RINT(projected[4 * i]) - box.x) >> options.level;
    const int y = ((int)LC_RINT(projected[4 * i + 1]) - box.y) >> options.level;
    if (!has_patch(&level, x, y)) continue;
    vertices[n_patches] = i;
    xs[n_patches] = x;
    ys[n_patches] = y;
    ++n_patches;
  }
  for (int k = 0; k < n_patches; k += TOGETHER) {
    each_t dx, dy, correlation, z;
    each_int_t x, y;
    for (int j = 0; j < TOGETHER; ++j) {
      const int patch = min(k + j, n_patches - 1);
      x[j] = xs[patch];
      y[j] = ys[patch];
      z[j] = projected[4 * vertices[patch] + 3];
    }
    const Structure s = align(&level, x, y, z, options, &dx, &dy, &correlation);
    for (int j = 0; j < min(TOGETHER, n_patches - k); ++j) {
      const int i = vertices[k + j];
      const Aligned one = {s.xx[j], s.xy[j], s.yy[j], s.n[j], dx[j], dy[j], correlation[j]};
      write_match(one, options, projected[4 * i], projected[4 * i + 1], matches + LC_MATCH * i);
    }
  }
}
#else
kernel void match_patches(int n, MatchBox box, PatchOptions options, int at, float focal_px,
                          global const float* restrict positions, global const float* restrict normals,
                          global const int* restrict visible, global const float* restrict projected,
                          global const float* restrict areas, global const float* restrict share,
                          global const float* restrict actor, global const float* restrict depth,
                          global const float* restrict camera, global float* restrict matches, local float4* sums) {
  const Level level = {box.width, box.height, actor, depth, camera + at};
  match_vertex(get_global_id(0) / PATCH, n, level, options, focal_px, positions, normals, visible, projected, areas,
               share, sums, matches, box.x, box.y);
}
#endif
