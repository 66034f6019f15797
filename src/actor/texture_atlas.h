// One texture for the whole actor, and the vertex colours C_i read from it. Private to the actor room.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "base/image_rgb.h"

namespace livecap {

// Bilinear sample at glTF texture coordinates (v down, repeat wrap), sRGB in [0,1].
Eigen::Vector3d sample_texture(const ImageRgb& image, double u, double v);

// Places tiles side by side. One tile stays as it is and its coordinates keep their wrap.
class TextureAtlas {
 public:
  // Returns the tile's index. An empty image is not allowed.
  int add(ImageRgb tile);
  int add_color(const std::array<uint8_t, 3>& rgb);
  // Texture coordinates of tile `tile` in the finished atlas.
  std::array<float, 2> place(int tile, double u, double v) const;
  ImageRgb build() const;
  int n_tiles() const { return static_cast<int>(tiles_.size()); }
  // Of the finished atlas.
  int64_t width() const { return width_; }
  int64_t height() const { return height_; }

 private:
  std::vector<ImageRgb> tiles_;
  std::vector<int64_t> lefts_;  // of each tile
  int64_t width_ = 0, height_ = 0;
};

// Mean texture colour around each template vertex: every corner of every triangle contributes samples of its third of
// the triangle, weighted by the triangle's area. [3*n_vertices], sRGB in [0,1]; grey for vertices without triangles.
std::vector<float> vertex_colors_from_texture(const ImageRgb& texture, std::span<const float> uvs,
                                              std::span<const int32_t> render_triangles,
                                              std::span<const int32_t> template_vertex,
                                              std::span<const float> positions);

// Linear to sRGB encoding of one channel, which files may have beyond [0, 1].
double encode_srgb(double linear);

}  // namespace livecap
