// The light that falls on the actor. It is drawn lit as it is in the picture: otherwise shading at the rims of what has
// one colour, as shoes have, would draw its patches inwards, and a foot be found too small and too far away.
#include "match/facing.h"
#include "match/layout.h"
#include "match/lit.h"
#include "shared/luminance.h"
#include "terms/shading.cl"

#define DARKEST 0.05f  // harmonics that fit what is seen may fall below 0 elsewhere
#define SIDE_LIT 3     // px; so many by so many around a vertex are averaged
#define LEAST_DRAWN 0.03f
#define STEPS_TO_COLOR 4  // from what is drawn; what the last one leaves out counts only as far as the light was wrong
#define DEPTH_RANGE_MM 40.0f  // pixels further from their vertex are of another limb

// How brightly vertex i is lit: 1 shows its colours as they are.
static inline float shade_of(int i, Harmonics light, global const float* restrict normals) {
  const float3 n = vload3(i, normals);
  return fmax(shading_row(vec3(n.x, n.y, n.z), light, 0.0f).r, DARKEST);
}

// Over the vertices. normals [3*n] unit, camera frame. Out: shade [n].
kernel void light_vertices(int n, Harmonics light, global const float* restrict normals, global float* restrict shade) {
  const int i = get_global_id(0);
  if (i < n) shade[i] = shade_of(i, light, normals);
}

// In which shade each vertex would look as the picture shows it: over the vertices. box, drawn and weight, from `at`
// on: the actor as it was drawn at full resolution, with these shades; depth: its box, mm. positions, normals [3*n],
// visible, areas (mm^2) and shade [n]; projected of raster/depth.h; distance [width*height] px, positive outside of the
// silhouette; rgb [3*width*height]. Out: samples [LC_LIT_SAMPLE*n].
kernel void sample_light(int n, MatchBox box, int at, int width, int height, float focal_px,
                         global const float* restrict positions, global const float* restrict normals,
                         global const int* restrict visible, global const float* restrict projected,
                         global const float* restrict areas, global const float* restrict shade,
                         global const float* restrict drawn, global const float* restrict weight,
                         global const float* restrict depth, global const float* restrict distance,
                         global const uchar* restrict rgb, global float* restrict samples) {
  const int i = get_global_id(0), reach = SIDE_LIT / 2;
  if (i >= n) return;
  global float* out = samples + LC_LIT_SAMPLE * i;
  for (int k = 0; k < LC_LIT_SAMPLE; ++k) out[k] = 0.0f;
  if (!visible[i]) return;
  const int x = convert_int_rte(projected[4 * i]), y = convert_int_rte(projected[4 * i + 1]);
  if (x < reach || y < reach || x >= width - reach || y >= height - reach) return;
  const int bx = x - box.x, by = y - box.y;
  if (bx < reach || by < reach || bx >= box.width - reach || by >= box.height - reach) return;
  float own = 0.0f, seen = 0.0f;
  for (int k = 0; k < SIDE_LIT * SIDE_LIT; ++k) {
    const int dx = k % SIDE_LIT - reach, dy = k / SIDE_LIT - reach;
    const int p = (y + dy) * width + x + dx, q = at + (by + dy) * box.width + bx + dx;
    if (!(weight[q] > 0.0f) || !(distance[p] < -1.0f)) return;
    if (!(fabs(depth[q - at] - projected[4 * i + 3]) < DEPTH_RANGE_MM)) return;
    own += drawn[q];
    seen += luminance(rgb[3 * p], rgb[3 * p + 1], rgb[3 * p + 2]);
  }
  own /= (float)(SIDE_LIT * SIDE_LIT);
  seen /= 255.0f * (float)(SIDE_LIT * SIDE_LIT);
  if (!(shade[i] > DARKEST)) return;
  float color = own;
  for (int k = 0; k < STEPS_TO_COLOR; ++k) color = own / (1.0f + MATT_SHARE(color) * (shade[i] - 1.0f));
  if (!(color >= LEAST_DRAWN && color <= 1.0f)) return;
  const float by_light = color * MATT_SHARE(color);  // d LIT / d shade
  const float3 normal = vload3(i, normals), position = vload3(i, positions);
  const float area_px = seen_area_px(areas[i], facing_at(position, normal), focal_px, position.z);
  vstore3(normal, 0, out);
  out[LC_LIT_BRIGHTNESS] = shade[i] + (seen - own) / by_light;
  out[LC_LIT_WEIGHT] = fmax(area_px, 0.0f) * by_light * by_light;
}
