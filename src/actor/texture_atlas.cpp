#include "actor/texture_atlas.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/srgb.h"

namespace livecap {

Eigen::Vector3d sample_texture(const ImageRgb& image, double u, double v) {
  auto wrap = [](int64_t i, int n) { return static_cast<size_t>(((i % n) + n) % n); };
  u -= std::floor(u);
  v -= std::floor(v);
  const double x = u * image.width - 0.5;
  const double y = v * image.height - 0.5;
  const auto x0 = static_cast<int64_t>(std::floor(x));
  const auto y0 = static_cast<int64_t>(std::floor(y));
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int dy = 0; dy < 2; ++dy) {
    for (int dx = 0; dx < 2; ++dx) {
      const double weight = (dx ? x - x0 : 1 - (x - x0)) * (dy ? y - y0 : 1 - (y - y0));
      const uint8_t* pixel =
          &image.pixels[3 * (wrap(y0 + dy, image.height) * image.width + wrap(x0 + dx, image.width))];
      for (int k = 0; k < 3; ++k) sum[k] += weight * pixel[k] / 255.0;
    }
  }
  return sum;
}

int TextureAtlas::add(ImageRgb tile) {
  lefts_.push_back(width_);
  width_ += tile.width;
  height_ = std::max<int64_t>(height_, tile.height);
  tiles_.push_back(std::move(tile));
  return n_tiles() - 1;
}

int TextureAtlas::add_color(const std::array<uint8_t, 3>& rgb) {
  ImageRgb tile{8, 8, {}};
  for (int i = 0; i < 64; ++i) tile.pixels.insert(tile.pixels.end(), rgb.begin(), rgb.end());
  return add(std::move(tile));
}

std::array<float, 2> TextureAtlas::place(int tile, double u, double v) const {
  if (n_tiles() <= 1) return {static_cast<float>(u), static_cast<float>(v)};
  // Coordinates exactly at 1 stay there; everything else repeats. Half a texel inside, so that no neighbour bleeds in.
  auto fraction = [](double t, int n) {
    if (t < 0 || t > 1) t -= std::floor(t);
    return std::clamp(t * n, 0.5, n - 0.5);
  };
  return {static_cast<float>((lefts_[tile] + fraction(u, tiles_[tile].width)) / width_),
          static_cast<float>(fraction(v, tiles_[tile].height) / height_)};
}

ImageRgb TextureAtlas::build() const {
  if (tiles_.empty()) return {};
  if (n_tiles() == 1) return tiles_[0];
  ImageRgb atlas{static_cast<int>(width_), static_cast<int>(height_), {}};
  atlas.pixels.assign(size_t{3} * atlas.width * atlas.height, 0);
  for (int i = 0; i < n_tiles(); ++i) {
    const ImageRgb& tile = tiles_[i];
    for (int y = 0; y < tile.height; ++y) {
      std::copy_n(tile.pixels.begin() + size_t{3} * y * tile.width, 3 * tile.width,
                  atlas.pixels.begin() + 3 * (static_cast<size_t>(y) * atlas.width + lefts_[i]));
    }
  }
  return atlas;
}

std::vector<float> vertex_colors_from_texture(const ImageRgb& texture, std::span<const float> uvs,
                                              std::span<const int32_t> render_triangles,
                                              std::span<const int32_t> template_vertex,
                                              std::span<const float> positions) {
  // Barycentric coordinates (own corner, next, last) spread over the third of a triangle nearest to a corner.
  constexpr double kSamples[][3] = {{0.96, 0.02, 0.02}, {0.72, 0.24, 0.04}, {0.72, 0.04, 0.24}, {0.56, 0.22, 0.22}};
  const size_t n_vertices = positions.size() / 3;
  std::vector<double> sum(3 * n_vertices, 0.0), weight(n_vertices, 0.0);
  auto point = [&](int32_t v) { return Eigen::Map<const Eigen::Vector3f>(positions.data() + 3 * v).cast<double>(); };
  for (size_t t = 0; t + 2 < render_triangles.size(); t += 3) {
    const int32_t r[3] = {render_triangles[t], render_triangles[t + 1], render_triangles[t + 2]};
    const Eigen::Vector3d a = point(template_vertex[r[0]]);
    const double area = (point(template_vertex[r[1]]) - a).cross(point(template_vertex[r[2]]) - a).norm();
    for (int k = 0; k < 3; ++k) {
      const int32_t own = r[k], next = r[(k + 1) % 3], last = r[(k + 2) % 3];
      Eigen::Vector3d color = Eigen::Vector3d::Zero();
      for (const auto& s : kSamples) {
        color += sample_texture(texture, s[0] * uvs[2 * own] + s[1] * uvs[2 * next] + s[2] * uvs[2 * last],
                                s[0] * uvs[2 * own + 1] + s[1] * uvs[2 * next + 1] + s[2] * uvs[2 * last + 1]);
      }
      const int32_t v = template_vertex[own];
      for (int c = 0; c < 3; ++c) sum[3 * v + c] += area * color[c] / std::size(kSamples);
      weight[v] += area;
    }
  }
  std::vector<float> colors(3 * n_vertices, 0.5f);
  for (size_t v = 0; v < n_vertices; ++v) {
    for (int c = 0; c < 3 && weight[v] > 0; ++c) colors[3 * v + c] = static_cast<float>(sum[3 * v + c] / weight[v]);
  }
  return colors;
}

double encode_srgb(double linear) {
  return srgb_from_linear(std::clamp(linear, 0.0, 1.0));
}

}  // namespace livecap
