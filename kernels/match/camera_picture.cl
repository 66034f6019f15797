// What the camera shows of the person, as textured_actor.cl draws the actor: luminance in [0,1] with a weight of 1
// where the person is, 0 elsewhere; and its half-resolution levels.
#include "match/layout.h"
#include "shared/bits.h"
#include "shared/luminance.h"
#include "shared/wide.h"

// Over (box.width / 16, box.height), sixteen pixels each. rgb [3*width*height], signed_distance [width*height] px,
// positive outside the person.
kernel void camera_picture(MatchBox box, int width, int height, global const uchar* restrict rgb,
                           global const float* restrict signed_distance, global float* restrict light,
                           global float* restrict weight) {
  const int bx = 16 * (int)get_global_id(0), by = get_global_id(1);
  if (bx >= box.width || by >= box.height) return;
  const int at = by * box.width + bx;
  const int x = box.x + bx, y = box.y + by;
#if LC_CPU
  if (y >= 0 && y < height && x >= 0 && x + 16 <= width) {
    const int p = y * width + x;
    const int16 person = vload16(0, signed_distance + p) < 0.0f;
    float16 bright = 0.0f;
    if (any_of_16(person)) {
      const uchar16 a = vload16(0, rgb + 3 * p), b = vload16(1, rgb + 3 * p), c = vload16(2, rgb + 3 * p);
      const uchar16 red = (uchar16)(a.s0369, a.scf, b.s258b, b.se, c.s147a, c.sd);
      const uchar16 green = (uchar16)(a.s147a, a.sd, b.s0369, b.scf, c.s258b, c.se);
      const uchar16 blue = (uchar16)(a.s258b, a.se, b.s147a, b.sd, c.s0369, c.scf);
      bright = (LC_RED_LUMINANCE * convert_float16(red) + LC_GREEN_LUMINANCE * convert_float16(green) +
                LC_BLUE_LUMINANCE * convert_float16(blue)) *
               (1.0f / 255.0f);
    }
    store16(select((float16)0.0f, bright, person), light + at);
    store16(select((float16)0.0f, (float16)1.0f, person), weight + at);
    return;
  }
#endif
  store16((float16)0.0f, light + at);
  store16((float16)0.0f, weight + at);
  if (y < 0 || y >= height) return;
  for (int k = max(-x, 0); k < min(width - x, 16); ++k) {
    const int p = y * width + x + k;
    if (!(signed_distance[p] < 0.0f)) continue;
    light[at + k] = luminance(rgb[3 * p], rgb[3 * p + 1], rgb[3 * p + 2]) * (1.0f / 255.0f);
    weight[at + k] = 1.0f;
  }
}

// Over (half_width / 8, half_height) of a level, eight pixels each. It lies at `to`, the level above at `from`: means
// of those of 2 x 2 pixels that are the person's, nobody where these are fewer than two.
kernel void halve_picture(int width, int half_width, int half_height, int from, int to, global float* restrict light,
                          global float* restrict weight) {
  const int x = 8 * (int)get_global_id(0), y = get_global_id(1);
  if (x >= half_width || y >= half_height) return;
  const int above = from + 2 * y * width + 2 * x, at = to + y * half_width + x;
  const float16 lights = vload16(0, light + above) + vload16(0, light + above + width);
  const float16 weights = vload16(0, weight + above) + vload16(0, weight + above + width);
  const float8 sum = lights.even + lights.odd, n = weights.even + weights.odd;
  const int8 counts = n >= 2.0f;
  store8(select((float8)0.0f, sum / n, counts), light + at);
  store8(select((float8)0.0f, (float8)1.0f, counts), weight + at);
}
