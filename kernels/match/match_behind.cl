// What the camera does not see of hanging cloth: a skirt swings as a whole, so what is behind is moved as what is seen
// of cloth at its pixel, from where both began in this frame to its match or, where it has none, to where it is now.
// Not from where the body or the simulation has them: where a thigh lifts the front it stays, and the back does not
// follow.
#include "match/layout.h"
#include "raster/layout.h"
#include "shared/camera.h"

static inline Vec2 pixel_of(global const float* restrict points, int i, Pinhole cam) {
  return project_point(vec3(points[3 * i], points[3 * i + 1], points[3 * i + 2]), cam).uv;
}

// hangs [n] 1 or 0; visible [n]; ids [width*height], triangles [3*n_triangles], projected [4*n]: of the rasteriser, of
// where the vertices are now; start [3*n] mm, camera frame: where they began. matches [LC_MATCH*n]: as match_patches
// and match_anew left them; those of vertices that are neither visible nor matched are set, with `share` for
// correlation, where the triangle at their pixel hangs and is seen (at a rim it may be one of their own). For
// match_system alone: their SEEN_PX stays 0. Over the vertices.
kernel void match_behind(int n, int width, int height, float share, Pinhole cam, global const float* restrict hangs,
                         global const int* restrict visible, global const int* restrict ids,
                         global const int* restrict triangles, global const float* restrict projected,
                         global const float* restrict start, global float* restrict matches) {
  const int i = get_global_id(0);
  if (i >= n || visible[i] || !(hangs[i] > 0.0f) || !(projected[4 * i + 2] > 0.0f)) return;
  if (matches[LC_MATCH * i + LC_MATCH_WEIGHT_PX] > 0.0f) return;  // seen from another start
  if (!(start[3 * i + 2] > LC_MIN_DEPTH_MM)) return;
  const int x = (int)rint(projected[4 * i]), y = (int)rint(projected[4 * i + 1]);
  if (x < 0 || y < 0 || x >= width || y >= height) return;
  const int t = ids[LC_RASTER_APART * (y * width + x)];
  if (t < 0) return;
  float du = 0.0f, dv = 0.0f, n_seen = 0.0f;
  for (int k = 0; k < 3; ++k) {
    const int corner = triangles[3 * t + k];
    if (!(hangs[corner] > 0.0f)) return;
    if (!visible[corner] || !(start[3 * corner + 2] > LC_MIN_DEPTH_MM)) continue;
    global const float* match = matches + LC_MATCH * corner;
    global const float* now = match[LC_MATCH_WEIGHT_PX] > 0.0f ? match : projected + 4 * corner;
    const Vec2 began = pixel_of(start, corner, cam);
    du += now[0] - began.x;
    dv += now[1] - began.y;
    n_seen += 1.0f;
  }
  if (n_seen == 0.0f) return;
  const Vec2 began = pixel_of(start, i, cam);
  vstore8((float8)(began.x + du / n_seen, began.y + dv / n_seen, 1.0f, 0.0f, 1.0f, 1.0f, share, 0.0f), 0,
          matches + LC_MATCH * i);
}
