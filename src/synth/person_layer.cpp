// The person by scan conversion with a depth buffer, and the shadow on the floor; see renderer.h.
#include <cmath>
#include <limits>
#include <opencv2/imgproc.hpp>

#include "synth/renderer.h"

namespace livecap::synth {

namespace {

struct Sample {
  float depth = std::numeric_limits<float>::infinity();
  int triangle = -1;
  float b1 = 0, b2 = 0;  // perspective-correct weights of corners 1 and 2
};

std::vector<Vec3> vertex_normals_of(const Surface& surface, const std::vector<Vec3>& vertices) {
  std::vector<Vec3> normals(vertices.size(), Vec3::Zero());
  for (const auto& t : surface.triangles) {
    const Vec3 n = (vertices[t[1]] - vertices[t[0]]).cross(vertices[t[2]] - vertices[t[0]]);
    for (int i = 0; i < 3; ++i) normals[t[i]] += n;
  }
  for (Vec3& n : normals) n /= std::max(n.norm(), 1e-12);
  return normals;
}

const std::array<float, 256>& srgb_table() {
  static const auto table = [] {
    std::array<float, 256> t;
    for (int i = 0; i < 256; ++i) t[i] = linear_from_srgb(static_cast<float>(i) / 255);
    return t;
  }();
  return table;
}

Color sample_texture(const ImageRgb& texture, double u, double v) {
  const auto& table = srgb_table();
  const double x = std::clamp(u * texture.width - 0.5, 0.0, texture.width - 1.001);
  const double y = std::clamp(v * texture.height - 0.5, 0.0, texture.height - 1.001);
  const int ix = static_cast<int>(x), iy = static_cast<int>(y);
  const float fx = static_cast<float>(x - ix), fy = static_cast<float>(y - iy);
  const uint8_t* a = &texture.pixels[3 * (static_cast<size_t>(iy) * texture.width + ix)];
  const uint8_t* b = a + 3 * static_cast<size_t>(texture.width);
  Color c;
  for (int k = 0; k < 3; ++k)
    c[k] = (1 - fy) * ((1 - fx) * table[a[k]] + fx * table[a[k + 3]]) +
           fy * ((1 - fx) * table[b[k]] + fx * table[b[k + 3]]);
  return c;
}

// The samples a person covers, kept to the rows and columns the person reaches.
class SampleBuffer {
 public:
  SampleBuffer(const View& view, const std::vector<Vec3>& camera_points) : width_(view.camera.width * kSamplesPerSide) {
    const int height = view.camera.height * kSamplesPerSide;
    double low = height, high = 0;
    for (const Vec3& p : camera_points) {
      points_.push_back(to_samples(view.camera, p));
      low = std::min(low, points_.back().y());
      high = std::max(high, points_.back().y());
    }
    first_row_ = std::clamp(static_cast<int>(std::floor(low)), 0, height);
    last_row_ = std::clamp(static_cast<int>(std::ceil(high)) + 1, first_row_, height);
    samples_.resize(static_cast<size_t>(width_) * (last_row_ - first_row_));
  }

  void draw(int triangle, const Eigen::Vector3i& t) {
    const Vec3 &a = points_[t[0]], &b = points_[t[1]], &c = points_[t[2]];  // x, y in samples; z = 1/depth
    if (!(a.z() > 0 && b.z() > 0 && c.z() > 0)) return;                     // behind the camera
    const double area = (b.x() - a.x()) * (c.y() - a.y()) - (b.y() - a.y()) * (c.x() - a.x());
    if (area >= -1e-9) return;  // turned away: y goes down, so what faces the camera runs clockwise
    const int x0 = std::max(0, static_cast<int>(std::ceil(std::min({a.x(), b.x(), c.x()}))));
    const int x1 = std::min(width_ - 1, static_cast<int>(std::floor(std::max({a.x(), b.x(), c.x()}))));
    const int y0 = std::max(first_row_, static_cast<int>(std::ceil(std::min({a.y(), b.y(), c.y()}))));
    const int y1 = std::min(last_row_ - 1, static_cast<int>(std::floor(std::max({a.y(), b.y(), c.y()}))));
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) {
        const double w1 = ((x - a.x()) * (c.y() - a.y()) - (y - a.y()) * (c.x() - a.x())) / area;
        const double w2 = ((b.x() - a.x()) * (y - a.y()) - (b.y() - a.y()) * (x - a.x())) / area;
        const double w0 = 1 - w1 - w2;
        if (w0 < 0 || w1 < 0 || w2 < 0) continue;
        const double inverse = w0 * a.z() + w1 * b.z() + w2 * c.z();
        const float depth = static_cast<float>(1 / inverse);
        Sample& sample = samples_[static_cast<size_t>(y - first_row_) * width_ + x];
        if (depth < sample.depth)
          sample = {depth, triangle, static_cast<float>(w1 * b.z() / inverse),
                    static_cast<float>(w2 * c.z() / inverse)};
      }
  }

  int width() const { return width_; }
  int first_row() const { return first_row_; }
  int last_row() const { return last_row_; }
  const Sample& at(int x, int y) const { return samples_[static_cast<size_t>(y - first_row_) * width_ + x]; }

 private:
  // Pixel centres are integers, so pixel x holds the samples at x -0.25 and x +0.25.
  static Vec3 to_samples(const Camera& camera, const Vec3& p) {
    if (p.z() < 50) return {0, 0, -1};
    const double x = camera.fx * p.x() / p.z() + camera.cx, y = camera.fy * p.y() / p.z() + camera.cy;
    return {(x + 0.5) * kSamplesPerSide - 0.5, (y + 0.5) * kSamplesPerSide - 0.5, 1 / p.z()};
  }

  int width_, first_row_ = 0, last_row_ = 0;
  std::vector<Vec3> points_;
  std::vector<Sample> samples_;
};

// Coverage of the floor by the mesh seen along `direction`, added to a map of square cells.
constexpr int kShadowCells = 440;
constexpr double kShadowCell = 10;  // mm

void cover_floor(const Surface& surface, const std::vector<Vec3>& vertices, const Vec3& direction, double below_mm,
                 cv::Mat& map) {
  cv::Mat hit = cv::Mat::zeros(map.size(), CV_8U);
  std::vector<cv::Point> points(vertices.size());
  constexpr int kShift = 4;
  for (size_t i = 0; i < vertices.size(); ++i) {
    const Vec3 p = vertices[i] - direction * (vertices[i].y() / direction.y());
    points[i] = {static_cast<int>(std::lround((p.x() / kShadowCell + kShadowCells / 2) * (1 << kShift))),
                 static_cast<int>(std::lround((p.z() / kShadowCell + kShadowCells / 2) * (1 << kShift)))};
  }
  for (const auto& t : surface.triangles) {
    if (std::min({vertices[t[0]].y(), vertices[t[1]].y(), vertices[t[2]].y()}) > below_mm) continue;
    if ((vertices[t[1]] - vertices[t[0]]).cross(vertices[t[2]] - vertices[t[0]]).dot(direction) < 0) continue;
    const cv::Point corners[3] = {points[t[0]], points[t[1]], points[t[2]]};
    cv::fillConvexPoly(hit, corners, 3, cv::Scalar(255), cv::LINE_8, kShift);
  }
  cv::Mat as_float;
  hit.convertTo(as_float, CV_32F, 1.0 / 255);
  map += as_float;
}

}  // namespace

PersonLayer render_person(const View& view, const Lighting& lighting, const ActorModel& actor,
                          const std::vector<Vec3>& vertices, const MovingShadow& moving) {
  std::vector<Vec3> camera_points(vertices.size());
  for (size_t i = 0; i < vertices.size(); ++i) camera_points[i] = view.to_camera(vertices[i]);
  SampleBuffer buffer(view, camera_points);
  const auto& triangles = actor.surface.triangles;
  for (size_t t = 0; t < triangles.size(); ++t) buffer.draw(static_cast<int>(t), triangles[t]);

  const auto normals = vertex_normals_of(actor.surface, vertices);
  const size_t n = static_cast<size_t>(view.camera.width) * view.camera.height;
  PersonLayer layer{std::vector<Color>(n, Color::Zero()), std::vector<uint8_t>(n, 0)};
  for (int y = buffer.first_row(); y < buffer.last_row(); ++y)
    for (int x = 0; x < buffer.width(); ++x) {
      const Sample& s = buffer.at(x, y);
      if (s.triangle < 0) continue;
      const auto& t = triangles[s.triangle];
      const auto& uv = actor.atlas.triangles[s.triangle];
      const double b0 = 1 - s.b1 - s.b2;
      const Eigen::Vector2d at =
          b0 * actor.atlas.uvs[uv[0]] + s.b1 * actor.atlas.uvs[uv[1]] + s.b2 * actor.atlas.uvs[uv[2]];
      const Vec3 normal = (b0 * normals[t[0]] + s.b1 * normals[t[1]] + s.b2 * normals[t[2]]).normalized();
      const size_t pixel = static_cast<size_t>(y / kSamplesPerSide) * view.camera.width + x / kSamplesPerSide;
      double key = 1;
      if (moving.strength > 0)
        key = moving.key_visible(lamp_x(lighting, b0 * vertices[t[0]] + s.b1 * vertices[t[1]] + s.b2 * vertices[t[2]]));
      layer.color[pixel] += lighting.shade(sample_texture(actor.texture, at.x(), at.y()), normal, key);
      ++layer.covered[pixel];
    }
  return layer;
}

double MovingShadow::key_visible(double lamp_x) const {
  constexpr double kSoft = 80;  // mm
  const double inside = std::clamp(0.5 + (half_width_mm - std::abs(lamp_x - x_mm)) / kSoft, 0.0, 1.0);
  return 1 - strength * inside;
}

void darken(const MovingShadow& moving, Plate& plate) {
  for (size_t i = 0; i < plate.lit.size(); ++i) {
    const float shadow = static_cast<float>(1 - moving.key_visible(plate.lamp_x[i]));
    plate.lit[i] += shadow * (plate.no_key[i] - plate.lit[i]);
  }
}

void add_shadow(const Lighting& lighting, const ActorModel& actor, const std::vector<Vec3>& vertices, Plate& plate) {
  // A square lamp as a few directions, and the feet keeping ambient light away.
  cv::Mat direct = cv::Mat::zeros(kShadowCells, kShadowCells, CV_32F), contact = direct.clone();
  constexpr int kLamp = 3;
  for (int i = 0; i < kLamp * kLamp; ++i) {
    const Vec3 offset(0.10 * (i % kLamp - 1), 0, 0.10 * (i / kLamp - 1));
    cover_floor(actor.surface, vertices, (lighting.key_direction + offset).normalized(), 1e9, direct);
  }
  direct /= kLamp * kLamp;
  cv::GaussianBlur(direct, direct, {0, 0}, 2.5);
  cover_floor(actor.surface, vertices, Vec3::UnitY(), 160, contact);
  cv::GaussianBlur(contact, contact, {0, 0}, 6);

  for (size_t i = 0; i < plate.lit.size(); ++i) {
    if (std::isnan(plate.floor_x[i])) continue;
    const double x = plate.floor_x[i] / kShadowCell + kShadowCells / 2,
                 z = plate.floor_z[i] / kShadowCell + kShadowCells / 2;
    if (!(x >= 0 && z >= 0 && x < kShadowCells - 1 && z < kShadowCells - 1)) continue;
    const int ix = static_cast<int>(x), iz = static_cast<int>(z);
    const auto lookup = [&](const cv::Mat& map) {
      const float fx = static_cast<float>(x - ix), fz = static_cast<float>(z - iz);
      return (1 - fz) * ((1 - fx) * map.at<float>(iz, ix) + fx * map.at<float>(iz, ix + 1)) +
             fz * ((1 - fx) * map.at<float>(iz + 1, ix) + fx * map.at<float>(iz + 1, ix + 1));
    };
    const float shadow = lookup(direct), dark = 1 - 0.45f * lookup(contact);
    plate.lit[i] = dark * (plate.lit[i] + shadow * (plate.no_key[i] - plate.lit[i]));
    plate.no_key[i] *= dark;
  }
}

}  // namespace livecap::synth
