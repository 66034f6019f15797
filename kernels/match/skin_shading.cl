// How bright the picture shows bare skin, by its albedo.
#include "match/layout.h"
#include "shared/luminance.h"

#define RADIUS LC_SKIN_RADIUS
#define SIDE (2 * RADIUS + 1)
// A CPU looks at no pixel after one that does not count; the looks of a GPU wait for none before.
#define LOOKS_ON(counts) (!LC_CPU || (counts))

// sRGB to linear, roughly: the square. Red, green, blue.
static inline float3 linear_light(global const uchar* restrict rgb, int at) {
  const float3 c = (float3)((float)rgb[3 * at], (float)rgb[3 * at + 1], (float)rgb[3 * at + 2]);
  return c * c * (1.0f / 65025.0f);
}

static inline float luminance(float3 light) {
  return LC_RED_LUMINANCE * light.x + LC_GREEN_LUMINANCE * light.y + LC_BLUE_LUMINANCE * light.z;
}

// One work-item per vertex of skin: vertices, limbs (geometry/seen_vertices.h), areas (mm^2) [n], albedo [3*n] linear;
// is_skin [n_vertices] 1 for them. tints: red and blue of skin in the first light, then in the second; off_tint: how
// far from these something else begins, for either light.
// positions, normals [3*n_vertices], visible [n_vertices]; projected, ids, depth, triangles of raster/depth.h. distance
// [width*height] px, positive outside of the silhouette; rgb [3*width*height]. Out: samples [LC_SKIN*n].
kernel void skin_brightness(int n, int width, int height, float focal_px, float min_facing, float depth_range_mm,
                            float4 tints, float2 off_tint, global const int* restrict vertices,
                            global const int* restrict limbs, global const float* restrict albedo,
                            global const float* restrict areas, global const uchar* restrict is_skin,
                            global const float* restrict positions, global const float* restrict normals,
                            global const int* restrict visible, global const float* restrict projected,
                            global const int* restrict ids, global const float* restrict depth,
                            global const int* restrict triangles, global const float* restrict distance,
                            global const uchar* restrict rgb, global float* restrict samples) {
  const int i = get_global_id(0);
  if (i >= n) return;
  const int v = vertices[i];
  global float* out = samples + LC_SKIN * i;
  for (int k = 0; k < LC_SKIN; ++k) out[k] = 0.0f;
  if (!visible[v]) return;
  const float3 p = vload3(v, positions), normal = vload3(v, normals);
  const float facing = -(p.x * normal.x + p.y * normal.y + p.z * normal.z) / sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
  if (!(facing >= min_facing)) return;
  const float4 q = vload4(v, projected);
  const int x = convert_int_rte(q.x), y = convert_int_rte(q.y);
  if (x < RADIUS || y < RADIUS || x >= width - RADIUS || y >= height - RADIUS) return;
  float3 sum = (float3)(0.0f);
  int counts = 1;
#if !LC_CPU
#pragma unroll
#endif
  for (int k = 0; k < SIDE * SIDE && LOOKS_ON(counts); ++k) {
    const int at = (y + k / SIDE - RADIUS) * width + x + k % SIDE - RADIUS;
    const int id = ids[at];
    counts &= id >= 0 && fabs(depth[at] - q.w) < depth_range_mm && distance[at] < -1.0f;
    const int3 corners = vload3(max(id, 0), triangles);
    counts &= is_skin[corners.x] & is_skin[corners.y] & is_skin[corners.z];
    sum += linear_light(rgb, at);
  }
  if (!counts) return;
  const float3 mean = sum * (1.0f / (float)(SIDE * SIDE)), skin = vload3(i, albedo);
  const float brightness = luminance(mean) / luminance(skin);
  const float area_px = areas[i] * facing * focal_px * focal_px / (p.z * p.z);
  const float each = brightness > 0.0f ? 1.0f / brightness : 0.0f;
  const float red = mean.x / skin.x * each, blue = mean.z / skin.z * each;
  const float2 tint = limbs[i] % 2 ? tints.zw : tints.xy;
  const float off = fmax(fabs(red - tint.x), fabs(blue - tint.y));
  vstore4((float4)(normal.x, normal.y, normal.z, brightness), 0, out);
  out[LC_SKIN_PX] = off <= (limbs[i] % 2 ? off_tint.y : off_tint.x) ? area_px : -area_px;
  out[LC_SKIN_TINT] = red;
  out[LC_SKIN_TINT + 1] = blue;
}
