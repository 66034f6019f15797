#include "raster/overlay.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr float kMinDepthMm = 100;
constexpr float kMaxPixel = 1e6f;
constexpr float kAmbient = 0.55f;
constexpr float kGrey = 190;

using Eigen::Vector3f;

// A corner of a render triangle, everything that is interpolated divided by depth.
struct Corner {
  float u, v, inv_z;
  Vector3f color;  // 0..255
  Vector3f normal;
  Eigen::Vector2f uv;
};

Vector3f sample(const ImageRgb& texture, const Eigen::Vector2f& uv) {
  const float x = (uv.x() - std::floor(uv.x())) * static_cast<float>(texture.width) - 0.5f;
  const float y = (uv.y() - std::floor(uv.y())) * static_cast<float>(texture.height) - 0.5f;
  const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
  const float fx = x - static_cast<float>(x0), fy = y - static_cast<float>(y0);
  auto texel = [&](int i, int j) {
    i = std::clamp(i, 0, texture.width - 1);
    j = std::clamp(j, 0, texture.height - 1);
    const uint8_t* p = &texture.pixels[3 * (size_t(j) * texture.width + i)];
    return Vector3f(p[0], p[1], p[2]);
  };
  return (texel(x0, y0) * (1 - fx) + texel(x0 + 1, y0) * fx) * (1 - fy) +
         (texel(x0, y0 + 1) * (1 - fx) + texel(x0 + 1, y0 + 1) * fx) * fy;
}

class Painter {
 public:
  Painter(const Actor& actor, const Camera& camera, const OverlayOptions& options, const ImageRgb& background,
          ImageRgb& out, int x_offset)
      : actor_(actor),
        camera_(camera),
        options_(options),
        background_(background),
        out_(out),
        x_offset_(x_offset),
        depth_(size_t(camera.width) * camera.height, std::numeric_limits<float>::infinity()) {}

  void triangle(const Corner (&c)[3]) {
    const float area = (c[1].u - c[0].u) * (c[2].v - c[0].v) - (c[1].v - c[0].v) * (c[2].u - c[0].u);
    if (area == 0) return;
    const int x0 = static_cast<int>(std::ceil(std::max(0.f, std::min({c[0].u, c[1].u, c[2].u}))));
    const int x1 = static_cast<int>(std::floor(std::min<float>(camera_.width - 1, std::max({c[0].u, c[1].u, c[2].u}))));
    const int y0 = static_cast<int>(std::ceil(std::max(0.f, std::min({c[0].v, c[1].v, c[2].v}))));
    const int y1 =
        static_cast<int>(std::floor(std::min<float>(camera_.height - 1, std::max({c[0].v, c[1].v, c[2].v}))));
    for (int y = y0; y <= y1; ++y) {
      for (int x = x0; x <= x1; ++x) {
        float w[3];
        bool inside = true;
        for (int k = 0; k < 3; ++k) {
          const Corner& a = c[(k + 1) % 3];
          const Corner& b = c[(k + 2) % 3];
          w[k] = ((b.u - a.u) * (y - a.v) - (b.v - a.v) * (x - a.u)) / area;
          inside &= w[k] >= 0;
        }
        if (!inside) continue;
        const float inv_z = w[0] * c[0].inv_z + w[1] * c[1].inv_z + w[2] * c[2].inv_z;
        float& nearest = depth_[size_t(y) * camera_.width + x];
        if (!(1 / inv_z < nearest)) continue;
        nearest = 1 / inv_z;
        for (int k = 0; k < 3; ++k) w[k] *= c[k].inv_z / inv_z;
        pixel(x, y, c, w);
      }
    }
  }

 private:
  void pixel(int x, int y, const Corner (&c)[3], const float (&w)[3]) {
    Vector3f color;
    if (!options_.texture) {
      color = Vector3f::Constant(kGrey);
    } else if (!actor_.texture.empty()) {
      color = sample(actor_.texture, w[0] * c[0].uv + w[1] * c[1].uv + w[2] * c[2].uv);
    } else {
      color = w[0] * c[0].color + w[1] * c[1].color + w[2] * c[2].color;
    }
    if (options_.shading) {
      const Vector3f normal = w[0] * c[0].normal + w[1] * c[1].normal + w[2] * c[2].normal;
      const Vector3f ray((x - static_cast<float>(camera_.cx)) / static_cast<float>(camera_.fx),
                         (y - static_cast<float>(camera_.cy)) / static_cast<float>(camera_.fy), 1);
      const float length = normal.norm() * ray.norm();
      const float cosine = length > 0 ? std::abs(normal.dot(ray)) / length : 1;
      color *= kAmbient + (1 - kAmbient) * cosine;
    }
    const uint8_t* from = &background_.pixels[3 * (size_t(y) * background_.width + x)];
    uint8_t* to = &out_.pixels[3 * (size_t(y) * out_.width + x_offset_ + x)];
    for (int k = 0; k < 3; ++k)
      to[k] = static_cast<uint8_t>(std::clamp(from[k] + options_.alpha * (color[k] - from[k]) + 0.5f, 0.f, 255.f));
  }

  const Actor& actor_;
  const Camera& camera_;
  const OverlayOptions& options_;
  const ImageRgb& background_;
  ImageRgb& out_;
  int x_offset_;
  std::vector<float> depth_;  // [w*h] mm
};

}  // namespace

void OverlayOptions::validate() const {
  if (!(alpha >= 0 && alpha <= 1)) throw ConfigError(format("overlay: alpha %g must be in 0..1", alpha));
}

ImageRgb render_overlay(const Actor& actor, std::span<const float> positions_camera, const Camera& camera,
                        const ImageRgb& background, const OverlayOptions& options) {
  options.validate();
  if (positions_camera.size() != actor.mesh.positions.size())
    throw LogicError(format("overlay: %zu coordinates for %d vertices", positions_camera.size(), actor.n_vertices()));
  if (background.width != camera.width || background.height != camera.height)
    throw ConfigError(format("overlay: picture of %dx%d for a camera of %dx%d", background.width, background.height,
                             camera.width, camera.height));
  ImageRgb out{options.side_by_side ? 2 * background.width : background.width, background.height, {}};
  out.pixels.resize(size_t(3) * out.width * out.height);
  for (int y = 0; y < out.height; ++y) {
    for (int copy = 0; copy <= static_cast<int>(options.side_by_side); ++copy) {
      std::copy_n(&background.pixels[size_t(3) * y * background.width], size_t(3) * background.width,
                  &out.pixels[3 * (size_t(y) * out.width + size_t(copy) * background.width)]);
    }
  }
  const std::vector<float> normals = vertex_normals(positions_camera, actor.mesh.triangles);
  Painter painter(actor, camera, options, background, out, options.side_by_side ? background.width : 0);
  const RenderMesh& mesh = actor.render;
  for (size_t t = 0; t + 2 < mesh.triangles.size(); t += 3) {
    Corner corners[3];
    bool drawn = true;
    for (int k = 0; k < 3; ++k) {
      const int32_t r = mesh.triangles[t + k];
      const int32_t i = mesh.template_vertex[r];
      const float* p = &positions_camera[3 * i];
      Corner& corner = corners[k];
      drawn &= p[2] > kMinDepthMm;
      corner.inv_z = 1 / p[2];
      corner.u = static_cast<float>(camera.fx) * p[0] * corner.inv_z + static_cast<float>(camera.cx);
      corner.v = static_cast<float>(camera.fy) * p[1] * corner.inv_z + static_cast<float>(camera.cy);
      drawn &= std::abs(corner.u) < kMaxPixel && std::abs(corner.v) < kMaxPixel;
      corner.normal = Vector3f(normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]);
      corner.color = actor.colors.empty() ? Vector3f::Constant(kGrey)
                                          : Vector3f(255 * Eigen::Map<const Vector3f>(&actor.colors[3 * i]));
      corner.uv = mesh.uvs.empty() ? Eigen::Vector2f::Zero() : Eigen::Vector2f(mesh.uvs[2 * r], mesh.uvs[2 * r + 1]);
    }
    if (drawn) painter.triangle(corners);
  }
  return out;
}

}  // namespace livecap
