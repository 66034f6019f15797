#include "picture/overlay.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "livecap/error.h"
#include "picture/rasterize.h"

namespace livecap {
namespace {

constexpr float kMaxPixel = 1e6f;
constexpr float kOverlayAmbient = 0.55f;
constexpr float kKeyAmbient = 0.26f, kKeyFromCamera = 0.24f, kKey = 0.72f;
constexpr float kGrey = 190;
constexpr float kLightCheck = 225, kDarkCheck = 70;
constexpr float kWireShade = 0.4f;

using Eigen::Vector3f;

// A corner of a render triangle.
struct Corner {
  ScreenPoint at;
  Vector3f color;  // 0..255, or with checks the place at rest, mm
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

Vector3f check_color(const Vector3f& rest_mm, float side_mm) {
  int sum = 0;
  for (int k = 0; k < 3; ++k) sum += static_cast<int>(std::floor(rest_mm[k] / side_mm));
  return Vector3f::Constant(sum % 2 ? kDarkCheck : kLightCheck);
}

// px from a pixel to the nearest edge of a triangle that covers it. w: the corners' shares, linear in the picture.
float edge_distance(const Corner (&c)[3], const float (&w)[3]) {
  const float area =
      std::abs((c[1].at.x - c[0].at.x) * (c[2].at.y - c[0].at.y) - (c[1].at.y - c[0].at.y) * (c[2].at.x - c[0].at.x));
  float nearest = area;
  for (int k = 0; k < 3; ++k) {
    const ScreenPoint &a = c[(k + 1) % 3].at, &b = c[(k + 2) % 3].at;
    nearest = std::min(nearest, w[k] * area / std::hypot(b.x - a.x, b.y - a.y));
  }
  return nearest;
}

class Painter {
 public:
  Painter(const Actor& actor, const Camera& camera, const OverlayOptions& options, const ImageRgb& background,
          ImageRgb& out)
      : actor_(actor),
        camera_(camera),
        options_(options),
        background_(background),
        out_(out),
        nearest_(camera.width, camera.height) {}

  void triangle(const Corner (&c)[3]) {
    rasterize({c[0].at, c[1].at, c[2].at}, nearest_, [&](int x, int y, const float(&w)[3], float inv_z) {
      float share[3];
      for (int k = 0; k < 3; ++k) share[k] = w[k] * (c[k].at.nearness / inv_z);
      Vector3f color = surface_color(c, share);
      if (options_.wire_px > 0 && edge_distance(c, w) < options_.wire_px / 2) color *= kWireShade;
      pixel(x, y, color, c, share);
    });
  }

 private:
  Vector3f surface_color(const Corner (&c)[3], const float (&w)[3]) const {
    const bool painted = options_.checks_mm > 0 || !options_.colors.empty();
    if (!painted && !options_.texture) return Vector3f::Constant(kGrey);
    if (!painted && !actor_.texture.empty())
      return sample(actor_.texture, w[0] * c[0].uv + w[1] * c[1].uv + w[2] * c[2].uv);
    const Vector3f value = w[0] * c[0].color + w[1] * c[1].color + w[2] * c[2].color;
    return options_.checks_mm > 0 ? check_color(value, options_.checks_mm) : value;
  }

  // Of a surface with this normal, of any length, seen along this ray. Both of its sides are lit alike.
  float brightness(const Vector3f& normal, const Vector3f& ray) const {
    const float length = normal.norm() * ray.norm();
    const float cosine = length > 0 ? std::abs(normal.dot(ray)) / length : 1;
    if (!options_.key_light) return kOverlayAmbient + (1 - kOverlayAmbient) * cosine;
    static const Vector3f kToLamp = Vector3f(-0.55f, -0.65f, -0.53f).normalized();
    const float towards = (normal.dot(ray) > 0 ? -1.f : 1.f) * normal.dot(kToLamp) / std::max(normal.norm(), 1e-6f);
    return kKeyAmbient + kKeyFromCamera * cosine + kKey * std::max(0.f, towards);
  }

  void pixel(int x, int y, Vector3f color, const Corner (&c)[3], const float (&w)[3]) {
    if (options_.shading) {
      const Vector3f normal = w[0] * c[0].normal + w[1] * c[1].normal + w[2] * c[2].normal;
      const Vector3f ray((x - static_cast<float>(camera_.cx)) / static_cast<float>(camera_.fx),
                         (y - static_cast<float>(camera_.cy)) / static_cast<float>(camera_.fy), 1);
      color *= brightness(normal, ray);
    }
    const uint8_t* from = &background_.pixels[3 * (size_t(y) * background_.width + x)];
    uint8_t* to = &out_.pixels[3 * (size_t(y) * out_.width + x)];
    for (int k = 0; k < 3; ++k)
      to[k] = static_cast<uint8_t>(std::clamp(from[k] + options_.alpha * (color[k] - from[k]) + 0.5f, 0.f, 255.f));
  }

  const Actor& actor_;
  const Camera& camera_;
  const OverlayOptions& options_;
  const ImageRgb& background_;
  ImageRgb& out_;
  NearnessImage nearest_;  // 1/mm
};

// What is interpolated over the triangles around vertex i.
Vector3f vertex_color(const Actor& actor, const OverlayOptions& options, int32_t i) {
  if (options.checks_mm > 0) return Eigen::Map<const Vector3f>(&actor.mesh.positions[3 * i]);
  const std::span<const float> colors = options.colors.empty() ? actor.colors : options.colors;
  return colors.empty() ? Vector3f::Constant(kGrey) : Vector3f(255 * Eigen::Map<const Vector3f>(&colors[3 * i]));
}

}  // namespace

void OverlayOptions::validate() const {
  if (!(alpha >= 0 && alpha <= 1)) throw ConfigError(format("overlay: alpha %g must be in 0..1", alpha));
  if (!(checks_mm >= 0)) throw ConfigError(format("overlay: checks of %g mm must be 0 or more", checks_mm));
  if (!(wire_px >= 0)) throw ConfigError(format("overlay: edges of %g px must be 0 or more", wire_px));
}

ImageRgb render_overlay(const Actor& actor, std::span<const float> positions_camera, const Camera& camera,
                        const ImageRgb& background, const OverlayOptions& options) {
  options.validate();
  if (positions_camera.size() != actor.mesh.positions.size())
    throw LogicError(format("overlay: %zu coordinates for %d vertices", positions_camera.size(), actor.n_vertices()));
  if (!options.colors.empty() && options.colors.size() != positions_camera.size())
    throw LogicError(
        format("overlay: %zu colours for %zu coordinates", options.colors.size(), positions_camera.size()));
  if (background.width != camera.width || background.height != camera.height)
    throw ConfigError(format("overlay: picture of %dx%d for a camera of %dx%d", background.width, background.height,
                             camera.width, camera.height));
  ImageRgb out = background;
  const std::vector<float> normals = vertex_normals(positions_camera, actor.mesh.triangles);
  Painter painter(actor, camera, options, background, out);
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
      const float inv_z = 1 / p[2];
      corner.at = {static_cast<float>(camera.fx) * p[0] * inv_z + static_cast<float>(camera.cx),
                   static_cast<float>(camera.fy) * p[1] * inv_z + static_cast<float>(camera.cy), inv_z};
      drawn &= std::abs(corner.at.x) < kMaxPixel && std::abs(corner.at.y) < kMaxPixel;
      corner.normal = Vector3f(normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]);
      corner.color = vertex_color(actor, options, i);
      corner.uv = mesh.uvs.empty() ? Eigen::Vector2f::Zero() : Eigen::Vector2f(mesh.uvs[2 * r], mesh.uvs[2 * r + 1]);
    }
    if (drawn) painter.triangle(corners);
  }
  return out;
}

}  // namespace livecap
