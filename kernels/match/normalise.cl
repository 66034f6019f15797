// Local normalisation: what is left of a picture when mean and contrast of the 25 x 25 pixels around each pixel are
// taken out, which lighting changes and texture does not. Pixels that are not of the person count in no window.
#include "match/layout.h"

// Rows of a work-item: windows are summed anew at the first and carried on from there.
#define BAND 64

// Over (box.width / 16, rows / BAND). Sums of weight, light, light^2 over the 25 rows around each pixel.
// light, weight: box. Out: sums, 3 planes of the box.
kernel void column_sums(MatchBox box, global const float* restrict light, global const float* restrict weight,
                        global float* restrict sums) {
  const int x = 16 * (int)get_global_id(0);
  const int first = BAND * (int)get_global_id(1);
  if (x >= box.width || first >= box.height) return;
  const int plane = box.width * box.height;
  const int last = min(first + BAND, box.height);
  float16 n = 0.0f, s = 0.0f, ss = 0.0f;
  for (int y = max(first - LC_MATCH_RADIUS, 0); y < min(first + LC_MATCH_RADIUS, box.height); ++y) {
    const float16 g = vload16(0, light + y * box.width + x);
    n += vload16(0, weight + y * box.width + x);
    s += g;
    ss += g * g;
  }
  for (int y = first; y < last; ++y) {
    if (y + LC_MATCH_RADIUS < box.height) {
      const int at = (y + LC_MATCH_RADIUS) * box.width + x;
      const float16 g = vload16(0, light + at);
      n += vload16(0, weight + at);
      s += g;
      ss += g * g;
    }
    if (y > first && y - LC_MATCH_RADIUS - 1 >= 0) {
      const int at = (y - LC_MATCH_RADIUS - 1) * box.width + x;
      const float16 g = vload16(0, light + at);
      n -= vload16(0, weight + at);
      s -= g;
      ss -= g * g;
    }
    const int at = y * box.width + x;
    vstore16(n, 0, sums + at);
    vstore16(s, 0, sums + plane + at);
    vstore16(ss, 0, sums + 2 * plane + at);
  }
}

// Over (box.width / 16, box.height). Out: normal = (light - mean) / sqrt(variance + floor), 0 where there is nobody and
// in the margins.
kernel void normalise_rows(MatchBox box, float variance_floor, global const float* restrict light,
                           global const float* restrict weight, global const float* restrict sums,
                           global float* restrict normal) {
  const int x = 16 * (int)get_global_id(0);
  const int y = get_global_id(1);
  if (x >= box.width || y >= box.height) return;
  const int plane = box.width * box.height;
  const int at = y * box.width + x;
  if (x < LC_MATCH_MARGIN || x >= box.width - LC_MATCH_MARGIN) {
    vstore16((float16)0.0f, 0, normal + at);
    return;
  }
  float16 n = 0.0f, s = 0.0f, ss = 0.0f;
  for (int k = -LC_MATCH_RADIUS; k <= LC_MATCH_RADIUS; ++k) {
    n += vload16(0, sums + at + k);
    s += vload16(0, sums + plane + at + k);
    ss += vload16(0, sums + 2 * plane + at + k);
  }
  n = fmax(n, 1.0f);
  const float16 mean = s / n;
  const float16 variance = fmax(ss / n - mean * mean, 0.0f);
  const float16 value = (vload16(0, light + at) - mean) / sqrt(variance + variance_floor);
  vstore16(value * vload16(0, weight + at), 0, normal + at);
}

// Over (half width, half height) of a level, at `to` in the pyramid; the level above is at `from`: means of 2 x 2
// pixels.
kernel void halve(int width, int half_width, int half_height, int from, int to, global float* restrict pyramid) {
  const int x = get_global_id(0), y = get_global_id(1);
  if (x >= half_width || y >= half_height) return;
  global const float* p = pyramid + from + 2 * y * width + 2 * x;
  pyramid[to + y * half_width + x] = 0.25f * (p[0] + p[1] + p[width] + p[width + 1]);
}

// The same for depths: the first of the 2 x 2 pixels.
kernel void halve_depth(int width, int half_width, int half_height, int from, int to, global float* restrict pyramid) {
  const int x = get_global_id(0), y = get_global_id(1);
  if (x >= half_width || y >= half_height) return;
  pyramid[to + y * half_width + x] = pyramid[from + 2 * y * width + 2 * x];
}
