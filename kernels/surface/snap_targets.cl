// Vertex snapping, first half (paper, "Vertex Snapping"): every contour vertex walks on the signed distance image along
// the negative gradient until the zero crossing; the move is lifted to 3D at constant depth.
#include "surface/image.h"
#include "surface/rings.h"
#include "terms/silhouette.cl"

#define MAX_WALK_STEPS 12
#define WALK_TOLERANCE_PX 0.02f  // stop
#define SNAP_TOLERANCE_PX 0.25f  // accept
#define MIN_SLOPE 0.3f           // |gradient| of a distance is 1 except on ridges, where no direction is right

// order [n]; rigidity [n_rows] rows; contour, vertex_part [n], normals, vertices [3n] mesh order, mm.
// part_image [width*height] is read only when has_parts != 0. moves: 2 planes mm (x, y); rings: 1 plane.
kernel void snap_targets(int n, int n_rows, int stride, int width, int height, float max_rigidity, float max_move_px,
                         int has_parts, Pinhole cam, global const int* restrict order,
                         global const float* restrict rigidity, global const int* restrict contour,
                         global const float* restrict normals, global const float* restrict signed_distance,
                         global const uchar* restrict part_image, global const int* restrict vertex_part,
                         global const float* restrict vertices, global float* restrict moves,
                         global float* restrict rings) {
  int row = get_global_id(0);
  if (row >= n_rows) return;
  moves[row] = 0.0f;
  moves[stride + row] = 0.0f;
  rings[row] = RING_HELD;
  if (row >= n || !(rigidity[row] <= max_rigidity)) return;
  rings[row] = RING_FREE;
  int vertex = order[row];
  if (contour[vertex] == 0) return;
  Vec3 p = vec3(vertices[3 * vertex], vertices[3 * vertex + 1], vertices[3 * vertex + 2]);
  if (!(p.z > LC_MIN_DEPTH_MM)) return;
  Projection q = project_point(p, cam);
  Vec2 uv = q.uv;
  if (!inside_image(uv, width, height)) return;
  if (has_parts && on_other_part(part_image, width, height, uv, vertex_part[vertex])) return;
  DistanceSample d = sample_distance(signed_distance, width, height, uv);
  Vec3 normal = vec3(normals[3 * vertex], normals[3 * vertex + 1], normals[3 * vertex + 2]);
  if (silhouette_direction(d.value, d.gradient, project_direction(q, normal)) <= 0.0f) return;

  for (int k = 0; k < MAX_WALK_STEPS && fabs(d.value) > WALK_TOLERANCE_PX; ++k) {
    float slope2 = d.gradient.x * d.gradient.x + d.gradient.y * d.gradient.y;
    if (!(slope2 > MIN_SLOPE * MIN_SLOPE)) return;
    float step = d.value / slope2;
    uv.x -= step * d.gradient.x;
    uv.y -= step * d.gradient.y;
    float du = uv.x - q.uv.x, dv = uv.y - q.uv.y;
    if (!(du * du + dv * dv <= max_move_px * max_move_px) || !inside_image(uv, width, height)) return;
    d = sample_distance(signed_distance, width, height, uv);
  }
  if (!(fabs(d.value) <= SNAP_TOLERANCE_PX)) return;
  if (has_parts && on_other_part(part_image, width, height, uv, vertex_part[vertex])) return;
  moves[row] = (uv.x - q.uv.x) * p.z / cam.fx;
  moves[stride + row] = (uv.y - q.uv.y) * p.z / cam.fy;
  rings[row] = 0.0f;
}

// vertices += moves inside the band. Depth stays.
kernel void snap_apply(int n, int stride, float n_rings, global const int* restrict order,
                       global const float* restrict rings, global const float* restrict moves,
                       global float* restrict vertices) {
  int row = get_global_id(0);
  if (row >= n || rings[row] > n_rings) return;
  int vertex = order[row];
  vertices[3 * vertex] += moves[row];
  vertices[3 * vertex + 1] += moves[stride + row];
}
