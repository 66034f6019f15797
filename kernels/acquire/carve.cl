// Carving a visual hull: how far each node of a grid is outside of the silhouettes' cones (Laurentini 1994, with a
// distance instead of a bit, so that the surface lies between the nodes).
#ifdef LC_DEVICE

#include "acquire/layout.h"
#include "shared/camera.h"

typedef struct {
  float rotation[9];  // camera_from_rest, row major
  float translation[3];
  Pinhole pinhole;
} CarveView;

typedef struct {
  int nx, ny, nz;
  float low[3];  // mm, node (0,0,0)
  float step;    // mm
} CarveGrid;

// One view. largest[LC_CARVE_KEPT*i..]: the largest distances of node i to a view's cone so far, mm, positive outside,
// descending; that of an exact view counts as often as there is room, so that it cannot be overruled. n_seen[i]: views
// whose picture holds the node.
kernel void carve_view(int n, CarveGrid grid, CarveView view, int width, int height, int exact,
                       global const float* restrict signed_distance,  // [w*h] px, positive outside
                       global float* restrict largest, global int* restrict n_seen) {
  const int i = get_global_id(0);
  if (i >= n) return;
  const int x = i % grid.nx, y = i / grid.nx % grid.ny, z = i / (grid.nx * grid.ny);
  const float px = grid.low[0] + grid.step * x, py = grid.low[1] + grid.step * y, pz = grid.low[2] + grid.step * z;
  const float cx = view.rotation[0] * px + view.rotation[1] * py + view.rotation[2] * pz + view.translation[0];
  const float cy = view.rotation[3] * px + view.rotation[4] * py + view.rotation[5] * pz + view.translation[1];
  const float cz = view.rotation[6] * px + view.rotation[7] * py + view.rotation[8] * pz + view.translation[2];
  if (!(cz > LC_MIN_DEPTH_MM)) return;
  const float u = view.pinhole.fx * cx / cz + view.pinhole.cx, v = view.pinhole.fy * cy / cz + view.pinhole.cy;
  if (!(u >= 0.0f && v >= 0.0f && u <= (float)(width - 1) && v <= (float)(height - 1))) return;
  const int u0 = min((int)u, width - 2), v0 = min((int)v, height - 2);
  const float fu = u - u0, fv = v - v0;
  global const float* row = signed_distance + v0 * width + u0;
  const float px_distance =
      (1.0f - fv) * ((1.0f - fu) * row[0] + fu * row[1]) + fv * ((1.0f - fu) * row[width] + fu * row[width + 1]);
  float mm = px_distance * cz / view.pinhole.fx;
  n_seen[i] += 1;
  for (int k = 0; k < LC_CARVE_KEPT; ++k) {
    const float kept = largest[LC_CARVE_KEPT * i + k];
    largest[LC_CARVE_KEPT * i + k] = fmax(kept, mm);
    if (!exact) mm = fmin(kept, mm);
  }
}

// The hull's distance: the largest one after `n_ignored` views were overruled, below row y = n_low of the grid
// `n_ignored_low` (less than LC_CARVE_KEPT), between -limit and limit; a node seen by less than min_views, or by no
// more than may be overruled, is outside.
kernel void carve_result(int n, CarveGrid grid, int n_ignored, int n_low, int n_ignored_low, int min_views, float limit,
                         global const float* restrict largest, global const int* restrict n_seen,
                         global float* restrict distance) {
  const int i = get_global_id(0);
  if (i >= n) return;
  const int overruled = i / grid.nx % grid.ny < n_low ? n_ignored_low : n_ignored;
  distance[i] = n_seen[i] < min_views || n_seen[i] <= overruled
                    ? limit
                    : clamp(largest[LC_CARVE_KEPT * i + overruled], -limit, limit);
}

#endif
