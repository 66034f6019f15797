// The drawn actor as blurred as a camera's picture of it: its texture is sharp at every pixel, where lens, sensor and
// video have mixed neighbours. Contrast that the picture does not have draws patches towards each other's insides, so
// that a shoe is found too small and too far away.
#include "match/layout.h"
#include "shared/bits.h"
#include "shared/wide.h"

#if LC_CPU

typedef float16 pixels_t;  // of a row

// A row's sixteen pixels from x on with `blur` of those at their left and right; 0 beyond the box.
static inline float16 blurred_along(global const float* restrict row, int x, int width, float blur) {
  const float16 here = vload16(0, row + x);
  float16 left = (float16)(0.0f, here.s0123, here.s456, here.s789a, here.sbcde);
  float16 right = (float16)(here.s1234, here.s567, here.s89ab, here.scdef, 0.0f);
  if (x > 0) left = vload16(0, row + x - 1);
  if (x + 16 < width) right = vload16(0, row + x + 1);
  return here + blur * (left + right);
}

#else

typedef float pixels_t;

static inline float blurred_along(global const float* restrict row, int x, int width, float blur) {
  const float left = x > 0 ? row[x - 1] : 0.0f, right = x + 1 < width ? row[x + 1] : 0.0f;
  return row[x] + blur * (left + right);
}

#endif

static inline pixels_t blurred_across(global const float* restrict image, int x, int y, MatchBox box, float blur) {
  global const float* row = image + y * box.width;
  pixels_t beside = 0.0f;
  if (y > 0) beside += blurred_along(row - box.width, x, box.width, blur);
  if (y + 1 < box.height) beside += blurred_along(row + box.width, x, box.width, blur);
  return blurred_along(row, x, box.width, blur) + blur * beside;
}

#if LC_CPU

// Over (box.width / 16, box.height), sixteen pixels each. light, weight: of the drawn actor. Out: blurred = box, the
// mean of a pixel and, `blur` times as much of each, those beside, of what is drawn.
kernel void blur_actor(MatchBox box, float blur, global const float* restrict light,
                       global const float* restrict weight, global float* restrict blurred) {
  const int x = 16 * (int)get_global_id(0), y = get_global_id(1);
  if (x >= box.width || y >= box.height) return;
  const int16 drawn = vload16(0, weight + y * box.width + x) > 0.0f;
  float16 mean = 0.0f;
  if (any_of_16(drawn))
    mean = select(mean, blurred_across(light, x, y, box, blur) / blurred_across(weight, x, y, box, blur), drawn);
  store16(mean, blurred + y * box.width + x);
}

#else

// Pixel (x, y) of the box.
static inline void blur_pixel(int x, int y, MatchBox box, float blur, global const float* restrict light,
                              global const float* restrict weight, global float* restrict blurred) {
  const int at = y * box.width + x;
  float mean = 0.0f;
  if (weight[at] > 0.0f) mean = blurred_across(light, x, y, box, blur) / blurred_across(weight, x, y, box, blur);
  blurred[at] = mean;
}

// Over (box.width, box.height).
kernel void blur_actor(MatchBox box, float blur, global const float* restrict light,
                       global const float* restrict weight, global float* restrict blurred) {
  const int x = get_global_id(0), y = get_global_id(1);
  if (x < box.width && y < box.height) blur_pixel(x, y, box, blur, light, weight, blurred);
}

#endif
