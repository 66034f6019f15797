// All that a round of stage I sees of the actor, in one launch on GPUs whose work-groups can wait for each other: skins
// and draws it, finds visible and contour vertices, draws its texture, moves patches and measures skin; for the first
// round of a frame the camera's pyramid as well. The kernels of these files one after the other do the same.
#if !LC_CPU && defined(cl_khr_int64_extended_atomics)
#include "match/layout.h"
#define LC_RASTER_APART 2
#define TILE_WIDTH LC_SEE_TILE_WIDTH
// Those that share a patch are of one warp: LC_SEE_GROUP is a multiple of 32.
#ifdef __NV_CL_C_VERSION
#define LC_MEET() asm volatile("bar.warp.sync 0xffffffff;" ::: "memory")
#else
#define LC_MEET() barrier(CLK_LOCAL_MEM_FENCE)
#endif
#include "raster/layout.h"
#include "shared/all_arrived.h"
// Those that contract products first: raster/triangle.h ends that.
#include "raster/visibility.cl"
//
#include "match/blur.cl"
#include "match/camera_picture.cl"
#include "match/light.cl"
#include "match/normalise.cl"
#include "match/patch_match.cl"
#include "match/textured_actor.cl"
//
#include "match/camera_block.h"
#include "match/skin_shading.cl"
#include "surface/skin.cl"
//
#include "raster/depth.cl"
//
#include "raster/depth_and_id.h"

// A work-item's place where work is dealt out to the groups 32 items at a time: what only some items have to do is then
// spread over the whole device.
static int dealt_place(void) {
  const int id = get_local_id(0);
  return (id / 32 * (int)get_num_groups(0) + (int)get_group_id(0)) * 32 + id % 32;
}

static MatchBox level_box(MatchBox box, int level) {
  const MatchBox at_level = {box.x, box.y, box.width >> level, box.height >> level};
  return at_level;
}

// Where a level begins in a pyramid.
static int level_offset(MatchBox box, int level) {
  int offset = 0;
  for (int k = 0; k < level; ++k) offset += (box.width >> k) * (box.height >> k);
  return offset;
}

static int tile_columns(MatchBox box) {
  return (box.width + TILE_WIDTH - 1) / TILE_WIDTH;
}

static int n_tiles(MatchBox box) {
  return tile_columns(box) * ((box.height + TILE - 1) / TILE);
}

// moved: how far the round before moved a keypoint, px; below 0 where it failed. box: of the picture. dual_quats,
// displacement, rest, bones, weights: surface/skin.cl; fan_offsets, fan_corners: likewise; fan_triangles, candidates:
// raster/visibility.cl; share to camera, light to box_depth: match/patch_match.cl and match/textured_actor.cl (light,
// weight: the camera's pyramid, then the actor's box; blurred: match/blur.cl); skin_vertices to off_tint:
// match/skin_shading.cl. Out: those not const; both [width*height]: raster/depth_and_id.h. state: see all_arrived.h.
// memory: LC_SEE_LOCAL floats.
kernel __attribute__((reqd_work_group_size(LC_SEE_GROUP, 1, 1))) void see_actor(
    SeeOptions see, float4 pinhole, MatchBox box, PatchOptions patch, Harmonics lit_by, float4 tints, float2 off_tint,
    global const float* moved, global const float* rest, global const float* displacement, global const int* bones,
    global const float* weights, global const float* dual_quats, global const int* fan_offsets,
    global const int* fan_corners, global const int* fan_triangles, global const int* triangles,
    global const int* candidates, global const float* uvs, global const ushort* texture, global const float* areas,
    global const float* share, global const int* skin_vertices, global const int* limbs, global const float* albedo,
    global const float* skin_areas, global const uchar* is_skin, global const uchar* rgb,
    global const float* signed_distance, global float* skinned, global float* normals, global float* projected,
    global ulong* both, global int* visible, global int* contour, global float* light, global float* weight,
    global float* box_depth, global float* blurred, global float* actor, global float* camera, global float* matches,
    global float* shade, global float* samples, volatile global int* state, local float4* memory) {
  const int id = dealt_place(), n_items = get_global_size(0), back = n_items - 1 - id;
  const int group = get_group_id(0), n_groups = get_num_groups(0), n = see.n_vertices;
  const MatchBox here = level_box(box, patch.level);
  const int actor_at = level_offset(box, LC_MATCH_LEVELS + 1);
  global const int* drawn_ids = (global const int*)both;
  global const float* drawn_depth = (global const float*)both + 1;
  local int given_up, somebody[2];  // of a tile and the next one
  if (get_local_id(0) == 0) somebody[0] = 0;
  if (moved[0] < see.least_moved_px) return;

  for (int i = id; i < n; i += n_items) {
    skin_lanes(i, n, rest, displacement, bones, weights, dual_quats, skinned);
    project_lanes(i, n, pinhole, skinned, projected);
  }
  const int n_pixels = see.width * see.height, n_clears = (n_pixels + LC_RASTER_CLEAR - 1) / LC_RASTER_CLEAR;
  for (int i = back; i < n_clears; i += n_items) clear_both(i, n_pixels, both);
  for (int i = back; see.new_picture && i < box.width / 4 * (box.height / 4); i += n_items)
    camera_block(i, box, see.width, see.height, rgb, signed_distance, light, weight);
  int together = all_arrived(1, state, n_groups, &given_up);  // otherwise nothing more is done

  const int per_triangle = clamp(n_items / max(see.n_triangles, 1), 1, LC_RASTER_SHARE);  // nobody has two then
  for (int i = id; together && i < see.n_triangles * per_triangle; i += n_items)
    draw_both(i, per_triangle, see.width, see.height, see.cull, projected, triangles, both);
  for (int i = back; together && i < n; i += n_items) {
    normal_of_vertex(i, n, skinned, fan_offsets, fan_corners, normals);
    shade[i] = shade_of(i, lit_by, normals);
  }
  together = all_arrived(together, state, 2 * n_groups, &given_up);

  for (int i = back; together && i < n; i += n_items) {
    visible[i] =
        visible_lanes(i, n, see.width, see.height, see.visible_tolerance_mm, skinned, normals, projected, drawn_depth);
    contour[i] = contour_lanes(i, n, see.width, see.height, see.contour_radius_px, see.contour_tolerance_mm, projected,
                               fan_offsets, fan_triangles, candidates, triangles, drawn_depth);
  }
  for (int i = id; together && i < here.width * here.height; i += n_items)
    draw_texture(i % here.width, i / here.width, here, patch.level, see.width, see.height, see.texels,
                 see.texture_width, see.texture_height, drawn_ids, drawn_depth, projected, triangles, uvs, shade,
                 texture, light + actor_at, weight + actor_at, box_depth);
  together = all_arrived(together, state, 3 * n_groups, &given_up);

  for (int i = id; together && i < here.width * here.height; i += n_items)
    blur_pixel(i % here.width, i / here.width, here, see.blur, light + actor_at, weight + actor_at, blurred);
  together = all_arrived(together, state, 4 * n_groups, &given_up);

  // The actor's tiles, then those of the camera's levels.
  int n_all = n_tiles(here);
  for (int level = 0; see.new_picture && level <= LC_MATCH_LEVELS; ++level) n_all += n_tiles(level_box(box, level));
  for (int first = group, turn = 0; together && first < n_all; first += n_groups, turn ^= 1) {
    int tile = first, level = patch.level, of = -1;
    for (int left = n_tiles(here); tile >= left; left = n_tiles(level_box(box, level))) {
      tile -= left;
      level = ++of;
    }
    const MatchBox at_level = level_box(box, level);
    const int columns = tile_columns(at_level), at = of < 0 ? actor_at : level_offset(box, level);
    normalise_tile(tile % columns, tile / columns, get_local_id(0), at_level, level, see.variance_floor,
                   of < 0 ? blurred : light + at, weight + at, (local float*)memory, somebody + turn,
                   of < 0 ? actor : camera + at);
    if (get_local_id(0) == 0) somebody[turn ^ 1] = 0;
    barrier(CLK_LOCAL_MEM_FENCE);
  }
  together = all_arrived(together, state, 5 * n_groups, &given_up);

  const Level at_level = {here.width, here.height, actor, box_depth, camera + level_offset(box, patch.level)};
  for (int first = group * LC_SEE_GROUP / PATCH; together && first < n; first += n_groups * LC_SEE_GROUP / PATCH)
    match_vertex(first + get_local_id(0) / PATCH, n, at_level, patch, see.focal_px, skinned, normals, visible,
                 projected, areas, share, memory, matches, box.x, box.y);
  for (int first = (n_groups - 1 - group) * LC_SEE_GROUP / LC_SKIN_SHARE; together && first < see.n_skin;
       first += n_groups * LC_SEE_GROUP / LC_SKIN_SHARE)
    sample_skin(first + get_local_id(0) / LC_SKIN_SHARE, see.n_skin, see.width, see.height, see.focal_px,
                see.min_facing, see.skin_range_mm, tints, off_tint, skin_vertices, limbs, albedo, skin_areas, is_skin,
                skinned, normals, visible, projected, drawn_ids, drawn_depth, triangles, signed_distance, rgb, samples,
                memory);
}
#endif
