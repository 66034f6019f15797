// patch_match.cl on GPUs: a patch by eight work-items, neighbours, each with a column of it.
#ifndef LC_MATCH_PATCH_COLUMNS_H
#define LC_MATCH_PATCH_COLUMNS_H

// The work-items of a patch: what each wrote to local memory is seen by all after.
#ifndef LC_MEET
#define LC_MEET() barrier(CLK_LOCAL_MEM_FENCE)
#endif

// Sums over the eight work-items of a patch, in the order of a CPU's. sums: one for each of the group. With barriers.
static inline float4 sum_of_columns(float4 value, local float4* sums) {
  const int id = get_local_id(0);
  LC_MEET();
  sums[id] = value;
  LC_MEET();
  local const float4* s = sums + id / PATCH * PATCH;
  return ((s[0] + s[4]) + (s[2] + s[6])) + ((s[1] + s[5]) + (s[3] + s[7]));
}

// A column of the camera's picture moved by (fx, fy) of a pixel, from `camera` on.
static inline void moved_column(global const float* restrict camera, int width, float fx, float fy, Seen* column) {
  Seen top = between(seen_pixel(camera[0]), seen_pixel(camera[1]), fx);
#pragma unroll
  for (int r = 0; r < PATCH; ++r) {
    global const float* below = camera + (r + 1) * width;
    const Seen bottom = between(seen_pixel(below[0]), seen_pixel(below[1]), fx);
    column[r] = between(top, bottom, fy);
    top = bottom;
  }
}

// The match of vertex i < n by the work-items get_local_id(0) / 8 * 8 .. + 7; with barriers, so by all of a group.
// Moved as by align() of patch_match.cl; see the kernel. fma: compilers take a product that stays the same out of the
// loop or not, and round it by itself then; see_actor.cl and match_patches are to come to the same bits.
static inline void match_vertex(int i, int n, Level level, PatchOptions options, float focal_px,
                                global const float* restrict positions, global const float* restrict normals,
                                global const int* restrict visible, global const float* restrict projected,
                                global const float* restrict areas, global const float* restrict share,
                                local float4* sums, global float* restrict matches, int x_of_box, int y_of_box) {
  const int own = get_local_id(0) % PATCH, width = level.width;
  int x = 0, y = 0, sees = 0;
  float u = 0.0f, v = 0.0f, z = 0.0f, seen_px = 0.0f;
  if (i < n && visible[i] && share[i] > 0.0f) {
    seen_px = seen_px_of(i, focal_px, positions, normals, areas, share);
    u = projected[4 * i];
    v = projected[4 * i + 1];
    z = projected[4 * i + 3];
    x = ((int)LC_RINT(u) - x_of_box) >> options.level;
    y = ((int)LC_RINT(v) - y_of_box) >> options.level;
    sees = has_patch(&level, x, y);
  }
  float actor[PATCH], gx[PATCH], gy[PATCH], inside[PATCH];
  float4 s = 0.0f;
  if (sees) {
    global const float* a = level.actor + (y - HALF) * width + x - HALF + own;
    global const float* d = level.depth + (y - HALF) * width + x - HALF + own;
#pragma unroll
    for (int r = 0; r < PATCH; ++r) {
      const int row = r * width;
      const float beside = fmax(fabs(d[row - 1] - z), fabs(d[row + 1] - z));
      const float above = fmax(fabs(d[row - width] - z), fabs(d[row + width] - z));
      inside[r] = fmax(fabs(d[row] - z), fmax(beside, above)) < options.depth_range_mm ? 1.0f : 0.0f;
      actor[r] = a[row];
      gx[r] = 0.5f * inside[r] * (a[row + 1] - a[row - 1]);
      gy[r] = 0.5f * inside[r] * (a[row + width] - a[row - width]);
      s += (float4)(gx[r] * gx[r], gx[r] * gy[r], gy[r] * gy[r], inside[r]);
    }
  }
  s = sum_of_columns(s, sums);
  sees = sees && s.w >= LEAST_PIXELS;
  const float soft = options.softness * s.w, hxx = s.x + soft, hyy = s.z + soft;
  const float inv = 1.0f / (hxx * hyy - s.y * s.y);
  float dx = 0.0f, dy = 0.0f;
  Seen column[PATCH];
  float4 of_both = 0.0f;  // sums of either patch and of its squares
  float product = 0.0f, counted = 0.0f;
  for (int k = 0; k <= options.iterations; ++k) {
    const float px = (float)(x - HALF) + dx, py = (float)(y - HALF) + dy, fx0 = floor(px), fy0 = floor(py);
    sees = sees && fx0 >= 0.0f && fy0 >= 0.0f && fx0 + (PATCH + 1) < (float)width &&
           fy0 + (PATCH + 1) < (float)level.height;
    float ex = 0.0f, ey = 0.0f, n_seen = 0.0f;
    if (sees) {
      moved_column(level.camera + (int)fy0 * width + (int)fx0 + own, width, px - fx0, py - fy0, column);
      if (k < options.iterations) {
#pragma unroll
        for (int r = 0; r < PATCH; ++r) {
          const float e = column[r].seen - column[r].counts * actor[r];
          ex += gx[r] * e;
          ey += gy[r] * e;
          n_seen += inside[r] * column[r].counts;
        }
      } else {
#pragma unroll
        for (int r = 0; r < PATCH; ++r) {
          const float counts = inside[r] * column[r].counts, a = counts * actor[r], b = inside[r] * column[r].seen;
          of_both = (float4)(of_both.xy + (float2)(a, b), fma(a, actor[r], of_both.z),
                             fma(b, mean_seen(column[r]), of_both.w));
          product = fma(b, actor[r], product);
          n_seen += counts;
        }
      }
    }
    const float4 e = sum_of_columns((float4)(ex, ey, product, n_seen), sums);
    const float step = inv * s.w / fmax(e.w, LEAST_PIXELS);
    dx -= k < options.iterations ? at_most_2((hyy * e.x - s.y * e.y) * step) : 0.0f;
    dy -= k < options.iterations ? at_most_2((hxx * e.y - s.y * e.x) * step) : 0.0f;
    product = e.z;
    counted = e.w;
  }
  of_both = sum_of_columns(of_both, sums);
  if (i >= n || own > 0) return;
  global float* out = matches + LC_MATCH * i;
  vstore8((float8)0.0f, 0, out);
  out[LC_MATCH_SEEN_PX] = seen_px;
  if (!sees) return;
  const float correlation =
      counted < LEAST_PIXELS ? 0.0f : correlation_of(counted, of_both.x, of_both.y, of_both.z, of_both.w, product);
  const Aligned m = {s.x, s.y, s.z, s.w, dx, dy, correlation};
  write_match(m, options, u, v, out);
}

#endif
