// The empty room: floor, back wall and furniture by ray casting; see renderer.h.
#include <array>
#include <limits>

#include "synth/random.h"
#include "synth/renderer.h"

namespace livecap::synth {

namespace {

constexpr double kWallZ = -1500;

struct Box {
  Vec3 low, high;
  int kind;  // 0 shelf, 1 drawers, 2 picture, 3 pot, 4 leaves, 5 skirting board
};

const std::array<Box, 6> kFurniture = {{
    {{-1500, 0, kWallZ}, {-640, 1690, kWallZ + 300}, 0},
    {{560, 0, kWallZ}, {1500, 720, kWallZ + 420}, 1},
    {{330, 1330, kWallZ}, {820, 1840, kWallZ + 25}, 2},
    {{660, 720, kWallZ + 120}, {800, 860, kWallZ + 260}, 3},
    {{620, 860, kWallZ + 100}, {840, 1110, kWallZ + 280}, 4},
    {{-640, 0, kWallZ}, {560, 95, kWallZ + 18}, 5},
}};

Color srgb(double r, double g, double b) {
  return {linear_from_srgb(static_cast<float>(r)), linear_from_srgb(static_cast<float>(g)),
          linear_from_srgb(static_cast<float>(b))};
}

Color floor_color(double x, double z, uint64_t seed) {
  // A rug on planks.
  const double rx = std::abs(x) - 950, rz = std::abs(z - 150) - 720;
  if (rx < 0 && rz < 0) {
    const double border = std::max(rx, rz);
    const double weave =
        0.93 + 0.14 * lattice_noise(static_cast<int>(std::floor(x / 6)), static_cast<int>(std::floor(z / 6)), seed + 9);
    if (border > -35) return srgb(0.38, 0.40, 0.44) * static_cast<float>(weave);
    const double u = std::abs(x - 190 * std::floor(x / 190 + 0.5)), v = std::abs(z - 190 * std::floor(z / 190 + 0.5));
    const double diamond = u + v;
    const Color c = diamond < 32                  ? srgb(0.52, 0.55, 0.58)
                    : std::abs(diamond - 95) < 10 ? srgb(0.80, 0.79, 0.76)
                                                  : srgb(0.66, 0.66, 0.66);
    return c * static_cast<float>(weave);
  }
  const int plank = static_cast<int>(std::floor(x / 130));
  const double shift = 900 * lattice_noise(plank, 3, seed);
  const int piece = static_cast<int>(std::floor((z + shift) / 1150));
  const double tone = 0.80 + 0.4 * lattice_noise(plank, piece, seed + 1);
  const double grain = 0.9 + 0.2 * cloud_noise(x / 9, (z + 3000 * tone) / 160, seed + 2);
  const double gap = std::abs(x - 130 * std::floor(x / 130 + 0.5)) < 2.5 ? 0.55 : 1;
  return srgb(0.62, 0.47, 0.33) * static_cast<float>(tone * grain * gap);
}

Color wall_color(double x, double y, uint64_t seed) {
  const double blotch = 0.95 + 0.10 * cloud_noise(x / 300, y / 300, seed + 4);
  const double grit =
      0.98 + 0.04 * lattice_noise(static_cast<int>(std::floor(x / 5)), static_cast<int>(std::floor(y / 5)), seed + 5);
  const double corner = 1 - 0.18 * std::exp(-y / 220);
  return srgb(0.71, 0.76, 0.79) * static_cast<float>(blotch * grit * corner);
}

Color shelf_color(const Vec3& p, uint64_t seed) {
  const Color wood =
      srgb(0.42, 0.33, 0.27) * static_cast<float>(0.85 + 0.3 * cloud_noise(p.x() / 200, p.y() / 12, seed + 6));
  const double x = p.x() + 1500, shelf = p.y() / 340, height = 340 * (shelf - std::floor(shelf));
  if (p.z() < kWallZ + 299 || x > 835 || height < 28 || p.y() > 1660) return wood;
  const double width = 26;  // books
  const int book = static_cast<int>(std::floor(x / width)), row = static_cast<int>(std::floor(shelf));
  const double tall = 190 + 110 * lattice_noise(book, row, seed + 7);
  if (height > tall + 28) return wood * 0.25f;
  const double tone = lattice_noise(book, row, seed + 8), value = 0.35 + 0.4 * lattice_noise(book, row + 50, seed);
  const Color spine = srgb(value * (0.6 + 0.4 * tone), value * 0.85, value * (1.0 - 0.35 * tone));
  const double edge = x - width * book;
  return spine * (edge < 2 ? 0.4f : std::abs(height - 0.7 * tall) < 8 ? 1.35f : 1.0f);
}

Color furniture_color(const Box& box, const Vec3& p, const Vec3& normal, uint64_t seed) {
  const Vec3 q = p - box.low, size = box.high - box.low;
  switch (box.kind) {
    case 0:
      return shelf_color(p, seed);
    case 1: {
      Color c = srgb(0.83, 0.82, 0.78);
      if (normal.z() > 0.5) {
        const double x = std::fmod(q.x(), 470), y = std::fmod(q.y(), 240);
        if (x < 7 || y < 7) c *= 0.45f;
        if (std::hypot(x - 235, y - 125) < 16) c = srgb(0.35, 0.30, 0.25);
      }
      return c;
    }
    case 2: {
      const double frame = std::min({q.x(), q.y(), size.x() - q.x(), size.y() - q.y()});
      if (frame < 22) return srgb(0.17, 0.16, 0.16);
      if (frame < 55) return srgb(0.90, 0.90, 0.87);
      const double n = cloud_noise(p.x() / 90, p.y() / 60, seed + 12),
                   hill = 0.45 * size.y() + 60 * std::sin(p.x() / 60);
      return q.y() > hill ? srgb(0.55 + 0.3 * n, 0.68 + 0.2 * n, 0.80) : srgb(0.25 + 0.3 * n, 0.42 + 0.2 * n, 0.30);
    }
    case 3:
      return srgb(0.52, 0.55, 0.60) * static_cast<float>(0.9 + 0.2 * (q.y() / size.y()));
    case 4:
      return srgb(0.16, 0.34, 0.20) * static_cast<float>(0.4 + 1.1 * value_noise(p.x() / 14, p.y() / 34, seed + 13));
    default:
      return srgb(0.88, 0.88, 0.86);
  }
}

// Where the ray from the eye to p passes the actor's place decides.
Color wallpaper_color(const Wallpaper& paper, const Vec3& eye, const Vec3& p, uint64_t seed) {
  const double y = p.z() < 0 ? eye.y() + (p.y() - eye.y()) * eye.z() / (eye.z() - p.z()) : p.y();
  const double blotch = 0.95 + 0.10 * cloud_noise((p.x() + p.z()) / 60, p.y() / 60, seed + 4);
  return (y > paper.border_mm ? paper.upper : paper.lower) * static_cast<float>(blotch);
}

struct Hit {
  double t = std::numeric_limits<double>::infinity();
  Vec3 normal = Vec3::Zero();
  int box = -1;  // -2 floor, -3 wall
};

// Slab test; `skip_leaves` cuts holes into the plant by its texture.
void hit_box(const Box& box, int index, const Vec3& origin, const Vec3& ray, Hit& hit, uint64_t seed) {
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  int axis = -1;
  for (int k = 0; k < 3; ++k) {
    double a = (box.low[k] - origin[k]) / ray[k], b = (box.high[k] - origin[k]) / ray[k];
    if (a > b) std::swap(a, b);
    if (a > enter) enter = a, axis = k;
    leave = std::min(leave, b);
  }
  if (axis < 0 || enter >= leave || enter >= hit.t) return;
  const Vec3 p = origin + enter * ray;
  if (box.kind == 4) {
    const Vec3 q = (p - 0.5 * (box.low + box.high)).cwiseQuotient(0.5 * (box.high - box.low));
    const double angle = std::atan2(q.y() + 1, q.x());
    if (std::hypot(q.x(), q.y() + 1) > 0.9 + 0.9 * value_noise(9 * angle, 0, seed + 14)) return;
    if (value_noise(p.x() / 16, p.y() / 40, seed + 15) < 0.3) return;
  }
  hit.t = enter;
  hit.box = index;
  hit.normal = Vec3::Zero();
  hit.normal[axis] = ray[axis] > 0 ? -1 : 1;
}

Hit cast(const Vec3& origin, const Vec3& ray, uint64_t seed) {
  Hit hit;
  if (ray.y() < 0) hit = {-origin.y() / ray.y(), Vec3::UnitY(), -2};
  const double wall = (kWallZ - origin.z()) / ray.z();
  if (ray.z() < 0 && wall < hit.t) hit = {wall, Vec3::UnitZ(), -3};
  for (size_t i = 0; i < kFurniture.size(); ++i) hit_box(kFurniture[i], static_cast<int>(i), origin, ray, hit, seed);
  return hit;
}

// How much ambient light reaches a point: less near the furniture's foot and in the corners.
double openness(const Vec3& p) {
  double open = 1;
  for (const Box& box : kFurniture) {
    if (box.kind == 2 || box.kind == 5) continue;
    const Vec3 outside = (box.low - p).cwiseMax(p - box.high).cwiseMax(0);
    open *= 1 - 0.35 * std::exp(-outside.norm() / 110);
  }
  return open;
}

}  // namespace

Color Lighting::shade(const Color& albedo, const Vec3& normal, double key_visible, double ambient_visible) const {
  const float up = static_cast<float>((0.8 + 0.2 * normal.y()) * ambient_visible);
  const float k = static_cast<float>(key_visible * std::max(0.0, normal.dot(key_direction)));
  const float f = static_cast<float>(std::max(0.0, normal.dot(fill_direction)) * ambient_visible);
  return albedo.cwiseProduct(up * ambient + k * key + f * fill);
}

Plate render_plate(const View& view, const Lighting& lighting, uint64_t seed,
                   const std::optional<Wallpaper>& wallpaper) {
  const Camera& camera = view.camera;
  const size_t n = static_cast<size_t>(camera.width) * camera.height;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  Plate plate{std::vector<Color>(n), std::vector<Color>(n), std::vector<float>(n, kNan), std::vector<float>(n, kNan),
              std::vector<float>(n, 0)};
  const Eigen::Matrix3d room_from_camera = view.camera_from_room_rotation.transpose();
  const Vec3 eye = -room_from_camera * view.camera_from_room_translation;
  constexpr int kSide = 3;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const size_t pixel = static_cast<size_t>(y) * camera.width + x;
      Color lit = Color::Zero(), no_key = Color::Zero();
      for (int s = 0; s < kSide * kSide; ++s) {
        const double sx = x + (s % kSide + 0.5) / kSide - 0.5, sy = y + (s / kSide + 0.5) / kSide - 0.5;
        const Vec3 ray = room_from_camera * Vec3((sx - camera.cx) / camera.fx, (sy - camera.cy) / camera.fy, 1);
        const Hit hit = cast(eye, ray, seed);
        if (!std::isfinite(hit.t)) continue;
        const Vec3 p = eye + hit.t * ray;
        const Color albedo = wallpaper       ? wallpaper_color(*wallpaper, eye, p, seed)
                             : hit.box == -2 ? floor_color(p.x(), p.z(), seed)
                             : hit.box == -3 ? wall_color(p.x(), p.y(), seed)
                                             : furniture_color(kFurniture[hit.box], p, hit.normal, seed);
        // A shadow ray towards the lamp for what the furniture throws on wall and floor.
        Hit blocker;
        const Vec3 start = p + 2 * hit.normal;
        for (size_t i = 0; i < kFurniture.size(); ++i)
          hit_box(kFurniture[i], static_cast<int>(i), start, lighting.key_direction, blocker, seed);
        const double open = hit.box < 0 ? openness(p) : 1;
        lit += lighting.shade(albedo, hit.normal, std::isfinite(blocker.t) ? 0.25 : 1, open);
        no_key += lighting.shade(albedo, hit.normal, 0, open);
        if (s != kSide * kSide / 2) continue;
        plate.lamp_x[pixel] = static_cast<float>(lamp_x(lighting, p));
        if (hit.box == -2) {
          plate.floor_x[pixel] = static_cast<float>(p.x());
          plate.floor_z[pixel] = static_cast<float>(p.z());
        }
      }
      plate.lit[pixel] = lit / (kSide * kSide);
      plate.no_key[pixel] = no_key / (kSide * kSide);
    }
  return plate;
}

}  // namespace livecap::synth
