// How bright the picture shows bare skin, by its albedo.
#include "match/facing.h"
#include "match/layout.h"
#include "raster/layout.h"
#include "shared/luminance.h"

#define RADIUS LC_SKIN_RADIUS
#define SIDE (2 * RADIUS + 1)

// sRGB to linear, roughly: the square. Red, green, blue.
static inline float3 linear_light(global const uchar* restrict rgb, int at) {
  const float3 c = (float3)((float)rgb[3 * at], (float)rgb[3 * at + 1], (float)rgb[3 * at + 2]);
  return c * c * (1.0f / 65025.0f);
}

// Where a vertex of skin is seen.
typedef struct {
  int sees, x, y;
  float z, facing;  // mm; cosine of normal and view
  float3 normal;
} SkinPlace;

static inline SkinPlace skin_place(int v, int width, int height, float min_facing,
                                   global const float* restrict positions, global const float* restrict normals,
                                   global const int* restrict visible, global const float* restrict projected) {
  SkinPlace s = {0, 0, 0, 0.0f, 0.0f, (float3)(0.0f)};
  if (!visible[v]) return s;
  const float3 p = vload3(v, positions);
  s.normal = vload3(v, normals);
  s.facing = facing_at(p, s.normal);
  const float4 q = vload4(v, projected);
  s.z = q.w;
  s.x = convert_int_rte(q.x);
  s.y = convert_int_rte(q.y);
  s.sees = s.facing >= min_facing && s.x >= RADIUS && s.y >= RADIUS && s.x < width - RADIUS && s.y < height - RADIUS;
  return s;
}

// Pixel k of those around it: its light, and 1 if it is of skin.
static inline float4 look_at(int k, SkinPlace s, int width, float depth_range_mm, global const uchar* restrict is_skin,
                             global const int* restrict ids, global const float* restrict depth,
                             global const int* restrict triangles, global const float* restrict distance,
                             global const uchar* restrict rgb) {
  const int at = (s.y + k / SIDE - RADIUS) * width + s.x + k % SIDE - RADIUS;
  const int id = ids[LC_RASTER_APART * at];
  int counts = id >= 0 && fabs(depth[LC_RASTER_APART * at] - s.z) < depth_range_mm && distance[at] < -1.0f;
  const int3 corners = vload3(max(id, 0), triangles);
  counts &= is_skin[corners.x] & is_skin[corners.y] & is_skin[corners.z];
  return (float4)(linear_light(rgb, at), counts ? 1.0f : 0.0f);
}

// Of the sum of their lights.
static inline void write_sample(int i, SkinPlace s, float3 sum, float pz, float focal_px, float4 tints, float2 off_tint,
                                global const int* restrict limbs, global const float* restrict albedo,
                                global const float* restrict areas, global float* restrict out) {
  const float3 mean = sum * (1.0f / (float)(SIDE * SIDE)), skin = vload3(i, albedo);
  const float brightness = luminance(mean.x, mean.y, mean.z) / luminance(skin.x, skin.y, skin.z);
  const float area_px = seen_area_px(areas[i], s.facing, focal_px, pz);
  const float each = brightness > 0.0f ? 1.0f / brightness : 0.0f;
  const float red = mean.x / skin.x * each, blue = mean.z / skin.z * each;
  const float2 tint = limbs[i] % 2 ? tints.zw : tints.xy;
  const float off = fmax(fabs(red - tint.x), fabs(blue - tint.y));
  vstore4((float4)(s.normal.x, s.normal.y, s.normal.z, brightness), 0, out);
  out[LC_SKIN_PX] = off <= (limbs[i] % 2 ? off_tint.y : off_tint.x) ? area_px : -area_px;
  out[LC_SKIN_TINT] = red;
  out[LC_SKIN_TINT + 1] = blue;
}

#if !LC_CPU
// See skin_brightness; of vertex of skin i < n by LC_SKIN_SHARE work-items, neighbours, a pixel each; with barriers.
// looks: one for each work-item of the group.
static inline void sample_skin(int i, int n, int width, int height, float focal_px, float min_facing,
                               float depth_range_mm, float4 tints, float2 off_tint, global const int* restrict vertices,
                               global const int* restrict limbs, global const float* restrict albedo,
                               global const float* restrict areas, global const uchar* restrict is_skin,
                               global const float* restrict positions, global const float* restrict normals,
                               global const int* restrict visible, global const float* restrict projected,
                               global const int* restrict ids, global const float* restrict depth,
                               global const int* restrict triangles, global const float* restrict distance,
                               global const uchar* restrict rgb, global float* restrict samples, local float4* looks) {
  const int own = get_local_id(0) % LC_SKIN_SHARE, id = get_local_id(0);
  SkinPlace s = {0, 0, 0, 0.0f, 0.0f, (float3)(0.0f)};
  const int v = i < n ? vertices[i] : 0;
  if (i < n) s = skin_place(v, width, height, min_facing, positions, normals, visible, projected);
  float4 look = 0.0f;
  if (s.sees && own < SIDE * SIDE)
    look = look_at(own, s, width, depth_range_mm, is_skin, ids, depth, triangles, distance, rgb);
  barrier(CLK_LOCAL_MEM_FENCE);
  looks[id] = look;
  barrier(CLK_LOCAL_MEM_FENCE);
  if (i >= n || own > 0) return;
  global float* out = samples + LC_SKIN * i;
  for (int k = 0; k < LC_SKIN; ++k) out[k] = 0.0f;
  float4 sum = 0.0f;
#pragma unroll
  for (int k = 0; k < SIDE * SIDE; ++k) sum += looks[id + k];
  if (sum.w == SIDE * SIDE)
    write_sample(i, s, sum.xyz, positions[3 * v + 2], focal_px, tints, off_tint, limbs, albedo, areas, out);
}
#endif

// One work-item per vertex of skin, on GPUs LC_SKIN_SHARE, and looks [work-items of the group]: vertices, limbs
// (geometry/seen_vertices.h), areas (mm^2) [n], albedo [3*n] linear; is_skin [n_vertices] 1 for them. tints: red and
// blue of skin in the first light, then in the second; off_tint: how far from these something else begins, for either
// light. positions, normals [3*n_vertices], visible [n_vertices]; projected, ids, depth, triangles of raster/depth.h.
// distance [width*height] px, positive outside of the silhouette; rgb [3*width*height]. Out: samples [LC_SKIN*n].
#if LC_CPU
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
  const SkinPlace s = skin_place(v, width, height, min_facing, positions, normals, visible, projected);
  if (!s.sees) return;
  float3 sum = (float3)(0.0f);
  for (int k = 0; k < SIDE * SIDE; ++k) {
    const float4 look = look_at(k, s, width, depth_range_mm, is_skin, ids, depth, triangles, distance, rgb);
    if (look.w == 0.0f) return;
    sum += look.xyz;
  }
  write_sample(i, s, sum, positions[3 * v + 2], focal_px, tints, off_tint, limbs, albedo, areas, out);
}
#else
kernel void skin_brightness(int n, int width, int height, float focal_px, float min_facing, float depth_range_mm,
                            float4 tints, float2 off_tint, global const int* restrict vertices,
                            global const int* restrict limbs, global const float* restrict albedo,
                            global const float* restrict areas, global const uchar* restrict is_skin,
                            global const float* restrict positions, global const float* restrict normals,
                            global const int* restrict visible, global const float* restrict projected,
                            global const int* restrict ids, global const float* restrict depth,
                            global const int* restrict triangles, global const float* restrict distance,
                            global const uchar* restrict rgb, global float* restrict samples, local float4* looks) {
  sample_skin(get_global_id(0) / LC_SKIN_SHARE, n, width, height, focal_px, min_facing, depth_range_mm, tints, off_tint,
              vertices, limbs, albedo, areas, is_skin, positions, normals, visible, projected, ids, depth, triangles,
              distance, rgb, samples, looks);
}
#endif
