#include "match/skin_shading.h"

#include <algorithm>
#include <cmath>

#include "actor/labels.h"
#include "base/text.h"
#include "geometry/mesh.h"
#include "livecap/error.h"
#include "match/layout.h"
#include "shared/exact_sum.h"
#include "shared/seen_weight.h"

namespace livecap {
namespace {

constexpr float kLeastAlbedo = 0.02;
constexpr double kLeastSeenPx = 60;
constexpr size_t kSkinGroup = 64;

// The number of each bone's limb, -1 where it is not a long one; hands and feet have folds and nails.
std::vector<int> long_limbs(const Skeleton& skeleton) {
  std::vector<int> limbs(skeleton.n_bones(), -1);
  int limb = 0;
  for (const char* side : {"left_", "right_"}) {
    for (const char* joint : {"shoulder", "elbow", "hip", "knee"}) {
      const int bone = skeleton.bone_index(std::string(side) + joint);
      if (bone >= 0) limbs[bone] = limb;
      ++limb;
    }
  }
  return limbs;
}

}  // namespace

void SkinShadingOptions::validate() const {
  light.validate();
  const auto positive = [](const char* field, double value) {
    if (!(value > 0) || !std::isfinite(value))
      throw ConfigError(format("shading option %s is %g; it must be finite and positive", field, value));
  };
  positive("min_facing", min_facing);
  positive("depth_range_mm", depth_range_mm);
  positive("limb_area_px", limb_area_px);
}

SkinShading::SkinShading(ocl::DeviceContext& device, const Actor& actor, const Camera& camera,
                         const SkinShadingOptions& options)
    : options_(options),
      width_(camera.width),
      height_(camera.height),
      focal_px_(float((camera.fx + camera.fy) / 2)),
      is_cpu_(device.is_cpu()),
      lights_{SkinLight(options.light), SkinLight(options.light)} {
  options.validate();
  const std::vector<int> limb_of_bone = long_limbs(actor.skeleton);
  const std::vector<float> all_areas = vertex_areas(actor.mesh);
  std::vector<int32_t> vertices, limbs;
  std::vector<float> albedo, areas;
  std::vector<uint8_t> is_skin(actor.n_vertices(), 0);
  for (int i = 0; i < actor.n_vertices(); ++i) {
    const int label = actor.labels[i], bone = actor.skin.bones[4 * i];
    if (label < lip::kLeftArm || label > lip::kRightLeg || limb_of_bone[bone] < 0) continue;
    skin_.push_back({i, bone, limb_of_bone[bone], label >= lip::kLeftLeg ? 1 : 0});
    limbs.push_back(2 * skin_.back().limb + skin_.back().light);
    const float* c = &actor.colors[3 * i];
    vertices.push_back(i);
    for (int k = 0; k < 3; ++k) albedo.push_back(std::max(kLeastAlbedo, c[k] * c[k]));
    areas.push_back(all_areas[i]);
    is_skin[i] = 1;
  }
  if (!usable()) return;
  vertices_ = {device, vertices};
  limbs_ = {device, limbs};
  albedo_ = {device, albedo};
  areas_ = {device, areas};
  is_skin_ = {device, is_skin};
  host_.resize(LC_SKIN * skin_.size());
  samples_ = {device, host_.size()};
  kernel_ = {device, "match/match.cl", "skin_brightness"};
}

void SkinShading::measure(const DeviceFrame& frame, const DepthRasterizer& raster, const ocl::Buffer<float>& positions,
                          const ocl::Buffer<float>& normals, const ocl::Buffer<int32_t>& visible) {
  if (!usable()) return;
  if (frame.width != width_ || frame.height != height_)
    throw LogicError(
        format("shading: frame is %d x %d, the camera %d x %d", frame.width, frame.height, width_, height_));
  const int n = int(skin_.size());
  const Tints tint = tints();
  const auto launch = [&](size_t n_items, const auto&... more) {
    kernel_.launch(n_items, kSkinGroup, n, width_, height_, focal_px_, options_.min_facing, options_.depth_range_mm,
                   tint.red_blue, tint.off, vertices_, limbs_, albedo_, areas_, is_skin_, positions, normals, visible,
                   raster.projected(), raster.triangle_ids(), raster.depth(), raster.triangles(), frame.signed_distance,
                   frame.rgb, samples_, more...);
  };
  if (is_cpu_) return launch(n);
  launch(size_t(LC_SKIN_SHARE) * n, ocl::LocalMemory{4 * sizeof(float) * kSkinGroup});
}

SkinShading::Tints SkinShading::tints() const {
  Tints tints{};
  for (int i = 0; i < 2; ++i) {
    for (int k = 0; k < 2; ++k) tints.red_blue.of[2 * i + k] = float(lights_[i].tint()[k]);
    tints.off.of[i] = float(lights_[i].off_tint());
  }
  return tints;
}

std::vector<SkinSample> SkinShading::read() {
  samples_.read(host_);
  return samples();
}

void SkinShading::read_later() {
  samples_.read_later(host_);
}

std::vector<SkinSample> SkinShading::samples() const {
  std::vector<SkinSample> samples;
  if (!usable()) return samples;
  for (int i = 0; i < int(skin_.size()); ++i) {
    const float* s = &host_[size_t(LC_SKIN) * i];
    const float px = s[LC_SKIN_PX];
    if (px > 0 || px < 0)
      samples.push_back({i, {s[0], s[1], s[2]}, s[LC_SKIN_BRIGHTNESS], px, {s[LC_SKIN_TINT], s[LC_SKIN_TINT + 1]}});
  }
  return samples;
}

std::vector<ShadedVertex> SkinShading::shaded(std::span<const SkinSample> samples) const {
  std::array<lc_exact_t, LC_SKIN_LIMBS> seen{};  // px^2
  for (const SkinSample& s : samples) {
    lc_exact_t& px = seen[skin_[s.index].limb];
    px = std::min(px + LC_EXACT(std::max(0.0f, s.area_px)), LC_MOST_LIMB_PX);
  }
  const SeenSkin by = this->seen();
  std::vector<ShadedVertex> shaded;
  for (const SkinSample& s : samples) {
    const SkinVertex& skin = skin_[s.index];
    const SeenSkin::Light& light = by.lights[skin.light];
    if (!light.is_known || !(s.area_px > 0)) continue;
    shaded.push_back({.vertex = skin.vertex,
                      .light = light.light,
                      .brightness = in_deviations(s.brightness, light.deviation),
                      .weight = seen_weight(s.area_px, limb_px_of_one(seen[skin.limb], by.limb_area_px))});
  }
  return shaded;
}

SeenSkin SkinShading::seen() const {
  SeenSkin seen{&samples_, &vertices_, &limbs_, options_.limb_area_px, {}};
  for (size_t i = 0; i < lights_.size(); ++i) {
    SeenSkin::Light& light = seen.lights[i];
    light.is_known = lights_[i].harmonics().known();
    light.deviation = lights_[i].harmonics().deviation();
    for (size_t k = 0; k < light.light.size(); ++k)
      light.light[k] = float(lights_[i].harmonics().light()[k] / light.deviation);
  }
  return seen;
}

double SkinShading::misfit(std::span<const SkinSample> samples, int bone, const Eigen::Matrix3d& turn,
                           double huber) const {
  double sum = 0, seen = 0;
  for (const SkinSample& s : samples) {
    const SkinVertex& skin = skin_[s.index];
    if (skin.bone != bone || !(s.area_px > 0) || !lights_[skin.light].harmonics().known()) continue;
    const double r = std::abs(lights_[skin.light].harmonics().residual(turn * s.normal.cast<double>(), s.brightness));
    sum += s.area_px * (r > huber ? huber * (2 * r - huber) : r * r);
    seen += s.area_px;
  }
  return seen > kLeastSeenPx ? sum / seen : 0;
}

void SkinShading::learn(std::span<const SkinSample> samples) {
  for (int i = 0; i < int(lights_.size()); ++i) {
    std::vector<SkinSample> here;
    std::copy_if(samples.begin(), samples.end(), std::back_inserter(here),
                 [&](const SkinSample& s) { return skin_[s.index].light == i; });
    lights_[i].learn(here);
  }
}

void SkinShading::forget() {
  lights_.fill(SkinLight(options_.light));
}

}  // namespace livecap
