// The two pictures that are matched: the actor as its texture would look, and the camera's; both as luminance in [0,1]
// with a weight of 1 where the person is, 0 elsewhere.
#include "match/layout.h"

static inline float luminance(float r, float g, float b) {
  return 0.299f * r + 0.587f * g + 0.114f * b;
}

// Bilinear, wrapping around. uv: glTF texture coordinates. texture [tw*th] luminance 0..255.
static float sample_wrapped(global const uchar* restrict texture, int tw, int th, float u, float v) {
  const float x = (u - floor(u)) * (float)tw - 0.5f;
  const float y = (v - floor(v)) * (float)th - 0.5f;
  const int x0 = (int)floor(x), y0 = (int)floor(y);
  const float fx = x - (float)x0, fy = y - (float)y0;
  const int xa = x0 < 0 ? tw - 1 : x0, xb = x0 + 1 >= tw ? 0 : x0 + 1;
  const int ya = y0 < 0 ? th - 1 : y0, yb = y0 + 1 >= th ? 0 : y0 + 1;
  const float a = texture[ya * tw + xa], b = texture[ya * tw + xb];
  const float c = texture[yb * tw + xa], d = texture[yb * tw + xb];
  const float top = a + fx * (b - a), bottom = c + fx * (d - c);
  return (top + fy * (bottom - top)) * (1.0f / 255.0f);
}

// Over (box.width, box.height). ids, depth [width*height] of the rasteriser; projected [4*n_vertices] u, v, 1/z, z;
// triangles [3*n_triangles]; uvs [6*n_triangles] of each corner. Out: light, weight, box_depth (INFINITY = nothing).
kernel void textured_actor(MatchBox box, int width, int height, int tw, int th, global const int* restrict ids,
                           global const float* restrict depth, global const float* restrict projected,
                           global const int* restrict triangles, global const float* restrict uvs,
                           global const uchar* restrict texture, global float* restrict light,
                           global float* restrict weight, global float* restrict box_depth) {
  const int bx = get_global_id(0), by = get_global_id(1);
  if (bx >= box.width || by >= box.height) return;
  const int at = by * box.width + bx;
  const int x = box.x + bx, y = box.y + by;
  const int t = x < 0 || y < 0 || x >= width || y >= height ? -1 : ids[y * width + x];
  if (t < 0) {
    light[at] = 0.0f;
    weight[at] = 0.0f;
    box_depth[at] = INFINITY;
    return;
  }
  const int3 corner = vload3(t, triangles);
  const float4 p0 = vload4(corner.x, projected), p1 = vload4(corner.y, projected), p2 = vload4(corner.z, projected);
  const float px = (float)x, py = (float)y;
  // Perspective-correct barycentric coordinates, unnormalised.
  const float w0 = ((p2.x - p1.x) * (py - p1.y) - (p2.y - p1.y) * (px - p1.x)) * p0.z;
  const float w1 = ((p0.x - p2.x) * (py - p2.y) - (p0.y - p2.y) * (px - p2.x)) * p1.z;
  const float w2 = ((p1.x - p0.x) * (py - p0.y) - (p1.y - p0.y) * (px - p0.x)) * p2.z;
  const float scale = 1.0f / (w0 + w1 + w2);
  global const float* c = uvs + 6 * t;
  const float u = (w0 * c[0] + w1 * c[2] + w2 * c[4]) * scale;
  const float v = (w0 * c[1] + w1 * c[3] + w2 * c[5]) * scale;
  light[at] = sample_wrapped(texture, tw, th, u, v);
  weight[at] = 1.0f;
  box_depth[at] = depth[y * width + x];
}

// Over (box.width, box.height). rgb [3*width*height], signed_distance [width*height] px, positive outside the person.
kernel void camera_picture(MatchBox box, int width, int height, global const uchar* restrict rgb,
                           global const float* restrict signed_distance, global float* restrict light,
                           global float* restrict weight) {
  const int bx = get_global_id(0), by = get_global_id(1);
  if (bx >= box.width || by >= box.height) return;
  const int at = by * box.width + bx;
  const int x = box.x + bx, y = box.y + by;
  const int in_picture = x >= 0 && y >= 0 && x < width && y < height;
  const int p = in_picture ? y * width + x : 0;
  const int person = in_picture && signed_distance[p] < 0.0f;
  light[at] = person ? luminance(rgb[3 * p], rgb[3 * p + 1], rgb[3 * p + 2]) * (1.0f / 255.0f) : 0.0f;
  weight[at] = person ? 1.0f : 0.0f;
}
