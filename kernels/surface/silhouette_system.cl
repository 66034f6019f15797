// E_silhouette of the surface stage: adds every contour vertex's share of J^T J and -J^T F.
#include "surface/add_system.h"
#include "surface/image.h"
#include "terms/silhouette.cl"

// contour, vertex_part [n], normals [3n]: mesh order. part_image [width*height] is read only when has_parts != 0.
// v: 3 planes; blocks (6 planes) and rhs (3 planes) are added to; energy (1 plane) is set.
kernel void silhouette_system(int n, int n_rows, int stride, int width, int height, float weight, int has_parts,
                              Pinhole cam, global const int* restrict order, global const int* restrict contour,
                              global const float* restrict normals, global const float* restrict signed_distance,
                              global const uchar* restrict part_image, global const int* restrict vertex_part,
                              global const float* restrict v, global float* restrict blocks, global float* restrict rhs,
                              global float* restrict energy) {
  int row = get_global_id(0);
  if (row >= n_rows) return;
  energy[row] = 0.0f;
  if (row >= n || weight <= 0.0f) return;
  int vertex = order[row];
  if (contour[vertex] == 0) return;
  Vec3 p = vec3(v[row], v[stride + row], v[2 * stride + row]);
  if (!(p.z > LC_MIN_DEPTH_MM)) return;
  Projection q = project_point(p, cam);
  if (!inside_image(q.uv, width, height)) return;
  if (has_parts && on_other_part(part_image, width, height, q.uv, vertex_part[vertex])) return;  // b_i = 0
  DistanceSample d = sample_distance(signed_distance, width, height, q.uv);
  Vec3 normal = vec3(normals[3 * vertex], normals[3 * vertex + 1], normals[3 * vertex + 2]);
  float b = silhouette_direction(d.value, d.gradient, project_direction(q, normal));
  SilhouetteRow r = silhouette_row(p, cam, d.value, d.gradient, b);
  VertexSystem s = add_row(empty_system(), weight, r.r, vec3(r.J[0], r.J[1], r.J[2]));
  add_system(s, row, stride, blocks, rhs);
  energy[row] = weight * r.r * r.r;
}
