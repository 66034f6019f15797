// What matches tell of how cloth drapes, by two shares that hold for all of it: how far it is from its simulated place
// towards its skinned one, and towards the vertical axis that it hangs around (src/cloth/drape.h).
#include "cloth/layout.h"
#include "match/layout.h"
#include "terms/match.cl"

static inline Vec3 point(global const float* points, int i) {
  return vec3(points[3 * i], points[3 * i + 1], points[3 * i + 2]);
}

static inline void move_by(Vec3 by, global float* points, int i) {
  points[3 * i] += by.x;
  points[3 * i + 1] += by.y;
  points[3 * i + 2] += by.z;
}

// vertices, levels [n]: of cloth, and how much nearer to the axis they go, 0 at the hips and 1 at the hem. only_skinned
// [3*n_all]: where skinning has every vertex, skinned: where cloth is simulated. Both ways are kept: ways [6*n].
// skinned goes along them by the shares of this frame, start and start_before, which have the displacements of the
// frames before, by those of these. Over n.
kernel void drape_cloth(int n, DrapeStep step, global const int* restrict vertices, global const float* restrict levels,
                        global const float* restrict only_skinned, global float* restrict skinned,
                        global float* restrict start, global float* restrict start_before,
                        global float* restrict ways) {
  const int k = get_global_id(0);
  if (k >= n) return;
  const int i = vertices[k];
  const Vec3 at = point(skinned, i), up = vec3(step.up_x, step.up_y, step.up_z);
  const Vec3 clings = scale3(sub3(point(only_skinned, i), at), step.trusted);
  const Vec3 from = sub3(at, vec3(step.axis_x, step.axis_y, step.axis_z));
  const Vec3 narrows = scale3(sub3(from, scale3(up, dot3(from, up))), -levels[k]);
  vstore3((float3)(clings.x, clings.y, clings.z), 2 * k, ways);
  vstore3((float3)(narrows.x, narrows.y, narrows.z), 2 * k + 1, ways);
  move_by(add3(scale3(clings, step.clings), scale3(narrows, step.narrows)), skinned, i);
  move_by(add3(scale3(clings, step.clings_1), scale3(narrows, step.narrows_1)), start, i);
  move_by(add3(scale3(clings, step.clings_2), scale3(narrows, step.narrows_2)), start_before, i);
}

// How far a point is in the picture from another place, by the directions a match is certain in: as mm at its depth.
// All three of look_at_drape are from there to the point, so that their signs do not matter.
static inline Vec2 judged_mm(Vec3 at, Vec2 place_px, Pinhole cam, global const float* match) {
  const MatchRow row = match_row(at, cam, place_px, match[2], match[3], match[4]);
  Vec2 mm;
  mm.x = at.z / cam.fx * row.r[0];
  mm.y = at.z / cam.fx * row.r[1];
  return mm;
}

static inline float dot2(Vec2 a, Vec2 b) {
  return a.x * b.x + a.y * b.y;
}

// matches [LC_MATCH*n_all]; those of visible vertices count by their weights. told [LC_DRAPE_TOLD]: the normal
// equations of how far matches are from skinned along both ways. sums: one for each work-item. In one work-group, of a
// power of two.
kernel void look_at_drape(int n, Pinhole cam, global const int* restrict vertices, global const int* restrict visible,
                          global const float* restrict skinned, global const float* restrict matches,
                          global const float* restrict ways, global float* restrict told, local float8* sums) {
  const int me = get_local_id(0), size = get_local_size(0);
  float8 mine = 0.0f;
  for (int k = me; k < n; k += size) {
    const int i = vertices[k];
    const Vec3 at = point(skinned, i), clings = add3(at, point(ways, 2 * k)),
               narrows = add3(at, point(ways, 2 * k + 1));
    global const float* match = matches + LC_MATCH * i;
    const float weight = match[LC_MATCH_WEIGHT_PX];
    if (!visible[i] || !(weight > 0.0f) || !(fmin(at.z, fmin(clings.z, narrows.z)) > LC_MIN_DEPTH_MM)) continue;
    Vec2 target;
    target.x = match[0];
    target.y = match[1];
    const Vec2 a = judged_mm(at, project_point(clings, cam).uv, cam, match);
    const Vec2 b = judged_mm(at, project_point(narrows, cam).uv, cam, match), off = judged_mm(at, target, cam, match);
    mine +=
        weight * (float8)(dot2(a, a), dot2(a, b), dot2(b, b), dot2(a, off), dot2(b, off), dot2(off, off), 1.0f, 0.0f);
  }
  sums[me] = mine;
  for (int half_size = size / 2; half_size > 0; half_size /= 2) {
    barrier(CLK_LOCAL_MEM_FENCE);
    if (me < half_size) sums[me] += sums[me + half_size];
  }
  if (me == 0) vstore8(sums[0], 0, told);
}
