// E_photo of the surface stage: blurred colour and its gradient at the projection of every visible vertex, and the
// vertex's share of J^T J and -J^T F. No image is blurred as a whole.
//
// I_Gauss(u) = sum_k w(k - u) I(k) / sum_k w(k - u), separable, w(d) = exp(-d^2 / 2 sigma^2) t(|d| - r), where t falls
// smoothly from 1 to 0 between r and r + 1. At integer u it is OpenCV's GaussianBlur of kernel size 2 r + 1; between
// them it is continuously differentiable. 2 r + 2 <= MAX_TAPS taps per axis. Image borders are clamped.
#include "surface/image.h"
#include "surface/layout.h"
#include "surface/system.h"
#include "terms/photo.cl"

#define MAX_TAPS LC_PHOTO_TAPS

typedef struct {
  Vec3 value;  // [0,1]
  Vec3 du;     // per px
  Vec3 dv;
} ColorSample;

// d: tap - position. weight = w(d), slope = dw / d(position).
#define TAP_WEIGHT(NAME, TAPS)                                                                 \
  static inline void NAME(TAPS d, float radius, float inv_sigma2, TAPS* weight, TAPS* slope) { \
    /* The floor avoids denormals, which are slow; t is 0 there. */                            \
    TAPS g = exp(LC_GREATER(-0.5f * inv_sigma2 * d * d, (TAPS)-40.0f));                        \
    TAPS beyond = fabs(d) - radius, e = LC_LESSER(LC_GREATER(beyond, (TAPS)0.0f), (TAPS)1.0f); \
    TAPS t = 1.0f - e * e * (3.0f - 2.0f * e);                                                 \
    *weight = g * t;                                                                           \
    *slope = g * (inv_sigma2 * d * t + copysign(6.0f * e * (1.0f - e), d));                    \
  }

#if LC_CPU
TAP_WEIGHT(tap_weight, float16)
TAP_WEIGHT(tap_weight_8, float8)
#define TAP_IDS (float16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15)

// Sums over the lanes of four vectors at once.
static inline float4 sum8x4(float8 e, float8 f, float8 g, float8 h) {
  float8 p = (float8)(e.lo + e.hi, f.lo + f.hi);
  float8 q = (float8)(g.lo + g.hi, h.lo + h.hi);
  float8 t = (float8)(p.even, q.even) + (float8)(p.odd, q.odd);
  return t.even + t.odd;
}

static inline float4 sum16x4(float16 a, float16 b, float16 c, float16 d) {
  return sum8x4(a.lo + a.hi, b.lo + b.hi, c.lo + c.hi, d.lo + d.hi);
}

// norms: sums of the weights of columns and rows and of their slopes; the others of red, green, blue, 0..255.
static inline ColorSample normalised_sample(float4 norms, float4 value, float4 du, float4 dv) {
  float4 inv = 1.0f / norms;
  float scale = inv.x * inv.y * (1.0f / 255.0f);
  value *= scale;
  du = du * scale - value * (inv.x * norms.z);
  dv = dv * scale - value * (inv.y * norms.w);
  ColorSample out;
  out.value = vec3(value.x, value.y, value.z);
  out.du = vec3(du.x, du.y, du.z);
  out.dv = vec3(dv.x, dv.y, dv.z);
  return out;
}

// n pixels of a row from column x on, borders clamped.
static inline void copy_pixels(global const uchar* restrict row, int x, int width, int n, uchar* pixels) {
  for (int i = 0; i < n; ++i) {
    int from = 3 * clamp(x + i, 0, width - 1);
    pixels[3 * i] = row[from];
    pixels[3 * i + 1] = row[from + 1];
    pixels[3 * i + 2] = row[from + 2];
  }
}

#define RED(a, b, c) (float16)(a.s0369, a.scf, b.s258b, b.se, c.s147a, c.sd)
#define GREEN(a, b, c) (float16)(a.s147a, a.sd, b.s0369, b.scf, c.s258b, c.se)
#define BLUE(a, b, c) (float16)(a.s258b, a.se, b.s147a, b.sd, c.s0369, c.scf)

// Lanes are the taps of one image row; colours stay interleaved until the last step.
static ColorSample sample_many(global const uchar* restrict rgb, int width, int height, Vec2 uv, int radius,
                               float inv_sigma2) {
  float u0 = LC_FLOOR(uv.x) - radius;
  float v0 = LC_FLOOR(uv.y) - radius;
  float16 wx, dwx, wy, dwy;
  tap_weight(u0 + TAP_IDS - uv.x, radius, inv_sigma2, &wx, &dwx);
  tap_weight(v0 + TAP_IDS - uv.y, radius, inv_sigma2, &wy, &dwy);
  float row_weight[MAX_TAPS], row_slope[MAX_TAPS];
  vstore16(wy, 0, row_weight);
  vstore16(dwy, 0, row_slope);
  int x0 = (int)u0;
  int y0 = (int)v0;
  // The wide loads read 16 pixels from x0 on; those beyond the taps have weight zero but must lie in the buffer.
  int whole = x0 >= 0 && x0 + MAX_TAPS <= width;
  float16 va = 0.0f, vb = 0.0f, vc = 0.0f, da = 0.0f, db = 0.0f, dc = 0.0f;
  for (int k = 0; k < 2 * radius + 2; ++k) {
    global const uchar* row = rgb + 3 * (size_t)clamp(y0 + k, 0, height - 1) * width;
    uchar16 ca, cb, cc;
    if (whole) {
      ca = vload16(0, row + 3 * x0);
      cb = vload16(1, row + 3 * x0);
      cc = vload16(2, row + 3 * x0);
    } else {
      uchar pixels[3 * MAX_TAPS];
      copy_pixels(row, x0, width, MAX_TAPS, pixels);
      ca = vload16(0, pixels);
      cb = vload16(1, pixels);
      cc = vload16(2, pixels);
    }
    float16 a = convert_float16(ca), b = convert_float16(cb), c = convert_float16(cc);
    float w = row_weight[k];
    float s = row_slope[k];
    va += w * a;
    vb += w * b;
    vc += w * c;
    da += s * a;
    db += s * b;
    dc += s * c;
  }
  float16 red = RED(va, vb, vc), green = GREEN(va, vb, vc), blue = BLUE(va, vb, vc);
  return normalised_sample(sum16x4(wx, wy, dwx, dwy), sum16x4(wx * red, wx * green, wx * blue, 0.0f),
                           sum16x4(dwx * red, dwx * green, dwx * blue, 0.0f),
                           sum16x4(wx * RED(da, db, dc), wx * GREEN(da, db, dc), wx * BLUE(da, db, dc), 0.0f));
}

#define RED_8(a, b, c) (float8)(a.s036, b.s147, c.s25)
#define GREEN_8(a, b, c) (float8)(a.s147, b.s25, c.s036)
#define BLUE_8(a, b, c) (float8)(a.s25, b.s036, c.s147)

// The same with at most eight taps, whose sums are those of sixteen lanes to the bit.
static ColorSample sample_few(global const uchar* restrict rgb, int width, int height, Vec2 uv, int radius,
                              float inv_sigma2) {
  float u0 = LC_FLOOR(uv.x) - radius;
  float v0 = LC_FLOOR(uv.y) - radius;
  float8 wx, dwx, wy, dwy;
  tap_weight_8(u0 + TAP_IDS.lo - uv.x, radius, inv_sigma2, &wx, &dwx);
  tap_weight_8(v0 + TAP_IDS.lo - uv.y, radius, inv_sigma2, &wy, &dwy);
  float row_weight[8], row_slope[8];
  vstore8(wy, 0, row_weight);
  vstore8(dwy, 0, row_slope);
  int x0 = (int)u0;
  int y0 = (int)v0;
  int whole = x0 >= 0 && x0 + 8 <= width;
  float8 va = 0.0f, vb = 0.0f, vc = 0.0f, da = 0.0f, db = 0.0f, dc = 0.0f;
  for (int k = 0; k < 2 * radius + 2; ++k) {
    global const uchar* row = rgb + 3 * (size_t)clamp(y0 + k, 0, height - 1) * width;
    uchar8 ca, cb, cc;
    if (whole) {
      ca = vload8(0, row + 3 * x0);
      cb = vload8(1, row + 3 * x0);
      cc = vload8(2, row + 3 * x0);
    } else {
      uchar pixels[3 * 8];
      copy_pixels(row, x0, width, 8, pixels);
      ca = vload8(0, pixels);
      cb = vload8(1, pixels);
      cc = vload8(2, pixels);
    }
    float8 a = convert_float8(ca), b = convert_float8(cb), c = convert_float8(cc);
    float w = row_weight[k];
    float s = row_slope[k];
    va += w * a;
    vb += w * b;
    vc += w * c;
    da += s * a;
    db += s * b;
    dc += s * c;
  }
  float8 red = RED_8(va, vb, vc), green = GREEN_8(va, vb, vc), blue = BLUE_8(va, vb, vc);
  return normalised_sample(sum8x4(wx, wy, dwx, dwy), sum8x4(wx * red, wx * green, wx * blue, 0.0f),
                           sum8x4(dwx * red, dwx * green, dwx * blue, 0.0f),
                           sum8x4(wx * RED_8(da, db, dc), wx * GREEN_8(da, db, dc), wx * BLUE_8(da, db, dc), 0.0f));
}

static ColorSample sample_color(global const uchar* restrict rgb, int width, int height, Vec2 uv, int radius,
                                float inv_sigma2) {
  if (2 * radius + 2 <= 8) return sample_few(rgb, width, height, uv, radius, inv_sigma2);
  return sample_many(rgb, width, height, uv, radius, inv_sigma2);
}
#else
TAP_WEIGHT(tap_weight, float)

static ColorSample sample_color(global const uchar* restrict rgb, int width, int height, Vec2 uv, int radius,
                                float inv_sigma2) {
  float u0 = LC_FLOOR(uv.x) - radius;
  float v0 = LC_FLOOR(uv.y) - radius;
  int x0 = (int)u0;
  int y0 = (int)v0;
  int n_taps = 2 * radius + 2;
  float wx[MAX_TAPS], dwx[MAX_TAPS];
  float sum_x = 0.0f, slope_x = 0.0f, sum_y = 0.0f, slope_y = 0.0f;
  for (int i = 0; i < n_taps; ++i) {
    tap_weight(u0 + i - uv.x, radius, inv_sigma2, &wx[i], &dwx[i]);
    sum_x += wx[i];
    slope_x += dwx[i];
  }
  ColorSample out;
  out.value = out.du = out.dv = vec3(0.0f, 0.0f, 0.0f);
  for (int k = 0; k < n_taps; ++k) {
    global const uchar* row = rgb + 3 * (size_t)clamp(y0 + k, 0, height - 1) * width;
    Vec3 sum = vec3(0.0f, 0.0f, 0.0f);
    Vec3 slope = sum;
    for (int i = 0; i < n_taps; ++i) {
      int x = 3 * clamp(x0 + i, 0, width - 1);
      Vec3 pixel = vec3(row[x], row[x + 1], row[x + 2]);
      sum = add3(sum, scale3(pixel, wx[i]));
      slope = add3(slope, scale3(pixel, dwx[i]));
    }
    float w, s;
    tap_weight(v0 + k - uv.y, radius, inv_sigma2, &w, &s);
    sum_y += w;
    slope_y += s;
    out.value = add3(out.value, scale3(sum, w));
    out.du = add3(out.du, scale3(slope, w));
    out.dv = add3(out.dv, scale3(sum, s));
  }
  float scale = 1.0f / (sum_x * sum_y * 255.0f);
  out.value = scale3(out.value, scale);
  out.du = sub3(scale3(out.du, scale), scale3(out.value, slope_x / sum_x));
  out.dv = sub3(scale3(out.dv, scale), scale3(out.value, slope_y / sum_y));
  return out;
}
#endif

// Colour samples at n given positions: positions [2n] px, out [9n] value, du, dv (RGB each).
kernel void sample_colors(int n, int width, int height, int radius, float inv_sigma2, global const uchar* restrict rgb,
                          global const float* restrict positions, global float* restrict out) {
  int i = get_global_id(0);
  if (i >= n) return;
  Vec2 uv = {positions[2 * i], positions[2 * i + 1]};
  ColorSample s = sample_color(rgb, width, height, uv, radius, inv_sigma2);
  vstore3((float3)(s.value.x, s.value.y, s.value.z), 3 * i, out);
  vstore3((float3)(s.du.x, s.du.y, s.du.z), 3 * i + 1, out);
  vstore3((float3)(s.dv.x, s.dv.y, s.dv.z), 3 * i + 2, out);
}

// Sets (not adds) this vertex's diagonal block, right-hand side and photometric energy; zero when it is invisible.
// order [n], visible [n] (mesh order), colors and v: 3 planes; blocks: 6 planes; rhs: 3 planes; energy: 1 plane.
kernel void photo_system(int n, int n_rows, int stride, int width, int height, int radius, float inv_sigma2,
                         float weight, float threshold, Pinhole cam, global const int* restrict order,
                         global const int* restrict visible, global const uchar* restrict rgb,
                         global const float* restrict colors, global const float* restrict v,
                         global float* restrict blocks, global float* restrict rhs, global float* restrict energy) {
  int row = get_global_id(0);
  if (row >= n_rows) return;
  VertexSystem sum = empty_system();
  float e = 0.0f;
  if (row < n && weight > 0.0f && visible[order[row]] != 0) {
    Vec3 p = vec3(v[row], v[stride + row], v[2 * stride + row]);
    if (p.z > LC_MIN_DEPTH_MM) {
      Vec2 uv = project_point(p, cam).uv;
      if (inside_image(uv, width, height)) {
        ColorSample s = sample_color(rgb, width, height, uv, radius, inv_sigma2);
        Vec3 c = vec3(colors[row], colors[stride + row], colors[2 * stride + row]);
        PhotoRow r = photo_row(p, cam, s.value, s.du, s.dv, c, threshold);
        LC_UNROLL
        for (int channel = 0; channel < 3; ++channel) {
          sum = add_row(sum, weight, r.r[channel], vec3(r.J[channel][0], r.J[channel][1], r.J[channel][2]));
          e += weight * r.r[channel] * r.r[channel];
        }
      }
    }
  }
  blocks[row] = sum.xx;
  blocks[stride + row] = sum.xy;
  blocks[2 * stride + row] = sum.xz;
  blocks[3 * stride + row] = sum.yy;
  blocks[4 * stride + row] = sum.yz;
  blocks[5 * stride + row] = sum.zz;
  rhs[row] = sum.rhs.x;
  rhs[stride + row] = sum.rhs.y;
  rhs[2 * stride + row] = sum.rhs.z;
  energy[row] = e;
}
