#include "match/actor_sight.h"

#include <algorithm>

#include "match/layout.h"

namespace livecap {

static_assert(LC_SEE_LOCAL >= 4 * LC_SEE_GROUP, "sums of patches and of skin are where tiles were");

ActorSight::ActorSight(ocl::DeviceContext& device, const Camera& camera, Skinner& skinner, DepthRasterizer& rasterizer,
                       SurfaceVisibility& visibility, TextureMatcher& matcher, SkinShading& shading)
    : skinner_(skinner),
      rasterizer_(rasterizer),
      visibility_(visibility),
      matcher_(matcher),
      shading_(shading),
      pinhole_(pinhole_arg(camera)) {
  // Rounds that look by one launch also choose by one, which needs doubles (kernels/pose/choose.cl).
  if (device.is_cpu() || !device.info().has_long_atomics || !device.info().has_double || !matcher.usable() ||
      device.info().max_work_group_size < LC_SEE_GROUP ||
      device.info().local_memory_bytes < sizeof(float) * LC_SEE_LOCAL + 64)
    return;
  n_groups_ = std::max<size_t>(device.info().compute_units, 1);
  kernel_ = ocl::Kernel(device, "match/see_actor.cl", "see_actor");
  drawn_ = ocl::Buffer<uint64_t>(device, rasterizer.depth_.size());
  drawn_.fill(0);  // so that no triangle is out of range where a wait is given up
  usable_ = true;
}

void ActorSight::look(const Look& look) {
  TextureMatcher& m = matcher_;
  const SkinShading& s = shading_;
  TextureMatcher::require_level(look.level);
  const TextureMatcher::Texture& texture = m.textures_[look.level];
  const bool shades = look.shades && s.usable();
  const SeeOptions see{.least_moved_px = look.least_moved_px,
                       .n_vertices = skinner_.n_vertices_,
                       .n_triangles = rasterizer_.n_triangles_,
                       .n_skin = shades ? int(s.skin_.size()) : 0,
                       .new_picture = look.new_picture,
                       .width = rasterizer_.width_,
                       .height = rasterizer_.height_,
                       .cull = rasterizer_.cull_,
                       .contour_radius_px = visibility_.options_.contour_radius_px,
                       .visible_tolerance_mm = visibility_.options_.depth_tolerance_mm,
                       .contour_tolerance_mm = visibility_.options_.contour_tolerance_mm,
                       .texels = texture.texels,
                       .texture_width = texture.width,
                       .texture_height = texture.height,
                       .focal_px = m.focal_px_,
                       .blur = m.options_.blur,
                       .variance_floor = m.options_.variance_floor,
                       .min_facing = s.options_.min_facing,
                       .skin_range_mm = s.options_.depth_range_mm};
  m.drawn_level_ = look.level;
  m.drawn_at_ = m.level_offset(LC_MATCH_LEVELS + 1);
  const SkinShading::Tints tints = s.tints();
  const ocl::Buffer<int32_t>& no_ints = skinner_.bones_;
  const ocl::Buffer<float>& no_floats = skinner_.rest_;
  kernel_.launch(
      n_groups_ * LC_SEE_GROUP, LC_SEE_GROUP, see, pinhole_, m.box_, m.patch_options(look.level), m.lit_by_,
      tints.red_blue, tints.off, look.moved, skinner_.rest_, look.displacement, skinner_.bones_, skinner_.weights_,
      look.motions, skinner_.fan_offsets_, skinner_.fan_triangles_, visibility_.fan_triangles_, rasterizer_.triangles_,
      look.candidates ? *look.candidates : visibility_.all_candidates_, m.uvs_, m.texture_, m.areas_, look.share,
      shades ? s.vertices_ : no_ints, shades ? s.limbs_ : no_ints, shades ? s.albedo_ : no_floats,
      shades ? s.areas_ : no_floats, shades ? s.is_skin_ : look.frame.rgb, look.frame.rgb, look.frame.signed_distance,
      look.skinned, look.normals, rasterizer_.projected_, drawn_, visibility_.visible_, visibility_.contour_, m.light_,
      m.weight_, m.depth_, m.blurred_, m.actor_, m.camera_, m.matches_, m.shade_, shades ? s.samples_ : look.normals,
      look.state, ocl::LocalMemory{sizeof(float) * LC_SEE_LOCAL});
}

}  // namespace livecap
