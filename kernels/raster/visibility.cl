// Which vertices the camera sees, and which of them make the outer silhouette (paper, "Dense Silhouette Alignment").
// Over the vertices, LANES each.
#include "raster/layout.h"
#include "shared/lanes.h"
#include "shared/plain_math.h"

#ifdef LC_DEVICE

typedef struct {
  REAL z;               // mm
  LaneInt x, y;         // pixel
  LaneInt is_in_image;  // and is projected
} VertexPixel;

// projected: [4*n] u, v, 1/z (0 = not projected), z.
static inline VertexPixel vertex_pixel(LaneInt i, int width, int height, global const float* restrict projected) {
  VertexPixel p;
  const Vec4 vertex = gather_vec4(projected, 4 * i);
  p.x = LANE_INT(LC_RINT(vertex.x));
  p.y = LANE_INT(LC_RINT(vertex.y));
  p.z = vertex.w;
  p.is_in_image = vertex.z > 0.0f && p.x >= 0 && p.y >= 0 && p.x < width && p.y < height;
  return p;
}

// The lanes from vertex `first` on: 1 where vertex i projects into the image, its normal faces the camera, and nothing
// in the 3x3 pixels around it lies in front of it by more than the tolerance everywhere (an empty pixel hides nothing).
// positions [3*n] mm, camera frame; normals [3*n]; projected [4*n] u, v, 1/z, z; depth [w*h] mm.
static inline LaneInt visible_lanes(int first, int n, int width, int height, float tolerance_mm,
                                    global const float* restrict positions, global const float* restrict normals,
                                    global const float* restrict projected, global const float* restrict depth) {
  const LaneInt i = lane_rows(first, n);
  const VertexPixel q = vertex_pixel(i, width, height, projected);
  const Vec3 p = gather_vec3(positions, i), normal = gather_vec3(normals, i);
  const LaneInt looks = q.is_in_image && p.x * normal.x + p.y * normal.y + p.z * normal.z < 0.0f;
  LaneInt seen = 0;
  if (ANY_LANE(looks)) {
    REAL farthest = 0.0f;
    for (int dv = -1; dv <= 1; ++dv) {
      for (int du = -1; du <= 1; ++du) {
        const LaneInt u = clamp(q.x + du, (LaneInt)0, (LaneInt)(width - 1));
        const LaneInt v = clamp(q.y + dv, (LaneInt)0, (LaneInt)(height - 1));
        const REAL d = gather(depth, LC_RASTER_APART * (v * width + u));
        farthest = farthest > d ? farthest : d;
      }
    }
    const LaneInt one = 1, none = 0;
    seen = looks && q.z <= farthest + tolerance_mm ? one : none;
  }
  return seen;
}

// 1 towards the camera, -1 away, 0 edge-on or not projected. faces: of the kernel below.
static inline LaneInt face_side(LaneInt triangle, global const float* restrict projected,
                                global const int* restrict faces) {
#if LC_CPU
  (void)projected;
  return gather_int(faces, triangle);
#else
  const int3 index = vload3(triangle, faces);
  const float4 a = vload4(index.x, projected);
  const float4 b = vload4(index.y, projected);
  const float4 c = vload4(index.z, projected);
  // Counter-clockwise seen from outside is negative in an image whose y points down.
  const float area = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
  const int projects = a.z > 0.0f && b.z > 0.0f && c.z > 0.0f;
  return !projects ? 0 : area < 0.0f ? 1 : area > 0.0f ? -1 : 0;
#endif
}

// The disc of radius_px around pixel (x, y) leaves the rendered mask inside the image, and what is rendered there does
// not hide the depth z.
static inline int is_at_outline(int x, int y, float z, int width, int height, int radius_px, float tolerance_mm,
                                global const float* restrict depth) {
#if LC_CPU
  if (radius_px <= 3 && x >= 3 && x + 5 <= width) {
    // Eight pixels of a row at a time; reading outside the image would be wrong above and below it as well.
    const int8 du = (int8)(-3, -2, -1, 0, 1, 2, 3, 4);
    int8 empty = 0;
    float8 far = 0.0f;
    for (int v = max(y - radius_px, 0); v <= min(y + radius_px, height - 1); ++v) {
      const int8 in_disc = du * du <= radius_px * radius_px - (v - y) * (v - y);
      const float8 d = vload8(0, depth + v * width + x - 3);
      const int8 drawn = d < INFINITY;
      empty |= in_disc & ~drawn;
      far = (in_disc & drawn) && d > far ? d : far;
    }
    if (!any_of_8(empty)) return 0;
    const float4 four = LC_GREATER(far.lo, far.hi);
    const float2 two = LC_GREATER(four.lo, four.hi);
    const float most = LC_GREATER(two.x, two.y);
    return most == 0.0f || z <= most + tolerance_mm ? 1 : 0;
  }
#endif
  int outside = 0;
  float farthest = 0.0f;  // of the rendered pixels
#if !LC_CPU
  for (int dv = -radius_px; dv <= radius_px; ++dv) {
    const int v = clamp(y + dv, 0, height - 1);
#pragma unroll 5
    for (int du = -radius_px; du <= radius_px; ++du) {  // loaded whether it counts or not: no look waits for another
      const int u = clamp(x + du, 0, width - 1);
      const float d = depth[LC_RASTER_APART * (v * width + u)];
      const int counts = u == x + du && v == y + dv && du * du + dv * dv <= radius_px * radius_px;
      const int drawn = d < INFINITY;
      outside |= counts && !drawn;
      farthest = counts && drawn && d > farthest ? d : farthest;
    }
  }
#else
  for (int dv = -radius_px; dv <= radius_px; ++dv) {
    for (int du = -radius_px; du <= radius_px; ++du) {
      const int u = x + du;
      const int v = y + dv;
      if (u < 0 || v < 0 || u >= width || v >= height || du * du + dv * dv > radius_px * radius_px) continue;
      const float d = depth[v * width + u];
      if (d < INFINITY) {
        farthest = farthest > d ? farthest : d;
      } else {
        outside = 1;
      }
    }
  }
#endif
  return outside && (farthest == 0.0f || z <= farthest + tolerance_mm) ? 1 : 0;
}

// The lanes from vertex `first` on: 1 where vertex i lies on an edge between a front and a back face (or on an open
// edge of the mesh) and is_at_outline. Only such vertices project onto the outline itself; others near it would be
// pulled outwards by their distance to it. fan_offsets [n+1], fan_triangles [fan_offsets[n]]; candidates [n]: 1 on an
// open edge, 0 elsewhere, -1 for vertices that are not asked for; faces: sides [n_triangles], on GPUs corners
// [3*n_triangles].
static inline LaneInt contour_lanes(int first, int n, int width, int height, int radius_px, float tolerance_mm,
                                    global const float* restrict projected, global const int* restrict fan_offsets,
                                    global const int* restrict fan_triangles, global const int* restrict candidates,
                                    global const int* restrict faces, global const float* restrict depth) {
  const LaneInt i = lane_rows(first, n);
  const VertexPixel q = vertex_pixel(i, width, height, projected);
  LaneInt result = 0;
  if (ANY_LANE(q.is_in_image)) {
    const LaneInt begin = gather_int(fan_offsets, i), end = gather_int(fan_offsets, i + 1), none = 0;
    LaneInt front = 0, back = 0;
#if LC_CPU
    for (LaneInt k = begin; ANY_LANE(k < end); k += 1) {
      const LaneInt is_one = k < end;
      const LaneInt side = face_side(gather_int(fan_triangles, is_one ? k : none), projected, faces);
      front |= is_one && side > 0;
      back |= is_one && side < 0;
    }
#else
    (void)none;
    for (int first = begin; first < end; first += 4) {
#pragma unroll
      for (int k = 0; k < 4; ++k) {  // loaded at once; those beyond the last are the last again
        const int side = face_side(fan_triangles[min(first + k, end - 1)], projected, faces);
        front |= side > 0;
        back |= side < 0;
      }
    }
#endif
    const LaneInt candidate = gather_int(candidates, i);
    const LaneInt bends = q.is_in_image && candidate >= 0 && ((front && back) || (candidate > 0 && (front || back)));
#if LC_CPU
    int x[LANES], y[LANES], at_outline[LANES];
    float z[LANES];
    STORE_LANES(q.x, x);
    STORE_LANES(q.y, y);
    STORE_LANES(q.z, z);
    STORE_LANES(result, at_outline);
    for (uint left = lane_bits(bends); left; left &= left - 1) {
      const int k = lowest_bit(left);
      at_outline[k] = is_at_outline(x[k], y[k], z[k], width, height, radius_px, tolerance_mm, depth);
    }
    result = LOAD_LANES(at_outline);
#else
    if (bends) result = is_at_outline(q.x, q.y, q.z, width, height, radius_px, tolerance_mm, depth);
#endif
  }
  return result;
}

// Over the vertices, LANES each, as are the next. Out: visible [n].
kernel void visible_vertices(int n, int width, int height, float tolerance_mm, global const float* restrict positions,
                             global const float* restrict normals, global const float* restrict projected,
                             global const float* restrict depth, global int* restrict visible) {
  const int first = FIRST_ROW;
  if (first >= n) return;
  store_rows(visible_lanes(first, n, width, height, tolerance_mm, positions, normals, projected, depth), visible, first,
             n);
}

// Out: contour [n].
kernel void contour_vertices(int n, int width, int height, int radius_px, float tolerance_mm,
                             global const float* restrict projected, global const int* restrict fan_offsets,
                             global const int* restrict fan_triangles, global const int* restrict candidates,
                             global const int* restrict faces, global const float* restrict depth,
                             global int* restrict contour) {
  const int first = FIRST_ROW;
  if (first >= n) return;
  store_rows(contour_lanes(first, n, width, height, radius_px, tolerance_mm, projected, fan_offsets, fan_triangles,
                           candidates, faces, depth),
             contour, first, n);
}

#if !LC_CPU
// Both in one launch. tolerances_mm: of visible, then of contour vertices.
kernel void visible_and_contour(int n, int width, int height, int radius_px, float2 tolerances_mm,
                                global const float* restrict positions, global const float* restrict normals,
                                global const float* restrict projected, global const int* restrict fan_offsets,
                                global const int* restrict fan_triangles, global const int* restrict candidates,
                                global const int* restrict faces, global const float* restrict depth,
                                global int* restrict visible, global int* restrict contour) {
  const int first = FIRST_ROW;
  if (first >= n) return;
  store_rows(visible_lanes(first, n, width, height, tolerances_mm.x, positions, normals, projected, depth), visible,
             first, n);
  store_rows(contour_lanes(first, n, width, height, radius_px, tolerances_mm.y, projected, fan_offsets, fan_triangles,
                           candidates, faces, depth),
             contour, first, n);
}

#endif
#endif
