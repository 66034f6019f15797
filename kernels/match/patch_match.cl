// Where the camera's picture shows each visible vertex: 8 x 8 patches of the textured actor are moved, coarse to fine,
// until they lie on the camera's picture (inverse compositional alignment; Baker and Matthews 2004).
#include "match/layout.h"

typedef struct {
  float xx, xy, yy;  // sums of gradient products
  float n;           // pixels that count
} Structure;

typedef struct {
  int width, height;
  global const float* actor;   // normalised
  global const float* depth;   // mm
  global const float* camera;  // normalised
} Level;

#define PATCH 8
#define HALF (PATCH / 2)

static inline float sum8(float8 v) {
  const float4 a = v.lo + v.hi;
  const float2 b = a.lo + a.hi;
  return b.x + b.y;
}

// A row of the camera's picture moved by fx of a pixel; p: its first pixel.
static inline float8 moved_row(global const float* restrict p, float fx) {
  return vload8(0, p) + fx * (vload8(0, p + 1) - vload8(0, p));
}

// Moves (dx, dy), px of this level, of the patch around pixel (x, y). Returns its structure; n = 0 when there is too
// little to see. correlation: of the two patches at the end.
static Structure align(const Level* level, int x, int y, float z, PatchOptions options, float* dx, float* dy,
                       float* correlation) {
  Structure s = {0.0f, 0.0f, 0.0f, 0.0f};
  *correlation = 0.0f;
  const int width = level->width;
  if (x < HALF + 2 || y < HALF + 2 || x >= width - HALF - 2 || y >= level->height - HALF - 2) return s;
  const int at = (y - HALF) * width + x - HALF;
  float8 actor[PATCH], gx[PATCH], gy[PATCH], inside[PATCH];
  float8 sxx = 0.0f, sxy = 0.0f, syy = 0.0f, sn = 0.0f;
  for (int r = 0; r < PATCH; ++r) {
    global const float* a = level->actor + at + r * width;
    global const float* d = level->depth + at + r * width;
    const float8 far =
        fmax(fabs(vload8(0, d) - z), fmax(fmax(fabs(vload8(0, d - 1) - z), fabs(vload8(0, d + 1) - z)),
                                          fmax(fabs(vload8(0, d - width) - z), fabs(vload8(0, d + width) - z))));
    inside[r] = select((float8)0.0f, (float8)1.0f, far < options.depth_range_mm);
    actor[r] = vload8(0, a);
    gx[r] = 0.5f * inside[r] * (vload8(0, a + 1) - vload8(0, a - 1));
    gy[r] = 0.5f * inside[r] * (vload8(0, a + width) - vload8(0, a - width));
    sxx += gx[r] * gx[r];
    sxy += gx[r] * gy[r];
    syy += gy[r] * gy[r];
    sn += inside[r];
  }
  s.n = sum8(sn);
  if (s.n < 20.0f) {
    s.n = 0.0f;
    return s;
  }
  s.xx = sum8(sxx);
  s.xy = sum8(sxy);
  s.yy = sum8(syy);
  const float soft = options.softness * s.n;
  const float hxx = s.xx + soft, hyy = s.yy + soft;
  const float inv = 1.0f / (hxx * hyy - s.xy * s.xy);
  for (int k = 0; k <= options.iterations; ++k) {
    const float px = (float)(x - HALF) + *dx, py = (float)(y - HALF) + *dy;
    const float fx0 = floor(px), fy0 = floor(py);
    if (!(fx0 >= 0.0f && fy0 >= 0.0f && fx0 + PATCH + 1 < (float)width && fy0 + PATCH + 1 < (float)level->height)) {
      s.n = 0.0f;
      return s;
    }
    global const float* c = level->camera + (int)fy0 * width + (int)fx0;
    const float fx = px - fx0, fy = py - fy0;
    if (k == options.iterations) {
      float8 a1 = 0.0f, b1 = 0.0f, aa = 0.0f, bb = 0.0f, ab = 0.0f;
      float8 top = moved_row(c, fx);
      for (int r = 0; r < PATCH; ++r) {
        const float8 bottom = moved_row(c + (r + 1) * width, fx);
        const float8 a = inside[r] * actor[r], b = inside[r] * (top + fy * (bottom - top));
        top = bottom;
        a1 += a;
        b1 += b;
        aa += a * a;
        bb += b * b;
        ab += a * b;
      }
      const float ma = sum8(a1) / s.n, mb = sum8(b1) / s.n;
      const float va = sum8(aa) / s.n - ma * ma, vb = sum8(bb) / s.n - mb * mb;
      *correlation = (sum8(ab) / s.n - ma * mb) / sqrt((va + 0.01f) * (vb + 0.01f));
      return s;
    }
    float8 ex = 0.0f, ey = 0.0f;
    float8 top = moved_row(c, fx);
    for (int r = 0; r < PATCH; ++r) {
      const float8 bottom = moved_row(c + (r + 1) * width, fx);
      const float8 e = top + fy * (bottom - top) - actor[r];
      top = bottom;
      ex += gx[r] * e;
      ey += gy[r] * e;
    }
    const float bx = sum8(ex), by = sum8(ey);
    *dx -= clamp((hyy * bx - s.xy * by) * inv, -2.0f, 2.0f);
    *dy -= clamp((hxx * by - s.xy * bx) * inv, -2.0f, 2.0f);
  }
  return s;
}

// Over the vertices. box, actor, depth: of the level; camera likewise, from `at` on. areas [n] mm^2 of the template
// around each vertex; share [n] its factor, 0 = never matched. Out: matches [LC_MATCH*n].
kernel void match_patches(int n, MatchBox box, PatchOptions options, int at, float focal_px,
                          global const float* restrict positions, global const float* restrict normals,
                          global const int* restrict visible, global const float* restrict projected,
                          global const float* restrict areas, global const float* restrict share,
                          global const float* restrict actor, global const float* restrict depth,
                          global const float* restrict camera, global float* restrict matches) {
  const int i = get_global_id(0);
  if (i >= n) return;
  global float* out = matches + LC_MATCH * i;
  vstore8((float8)0.0f, 0, out);
  if (!visible[i] || !(share[i] > 0.0f)) return;
  const float3 p = vload3(i, positions), normal = vload3(i, normals);
  const float facing = -(p.x * normal.x + p.y * normal.y + p.z * normal.z) / sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
  const float wanted = share[i] * areas[i] * fmax(facing, 0.0f) * focal_px * focal_px / (p.z * p.z);
  out[7] = wanted;

  const float4 q = vload4(i, projected);
  const int x = convert_int_rte(q.x) - box.x, y = convert_int_rte(q.y) - box.y;

  const int l = options.level;
  const Level level = {box.width, box.height, actor, depth, camera + at};
  float dx = 0.0f, dy = 0.0f, correlation = 0.0f;
  const Structure s = align(&level, x >> l, y >> l, q.w, options, &dx, &dy, &correlation);
  if (!(s.n > 0.0f) || !(correlation >= options.min_correlation)) return;
  if (!(dx * dx + dy * dy <= options.max_move_px * options.max_move_px)) return;

  // S (S + softness)^-1: 1 along directions in which the patch has structure, 0 along those in which it has none.
  const float sxx = s.xx / s.n, sxy = s.xy / s.n, syy = s.yy / s.n;
  const float det = (sxx + options.softness) * (syy + options.softness) - sxy * sxy;
  const float wxx = (sxx * (syy + options.softness) - sxy * sxy) / det;
  const float wyy = (syy * (sxx + options.softness) - sxy * sxy) / det;
  const float wxy = options.softness * sxy / det;
  const float a = sqrt(fmax(wxx, 1e-6f));
  const float b = wxy / a;
  const float c = sqrt(fmax(wyy - b * b, 0.0f));

  vstore8((float8)(q.x + dx * (float)(1 << l), q.y + dy * (float)(1 << l), a, b, c, correlation * wanted, correlation,
                   wanted),
          0, out);
}
