#include "match/texture_matcher.h"

#include <algorithm>
#include <cmath>

#include "base/luminance.h"
#include "base/round_up.h"
#include "base/text.h"
#include "livecap/error.h"
#include "shared/seen_weight.h"

namespace livecap {
namespace {

constexpr int kWidthStep = 16 << LC_MATCH_LEVELS;  // of a box: sixteen pixels divide every level's rows
constexpr int kBeyond = 32;                        // px around the person in the picture
constexpr int kMinTexture = 8;                     // px
constexpr int kMaxTexture = 1024;                  // px; finer than a picture shows, and small enough for a cache
constexpr size_t kPatchGroup = 64, kVertexGroup = 64;
static_assert((kWidthStep >> LC_MATCH_LEVELS) % LC_MATCH_TILE == 0 && kPatchGroup % LC_MATCH_PATCH == 0);

size_t pyramid_size(int width, int height) {
  size_t size = 0;
  for (int l = 0; l <= LC_MATCH_LEVELS; ++l) size += size_t(width >> l) * (height >> l);
  return size;
}

// Means of 2 x 2 pixels; an odd last row or column is left out.
ImageGray halved(const ImageGray& image) {
  ImageGray half{image.width / 2, image.height / 2, {}};
  half.pixels.reserve(size_t(half.width) * half.height);
  for (int y = 0; y < half.height; ++y) {
    const uint8_t* top = &image.pixels[size_t(2 * y) * image.width];
    const uint8_t* bottom = top + image.width;
    for (int x = 0; x < 2 * half.width; x += 2)
      half.pixels.push_back(uint8_t((top[x] + top[x + 1] + bottom[x] + bottom[x + 1] + 2) / 4));
  }
  return half;
}

// Every texel (low byte) with the one below it, from the last column and row on to the first ones again; [width + 2,
// height + 1].
std::vector<uint16_t> texel_pairs(const ImageGray& image) {
  std::vector<uint16_t> pairs;
  pairs.reserve(size_t(image.width + 2) * (image.height + 1));
  for (int y = 0; y <= image.height; ++y) {
    const uint8_t* top = &image.pixels[size_t((y + image.height - 1) % image.height) * image.width];
    const uint8_t* bottom = &image.pixels[size_t(y % image.height) * image.width];
    for (int x = 0; x <= image.width + 1; ++x) {
      const int column = (x + image.width - 1) % image.width;
      pairs.push_back(uint16_t(top[column] | bottom[column] << 8));
    }
  }
  return pairs;
}

}  // namespace

void MatchOptions::validate() const {
  const auto positive = [](const char* field, double value) {
    if (!(value > 0) || !std::isfinite(value))
      throw ConfigError(format("match option %s is %g; it must be finite and positive", field, value));
  };
  if (iterations < 1 || iterations > 100)
    throw ConfigError(format("match option iterations is %d; it must be in 1..100", iterations));
  if (!(blur >= 0 && blur <= 1)) throw ConfigError(format("match option blur is %g; it must be between 0 and 1", blur));
  positive("variance_floor", variance_floor);
  positive("softness", softness);
  positive("max_move_px", max_move_px);
  positive("depth_range_mm", depth_range_mm);
  if (!(weight_area_px >= 1) || !std::isfinite(weight_area_px))  // sums of weights must not wrap around (exact_sum.h)
    throw ConfigError(format("match option weight_area_px is %g; it must be finite and at least 1", weight_area_px));
  if (!(min_correlation > 0 && min_correlation < 1))
    throw ConfigError(format("match option min_correlation is %g; it must be between 0 and 1", min_correlation));
}

TextureMatcher::TextureMatcher(ocl::DeviceContext& device, const Actor& actor, const Camera& camera,
                               const MatchOptions& options, const char* program)
    : options_(options),
      width_(camera.width),
      height_(camera.height),
      focal_px_(float((camera.fx + camera.fy) / 2)),
      n_vertices_(actor.n_vertices()),
      is_cpu_(device.is_cpu()),
      host_(size_t(LC_MATCH) * actor.n_vertices(), 0.0f),
      matches_(device, host_.size()) {
  options.validate();
  matches_.fill(0);
  const ImageRgb& texture = actor.texture;
  if (texture.width < kMinTexture || texture.height < kMinTexture) return;
  ImageGray light{texture.width, texture.height, std::vector<uint8_t>(size_t(texture.width) * texture.height)};
  for (size_t p = 0; p < light.pixels.size(); ++p) {
    const uint8_t* c = &texture.pixels[3 * p];
    light.pixels[p] = uint8_t(std::lround(kRedLuminance * c[0] + kGreenLuminance * c[1] + kBlueLuminance * c[2]));
  }
  while (std::max(light.width, light.height) > kMaxTexture) light = halved(light);
  if (std::min(light.width, light.height) < 1 << LC_MATCH_LEVELS) return;  // a strip of colours
  texture_width_ = light.width;
  std::vector<uint16_t> texels;
  for (Texture& texture : textures_) {
    texture = {int(texels.size()), light.width, light.height};
    const std::vector<uint16_t> pairs = texel_pairs(light);
    texels.insert(texels.end(), pairs.begin(), pairs.end());
    light = halved(light);
  }
  std::vector<float> uvs;
  uvs.reserve(2 * actor.render.triangles.size());
  for (int32_t corner : actor.render.triangles)
    uvs.insert(uvs.end(), {actor.render.uvs[2 * corner], actor.render.uvs[2 * corner + 1]});

  const int w = int(round_up(width_ + 2 * kBeyond, kWidthStep)), h = int(round_up(height_ + 2 * kBeyond, 4));
  const size_t box = size_t(w) * h;
  texture_ = {device, texels};
  uvs_ = {device, uvs};
  areas_ = {device, vertex_areas(actor.mesh)};
  shade_ = {device, size_t(n_vertices_)};
  const size_t beside = is_cpu_ ? 0 : box;  // ActorSight keeps the actor behind the camera's pyramid
  light_ = {device, pyramid_size(w, h) + beside};
  weight_ = {device, pyramid_size(w, h) + beside};
  if (is_cpu_) sums_ = {device, 3 * box};
  blurred_ = {device, box};
  actor_ = {device, box};
  depth_ = {device, box};
  camera_ = {device, pyramid_size(w, h)};
  light_host_.resize(size_t(LC_LIT_SAMPLE) * n_vertices_);
  samples_ = {device, light_host_.size()};
  light_vertices_ = {device, program, "light_vertices"};
  textured_actor_ = {device, program, "textured_actor"};
  camera_picture_ = {device, program, "camera_picture"};
  blur_actor_ = {device, program, "blur_actor"};
  normalise_ = {device, program, "normalise"};
  halve_picture_ = {device, program, "halve_picture"};
  match_patches_ = {device, program, "match_patches"};
  sample_light_ = {device, program, "sample_light"};
}

void TextureMatcher::require_level(int level) {
  if (level < 0 || level > LC_MATCH_LEVELS)
    throw LogicError(format("match: level %d, must be 0..%d", level, LC_MATCH_LEVELS));
}

MatchBox TextureMatcher::level_box(int level) const {
  return {box_.x, box_.y, box_.width >> level, box_.height >> level};
}

// Where the level begins in a pyramid.
int TextureMatcher::level_offset(int level) const {
  int offset = 0;
  for (int l = 0; l < level; ++l) offset += (box_.width >> l) * (box_.height >> l);
  return offset;
}

// light and weight_ of a level, all from `offset` on.
void TextureMatcher::normalise(int level, int offset, const ocl::Buffer<float>& light, ocl::Buffer<float>& normal) {
  const MatchBox box = level_box(level);
  const size_t height = box.height;
  if (is_cpu_) {
    normalise_.launch((height + LC_MATCH_BAND - 1) / LC_MATCH_BAND, 1, box, level, offset, options_.variance_floor,
                      light, weight_, sums_, normal);
  } else {
    normalise_.launch(ocl::Range{size_t(box.width), round_up(height, LC_MATCH_TILE), LC_MATCH_TILE, LC_MATCH_TILE}, box,
                      level, offset, options_.variance_floor, light, weight_, normal);
  }
}

void TextureMatcher::set_box(const DeviceFrame& frame, const PixelBox& person) {
  if (!usable()) return;
  if (frame.width != width_ || frame.height != height_)
    throw LogicError(format("match: frame is %d x %d, the camera %d x %d", frame.width, frame.height, width_, height_));
  box_ = {0, 0, 0, 0};
  drawn_level_ = -1;
  if (person.empty()) return;
  if (person.x0 < 0 || person.y0 < 0 || person.x1 > width_ || person.y1 > height_)
    throw LogicError(
        format("match: the person's box ends at %d, %d of %d x %d", person.x1, person.y1, width_, height_));
  box_ = {person.x0 - kBeyond, person.y0 - kBeyond, int(round_up(person.width() + 2 * kBeyond, kWidthStep)),
          int(round_up(person.height() + 2 * kBeyond, 4))};
}

void TextureMatcher::set_picture(const DeviceFrame& frame, const PixelBox& person, int finest) {
  set_box(frame, person);
  if (box_.width == 0) return;
  camera_picture_.launch(ocl::Range{size_t(box_.width / 16), size_t(box_.height), 1, 1}, box_, width_, height_,
                         frame.rgb, frame.signed_distance, light_, weight_);
  for (int level = 0; level <= LC_MATCH_LEVELS; ++level) {
    const MatchBox box = level_box(level);
    const int offset = level_offset(level);
    if (level >= finest) normalise(level, offset, light_, camera_);
    if (level == LC_MATCH_LEVELS) break;
    halve_picture_.launch(ocl::Range{size_t(box.width / 16), size_t(box.height / 2), 1, 1}, box.width, box.width / 2,
                          box.height / 2, offset, offset + box.width * box.height, light_, weight_);
  }
}

void TextureMatcher::match(const DepthRasterizer& raster, const ocl::Buffer<float>& positions,
                           const ocl::Buffer<float>& normals, const ocl::Buffer<int32_t>& visible,
                           const ocl::Buffer<float>& share, int level) {
  if (!usable()) return;
  require_level(level);
  if (box_.width == 0) {
    matches_.fill(0);
    return;
  }
  const MatchBox box = level_box(level);
  const Texture& texture = textures_[level];
  const ocl::Range pixels{size_t(box.width), size_t(box.height), 16, 1}, rows{size_t(box.height), 1, 1, 1};
  light_vertices_.launch(n_vertices_, kVertexGroup, n_vertices_, lit_by_, normals, shade_);
  const auto draw = [&](const auto&... at) {
    textured_actor_.launch(is_cpu_ ? rows : pixels, box, level, width_, height_, texture.texels, texture.width,
                           texture.height, raster.triangle_ids(), raster.depth(), raster.projected(),
                           raster.triangles(), uvs_, shade_, texture_, at..., weight_, depth_);
  };
  if (is_cpu_) {
    draw(blurred_, light_);
  } else {
    draw(light_);
  }
  drawn_level_ = level;
  drawn_at_ = 0;
  blur_actor_.launch(
      ocl::Range{size_t(is_cpu_ ? box.width / 16 : box.width), size_t(box.height), is_cpu_ ? 1u : 16u, 1}, box,
      options_.blur, light_, weight_, blurred_);
  normalise(level, 0, blurred_, actor_);
  if (is_cpu_) {
    match_patches_.launch((n_vertices_ + LC_MATCH_VERTICES - 1) / LC_MATCH_VERTICES, 1, n_vertices_, box,
                          patch_options(level), level_offset(level), focal_px_, positions, normals, visible,
                          raster.projected(), areas_, share, actor_, depth_, camera_, matches_);
  } else {
    match_patches_.launch(size_t(LC_MATCH_PATCH) * n_vertices_, kPatchGroup, n_vertices_, box, patch_options(level),
                          level_offset(level), focal_px_, positions, normals, visible, raster.projected(), areas_,
                          share, actor_, depth_, camera_, matches_, ocl::LocalMemory{4 * sizeof(float) * kPatchGroup});
  }
}

PatchOptions TextureMatcher::patch_options(int level) const {
  return {level,
          options_.iterations,
          options_.softness,
          options_.max_move_px,
          options_.min_correlation,
          options_.depth_range_mm};
}

std::vector<LightSample> TextureMatcher::sample_light(const DeviceFrame& frame, const DepthRasterizer& raster,
                                                      const ocl::Buffer<float>& positions,
                                                      const ocl::Buffer<float>& normals,
                                                      const ocl::Buffer<int32_t>& visible) {
  std::vector<LightSample> samples;
  if (!usable() || box_.width == 0 || drawn_level_ != 0) return samples;
  sample_light_.launch(n_vertices_, kVertexGroup, n_vertices_, box_, drawn_at_, width_, height_, focal_px_, positions,
                       normals, visible, raster.projected(), areas_, shade_, light_, weight_, depth_,
                       frame.signed_distance, frame.rgb, samples_);
  samples_.read(light_host_);
  for (int i = 0; i < n_vertices_; ++i) {
    const float* s = &light_host_[size_t(LC_LIT_SAMPLE) * i];
    if (s[LC_LIT_WEIGHT] > 0) samples.push_back({{s[0], s[1], s[2]}, s[LC_LIT_BRIGHTNESS], s[LC_LIT_WEIGHT]});
  }
  return samples;
}

Matches TextureMatcher::read() {
  matches_.read(host_);
  return found();
}

void TextureMatcher::read_later() {
  matches_.read_later(host_);
}

Matches TextureMatcher::found() const {
  Matches matches;
  matches.found.reserve(n_vertices_ / 4);
  double matched = 0, visible = 0;
  for (int i = 0; i < n_vertices_; ++i) {
    const float* m = &host_[size_t(LC_MATCH) * i];
    const float px = m[LC_MATCH_WEIGHT_PX], seen_px = m[LC_MATCH_SEEN_PX];
    if (seen_px == 0 && px == 0) continue;
    visible += seen_px;
    if (!(px > 0)) continue;
    matched += px;
    matches.found.push_back({i, m[0], m[1], m[2], m[3], m[4], seen_weight(px, options_.weight_area_px)});
  }
  matches.missed_weight = (visible - matched) / options_.weight_area_px;
  matches.seen_weight = visible / options_.weight_area_px;
  return matches;
}

}  // namespace livecap
