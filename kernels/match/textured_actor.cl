// The actor as its texture looks in the light that falls on it: luminance in [0,1], with a weight of 1 where the person
// is, 0 elsewhere.
#include "match/layout.h"
#include "match/lit.h"
#include "raster/layout.h"
#include "shared/bits.h"
#include "shared/gather.h"
#include "shared/plain_math.h"
#include "shared/wide.h"

// What is constant on a triangle: its corners' pixels and 1/z, their texture coordinates, and how brightly each is lit.
typedef struct {
  float4 p0, p1, p2;
  float2 uv0, uv1, uv2;
  float3 shade;
} Textured;

static inline Textured textured_triangle(int t, global const float* restrict projected,
                                         global const int* restrict triangles, global const float* restrict uvs,
                                         global const float* restrict shade) {
  const int3 corner = vload3(t, triangles);
  global const float* uv = uvs + 6 * t;
  const Textured tri = {vload4(corner.x, projected),
                        vload4(corner.y, projected),
                        vload4(corner.z, projected),
                        vload2(0, uv),
                        vload2(1, uv),
                        vload2(2, uv),
                        (float3)(shade[corner.x], shade[corner.y], shade[corner.z])};
  return tri;
}

#if LC_CPU
typedef float8 run_t;
typedef float16 pix_t;
typedef int16 ipix_t;
typedef uint16 texels_t;
#define TO_INT convert_int16
#define TO_FLOAT convert_float16
#else
typedef float run_t;
typedef float pix_t;
typedef int ipix_t;
typedef uint texels_t;
#define TO_INT convert_int
#define TO_FLOAT convert_float
#endif

// Texture coordinates of the triangle at pixels (px, py), and how brightly it is lit there.
static inline void texture_coordinates(const Textured* tri, run_t px, float py, run_t* u, run_t* v, run_t* shade) {
  const float4 p0 = tri->p0, p1 = tri->p1, p2 = tri->p2;
  // Perspective-correct barycentric coordinates, unnormalised.
  const run_t w0 = ((run_t)(p2.x - p1.x) * (run_t)(py - p1.y) - (p2.y - p1.y) * (px - p1.x)) * p0.z;
  const run_t w1 = ((run_t)(p0.x - p2.x) * (run_t)(py - p2.y) - (p0.y - p2.y) * (px - p2.x)) * p1.z;
  const run_t w2 = ((run_t)(p1.x - p0.x) * (run_t)(py - p0.y) - (p1.y - p0.y) * (px - p0.x)) * p2.z;
  const run_t scale = 1.0f / (w0 + w1 + w2);
  *u = (w0 * tri->uv0.x + w1 * tri->uv1.x + w2 * tri->uv2.x) * scale;
  *v = (w0 * tri->uv0.y + w1 * tri->uv1.y + w2 * tri->uv2.y) * scale;
  // At coarse levels the pixel's middle may be beside the triangle that is drawn there.
  const float3 s = tri->shade;
  const run_t least = min(s.x, min(s.y, s.z)), most = max(s.x, max(s.y, s.z));
  *shade = clamp((w0 * s.x + w1 * s.y + w2 * s.z) * scale, least, most);
}

// Two pairs beside each other.
static inline texels_t look_up(global const ushort* restrict texture, ipix_t at) {
#if LC_CPU
  return gather_pairs(texture, at);
#else
  return as_uint(vload2(0, texture + at));
#endif
}

// Bilinear, wrapping around. uv: glTF texture coordinates. texture [(tw+2)*(th+1)]: luminance 0..255 of a texel (low
// byte) and the one below it.
static inline pix_t sample_wrapped(global const ushort* restrict texture, int tw, int th, pix_t u, pix_t v) {
  const pix_t x = (u - LC_FLOOR(u)) * (float)tw - 0.5f;
  const pix_t y = (v - LC_FLOOR(v)) * (float)th - 0.5f;
  const pix_t x0 = LC_FLOOR(x), y0 = LC_FLOOR(y);
  const pix_t fx = x - x0, fy = y - y0;
  const ipix_t column = clamp(TO_INT(x0) + 1, (ipix_t)0, (ipix_t)tw);
  const ipix_t row = clamp(TO_INT(y0) + 1, (ipix_t)0, (ipix_t)th);
  const texels_t four = look_up(texture, row * (tw + 2) + column);
  const pix_t a = TO_FLOAT(four & 255u), c = TO_FLOAT((four >> 8u) & 255u);
  const pix_t b = TO_FLOAT((four >> 16u) & 255u), d = TO_FLOAT(four >> 24u);
  const pix_t top = a + fx * (b - a), bottom = c + fx * (d - c);
  return (top + fy * (bottom - top)) * (1.0f / 255.0f);
}

// The pixel of the picture at whose triangle a pixel of a level is drawn: one of the middle ones, by its texture in the
// very middle.
static inline int drawn_at(int level) {
  return (1 << level) / 2;
}
static inline float middle(int level) {
  return 0.5f * (float)((1 << level) - 1);
}

// box: of the level. ids, depth [width*height] of the rasteriser; projected [4*n_vertices] u, v, 1/z, z; triangles
// [3*n_triangles]; uvs [6*n_triangles] of each corner; shade [n_vertices] see match/light.cl; texture from `texels` on,
// of the level too. Out: light, weight, box_depth (INFINITY = nothing).
#if LC_CPU

// Sixteen values of a row, every (1 << level)th from that of column x of the box on; `nothing` outside the columns
// [first, end).
static inline float16 every_16(global const float* restrict row, int level, int x, int first, int end, float nothing) {
  if (x >= first && x + 16 < end) {  // what is skipped behind the last one is still within the row
    row += x << level;
    if (level == 0) return vload16(0, row);
    if (level == 1) return (float16)(vload16(0, row).even, vload16(1, row).even);
    if (level == 2)
      return (float16)(vload16(0, row).even.even, vload16(1, row).even.even, vload16(2, row).even.even,
                       vload16(3, row).even.even);
    row -= x << level;
  }
  const int16 column = x + (int16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  const int16 inside = column >= first && column < end;
  if (!any_of_16(inside)) return nothing;
  return select((float16)nothing, gather16(row, clamp(column, first, end - 1) << level), inside);
}

// Texture coordinates and shades of one triangle in the columns [begin, end) of the box, eight at a time; what is too
// much is overwritten by the next triangle or ignored.
static inline void write_coordinates(const Textured* tri, int begin, int end, int width, int level, float px, float py,
                                     global float* restrict us, global float* restrict vs,
                                     global float* restrict shades) {
  const float8 apart = (float)(1 << level) * (float8)(0, 1, 2, 3, 4, 5, 6, 7);
  for (int at = begin; at < end; at += 8) {
    float8 u, v, shade;
    texture_coordinates(tri, px + (float)(at << level) + apart, py, &u, &v, &shade);
    if (at + 8 <= width) {
      store8(u, us + at);
      store8(v, vs + at);
      store8(shade, shades + at);
    } else {
      float u_of[8], v_of[8], shade_of[8];
      vstore8(u, 0, u_of);
      vstore8(v, 0, v_of);
      vstore8(shade, 0, shade_of);
      for (int k = at; k < end; ++k) {
        us[k] = u_of[k - at];
        vs[k] = v_of[k - at];
        shades[k] = shade_of[k - at];
      }
    }
  }
}

// Over the rows of the box. First the texture coordinates, eight pixels of a triangle at a time, into light and weight,
// with the shades into `shades` (a box, left undefined); then the texture, sixteen pixels at a time.
kernel void textured_actor(MatchBox box, int level, int width, int height, int texels, int tw, int th,
                           global const int* restrict ids, global const float* restrict depth,
                           global const float* restrict projected, global const int* restrict triangles,
                           global const float* restrict uvs, global const float* restrict shade,
                           global const ushort* restrict texture, global float* restrict shades,
                           global float* restrict light, global float* restrict weight,
                           global float* restrict box_depth) {
  const int by = get_global_id(0);
  if (by >= box.height) return;
  light += by * box.width;
  weight += by * box.width;
  box_depth += by * box.width;
  shades += by * box.width;
  texture += texels;
  const int left = box.x + drawn_at(level), y = box.y + (by << level) + drawn_at(level);
  const int first = max((-left + (1 << level) - 1) >> level, 0);
  const int end = y >= 0 && y < height ? min(((width - left - 1) >> level) + 1, box.width) : 0;
  const float px = (float)box.x + middle(level), py = (float)(box.y + (by << level)) + middle(level);
  ids += y * width + left;
  depth += y * width + left;
  int drawn_first = box.width, drawn_end = 0;  // in steps of 16
  for (int x = 0; x < box.width; x += 16) {
    const float16 z = every_16(depth, level, x, first, end, INFINITY);
    store16(z, box_depth + x);
    store16((float16)0.0f, light + x);
    store16((float16)0.0f, weight + x);
    if (!any_of_16(z < INFINITY)) continue;
    drawn_first = min(drawn_first, x);
    drawn_end = x + 16;
  }
  // Where the triangle changes is found sixteen columns at a time: runs are too short and uneven to be looked for one
  // by one.
  int begin = 0, open = -1;
  Textured tri;
  int16 before = -1;
  for (int x = drawn_first; x < drawn_end; x += 16) {
    const int16 t = as_int16(every_16((global const float*)ids, level, x, first, end, as_float(-1)));
    uint changes = bits_of_16(t != (int16)(before.sf, t.s0123, t.s4567, t.s89ab, t.scd, t.se));
    before = t;
    for (; changes; changes &= changes - 1) {
      const int column = x + lowest_bit(changes);
      if (open >= 0) write_coordinates(&tri, begin, column, box.width, level, px, py, light, weight, shades);
      begin = column;
      open = column < end ? ids[column << level] : -1;
      if (open >= 0) tri = textured_triangle(open, projected, triangles, uvs, shade);
    }
  }
  if (open >= 0) write_coordinates(&tri, begin, min(drawn_end, end), box.width, level, px, py, light, weight, shades);
  for (int x = drawn_first; x < min(drawn_end + 16, box.width); x += 16) {
    const int16 drawn = vload16(0, box_depth + x) < INFINITY;
    const float16 u = select((float16)0.0f, vload16(0, light + x), drawn);
    const float16 v = select((float16)0.0f, vload16(0, weight + x), drawn);
    const float16 color = sample_wrapped(texture, tw, th, u, v);
    const float16 shade = select((float16)0.0f, vload16(0, shades + x), drawn);
    const float16 lit = LIT(color, shade);
    store16(select((float16)0.0f, lit, drawn), light + x);
    store16(select((float16)0.0f, (float16)1.0f, drawn), weight + x);
  }
}

#else

// Pixel (bx, by) of the box.
static inline void draw_texture(int bx, int by, MatchBox box, int level, int width, int height, int texels, int tw,
                                int th, global const int* restrict ids, global const float* restrict depth,
                                global const float* restrict projected, global const int* restrict triangles,
                                global const float* restrict uvs, global const float* restrict shade,
                                global const ushort* restrict texture, global float* restrict light,
                                global float* restrict weight, global float* restrict box_depth) {
  const int at = by * box.width + bx;
  const int left = box.x + (bx << level), top = box.y + (by << level);
  const int x = left + drawn_at(level), y = top + drawn_at(level);
  const int t = x < 0 || y < 0 || x >= width || y >= height ? -1 : ids[LC_RASTER_APART * (y * width + x)];
  if (t < 0) {
    light[at] = 0.0f;
    weight[at] = 0.0f;
    box_depth[at] = INFINITY;
    return;
  }
  const Textured tri = textured_triangle(t, projected, triangles, uvs, shade);
  float u, v, shade_here;
  texture_coordinates(&tri, (float)left + middle(level), (float)top + middle(level), &u, &v, &shade_here);
  const float color = sample_wrapped(texture + texels, tw, th, u, v);
  light[at] = LIT(color, shade_here);
  weight[at] = 1.0f;
  box_depth[at] = depth[LC_RASTER_APART * (y * width + x)];
}

// Over (box.width, box.height).
kernel void textured_actor(MatchBox box, int level, int width, int height, int texels, int tw, int th,
                           global const int* restrict ids, global const float* restrict depth,
                           global const float* restrict projected, global const int* restrict triangles,
                           global const float* restrict uvs, global const float* restrict shade,
                           global const ushort* restrict texture, global float* restrict light,
                           global float* restrict weight, global float* restrict box_depth) {
  const int bx = get_global_id(0), by = get_global_id(1);
  if (bx < box.width && by < box.height)
    draw_texture(bx, by, box, level, width, height, texels, tw, th, ids, depth, projected, triangles, uvs, shade,
                 texture, light, weight, box_depth);
}

#endif
