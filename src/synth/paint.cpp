#include "synth/paint.h"

#include "synth/random.h"

namespace livecap::synth {

namespace {

constexpr double kEyeX = 31, kEyeY = 1593, kMouthY = 1535;

// 1 inside, 0 outside, soft over `soft` around the border at 0.
double inside(double signed_distance, double soft) {
  return std::clamp(0.5 - signed_distance / soft, 0.0, 1.0);
}
Vec3 mix(const Vec3& a, const Vec3& b, double t) {
  return a + std::clamp(t, 0.0, 1.0) * (b - a);
}

// A line of the given half width repeated with the given period.
double line(double x, double period, double half_width, double soft = 2) {
  const double phase = x - period * std::floor(x / period + 0.5);
  return inside(std::abs(phase) - half_width, soft);
}

// Around the vertical axis, in mm on a cylinder of the given radius; 0 at the front.
double around(const Vec3& p, double radius) {
  return radius * std::atan2(p.x(), p.z());
}

Vec3 skin(const BodyShape& shape, const Vec3& p) {
  const Vec3 base = shape.outfit() == Outfit::kSkirt ? Vec3(0.90, 0.72, 0.61) : Vec3(0.80, 0.60, 0.48);
  const double mottle = cloud_noise(0.03 * (p.x() + 2 * p.z()), 0.03 * p.y(), 11) - 0.5;
  const double knee = std::exp(-std::pow((p.y() - 490) / 40, 2)) * (p.z() > 20);
  return base * (1 + 0.10 * mottle) - knee * Vec3(0.02, 0.07, 0.07);
}

Vec3 hair(const BodyShape& shape, const Vec3& p) {
  const Vec3 base = shape.outfit() == Outfit::kSkirt ? Vec3(0.36, 0.19, 0.10) : Vec3(0.16, 0.11, 0.08);
  const double strands = value_noise(14 * std::atan2(p.x(), p.z() + 10), 0.012 * p.y(), 21);
  return base * (0.7 + 0.65 * strands);
}

Vec3 face(const BodyShape& shape, const Vec3& p) {
  Vec3 c = skin(shape, p);
  if (p.z() < 30) return c;
  const bool woman = shape.outfit() == Outfit::kSkirt;
  const double x = std::abs(p.x()), y = p.y();
  const Vec3 dark(0.12, 0.07, 0.05), hair_color = woman ? Vec3(0.30, 0.16, 0.09) : Vec3(0.14, 0.09, 0.06);
  c = mix(c, {0.92, 0.52, 0.48},
          0.35 * std::exp(-(std::pow((x - 44) / 16, 2) + std::pow((y - 1560) / 14, 2))));        // cheek
  c = mix(c, c * 0.80, inside(std::abs(x - 15) - 4, 6) * inside(std::abs(y - 1576) - 16, 14));   // nose side
  c = mix(c, dark, 0.75 * inside(std::hypot((x - 7) / 4.5, (y - 1555) / 3) - 1, 0.6));           // nostril
  if (!woman) c = mix(c, {0.45, 0.36, 0.31}, 0.38 * inside(y - 1552, 24) * inside(x - 62, 20));  // stubble
  // Eyes.
  const double ex = x - kEyeX, ey = y - kEyeY;
  c = mix(c, c * 0.82, inside(std::hypot(ex / 20, (ey - 3) / 12) - 1, 0.5));
  const double lid = std::hypot(ex / 14, ey / 7.5) - 1;
  c = mix(c, dark, inside(std::hypot(ex / 15.5, (ey - 1.2) / 9) - 1, 0.15));
  c = mix(c, {0.96, 0.96, 0.95}, inside(lid, 0.12));
  const double iris = std::hypot(ex, ey);
  const double eye = inside(lid, 0.12);
  c = mix(c, woman ? Vec3(0.20, 0.42, 0.55) : Vec3(0.33, 0.22, 0.12), eye * inside(iris - 6.5, 1));
  c = mix(c, {0.02, 0.02, 0.02}, eye * inside(iris - 3, 1));
  c = mix(c, {1, 1, 1}, eye * inside(std::hypot(p.x() - (p.x() > 0 ? kEyeX : -kEyeX) - 2, ey - 2.5) - 1.2, 0.8));
  // Brow: an arch.
  const double arch = y - (kEyeY + 17 + 3.5 * std::cos((x - 33) / 12));
  c = mix(c, hair_color, inside(std::abs(arch) - (woman ? 2.4 : 3.8), 2) * inside(std::abs(x - 32) - 18, 6));
  // Mouth.
  const double lips = std::hypot(x / (woman ? 24 : 26), (y - kMouthY) / (woman ? 8.5 : 6.5)) - 1;
  c = mix(c, woman ? Vec3(0.76, 0.25, 0.27) : Vec3(0.66, 0.36, 0.33), inside(lips, 0.2) * (p.z() > 50));
  c = mix(c, {0.30, 0.08, 0.08},
          inside(std::abs(y - kMouthY + 0.004 * x * x) - 1.1, 1) * inside(x - 21, 4) * (p.z() > 50));
  return c;
}

// How far down the sleeve a point of the top is, mm; negative on the trunk.
double sleeve_parameter(const BodyShape& shape, const Vec3& p) {
  const Vec3 q(std::abs(p.x()), p.y(), p.z());
  const Vec3 &shoulder = shape.joints()[kLeftArm], &elbow = shape.joints()[kLeftForeArm];
  return segment_distance(q, shoulder, elbow) < 72 ? (q - shoulder).dot((elbow - shoulder).normalized()) : -1;
}

Vec3 striped_top(const BodyShape& shape, const Vec3& p) {
  const Vec3 cream(0.95, 0.92, 0.83), teal(0.05, 0.38, 0.42), coral(0.93, 0.42, 0.30);
  const double s = sleeve_parameter(shape, p);
  if (s > 0) {
    Vec3 c = mix(cream, teal, line(s, 34, 8));
    return mix(c, coral, inside(std::abs(s - (shape.sleeve_length() - 6)) - 7, 2));
  }
  Vec3 c = mix(cream, teal, line(p.y() - 1060, 40, 10));
  c = mix(c, coral, line(p.y() - 1060, 160, 5));
  // A flower on the chest, buttons on the back, and the neckline.
  const double fx = p.x() - 55, fy = p.y() - 1305, r = std::hypot(fx, fy);
  if (p.z() > 0) {
    c = mix(c, {0.96, 0.75, 0.12}, inside(r - 15 - 8 * std::cos(5 * std::atan2(fy, fx)), 2));
    c = mix(c, {0.80, 0.12, 0.30}, inside(r - 7, 2));
  } else {
    c = mix(c, {0.15, 0.1, 0.1}, inside(std::hypot(p.x(), std::fmod(p.y(), 55) - 27) - 6, 2));
  }
  if (p.y() < 1064) return {0.20, 0.09, 0.07};  // goes into the belt
  return mix(c, coral, inside(1426 - p.y(), 3));
}

Vec3 checked_skirt(const Vec3& p) {
  const double u = around(p, 240), v = p.y();
  Vec3 c(0.42, 0.13, 0.38);                                // plum
  c = mix(c, {0.16, 0.12, 0.42}, 0.75 * line(u, 94, 20));  // blue bands
  c = mix(c, {0.16, 0.12, 0.42}, 0.75 * line(v, 90, 20));
  c = mix(c, {0.95, 0.80, 0.35}, 0.9 * line(u + 47, 94, 4));  // yellow threads
  c = mix(c, {0.95, 0.80, 0.35}, 0.9 * line(v + 45, 90, 4));
  c = mix(c, {0.90, 0.45, 0.62}, 0.85 * line(u + 22, 94, 3));
  c = mix(c, {0.90, 0.45, 0.62}, 0.85 * line(v + 20, 90, 3));
  if (v > 1028) c = Vec3(0.20, 0.09, 0.07);  // belt
  if (v > 1028 && p.z() > 0)
    c = mix(c, {0.90, 0.75, 0.30}, inside(std::abs(std::hypot(p.x(), 1.3 * (v - 1040)) - 16) - 4, 2));
  return mix(c, c * 0.55, inside(v - 538, 3));
}

Vec3 patterned_shirt(const BodyShape& shape, const Vec3& p) {
  const Vec3 amber(0.95, 0.66, 0.16), green(0.10, 0.42, 0.26), white(0.95, 0.94, 0.90), red(0.78, 0.16, 0.13);
  const double s = sleeve_parameter(shape, p);
  if (s > 10) {
    Vec3 c = mix(amber, green, line(s + 0.5 * p.z(), 44, 9));
    return mix(c, white, inside(std::abs(s - (shape.sleeve_length() - 8)) - 8, 2));
  }
  // Zigzags and dots.
  const double u = around(p, 150);
  const double zigzag = p.y() + std::abs(u - 60 * std::floor(u / 60 + 0.5));
  Vec3 c = mix(amber, green, line(zigzag, 110, 14));
  const double du = u - 60 * std::floor(u / 60 + 0.5), row = zigzag - 55;
  c = mix(c, red, inside(std::hypot(du, row - 110 * std::floor(row / 110 + 0.5)) - 11, 2));
  // A panel with a big figure on the chest.
  if (p.z() > 0) {
    const double px = p.x(), py = p.y() - 1265;
    c = mix(c, white, inside(std::max(std::abs(px) - 62, std::abs(py) - 52), 3));
    c = mix(c, red, inside(std::abs(std::hypot(px, py) - 33) - 8, 2));
    c = mix(c, green, inside(std::max(std::abs(px + py) - 10, std::hypot(px, py) - 40), 2));
  } else {
    c = mix(c, white, inside(std::max(std::abs(p.x()) - 48, std::abs(std::abs(p.y() - 1270) - 24) - 12), 2));
  }
  c = mix(c, white, inside(1430 - p.y(), 3));
  return mix(c, green, inside(p.y() - 886, 3));
}

Vec3 denim(const Vec3& p) {
  const double x = std::abs(p.x());
  const double weave = value_noise(0.35 * around(p, 100), 0.08 * p.y(), 31) - 0.5;
  const double wash = cloud_noise(0.012 * p.x(), 0.012 * p.y(), 41) - 0.5;
  Vec3 c = Vec3(0.16, 0.27, 0.48) * (1 + 0.25 * weave + 0.35 * wash);
  const Vec3 thread(0.85, 0.62, 0.28);
  const double center = 86 + (900 - p.y()) * 0.065;  // the middle of the leg
  if (p.z() > 0)
    c = mix(c, {0.45, 0.56, 0.72}, 0.6 * std::exp(-std::pow((x - center) / 42, 2)) * (p.y() < 800 ? 1 : 0.4));
  c = mix(c, thread, inside(std::abs(x - center - 66 + 0.028 * (900 - p.y())) - 1.6, 2));  // outer seam
  if (p.z() < 0 && p.y() > 760) {                                                          // back pockets
    const double edge = std::max(std::abs(x - 82) - 46, std::abs(p.y() - 830) - 48);
    c = mix(c, c * 0.7, inside(edge, 2));
    c = mix(c, thread, inside(std::abs(edge + 4) - 1.5, 1.5));
  }
  if (p.z() > 0) c = mix(c, thread, inside(std::abs(std::hypot(x - 150, p.y() - 900) - 72) - 1.8, 2));  // front pockets
  for (const double knee : {470.0, 505.0})                                                              // creases
    c = mix(c, c * 0.72, 0.8 * inside(std::abs(p.y() - knee + 0.1 * p.z()) - 4, 8));
  return mix(c, thread, inside(std::abs(p.y() - 66) - 1.8, 2));  // hem
}

Vec3 shoe(const BodyShape& shape, const Vec3& p) {
  const bool woman = shape.outfit() == Outfit::kSkirt;
  const double x = std::abs(p.x()) - 142;
  Vec3 c = woman ? Vec3(0.10, 0.42, 0.30) : Vec3(0.72, 0.13, 0.12);
  if (p.z() > 10 && p.z() < 95 && std::abs(x) < 22 && p.y() > 45) c = mix(c, {0.95, 0.95, 0.92}, line(p.z(), 18, 4));
  if (std::abs(x) > 26) c = mix(c, {0.95, 0.93, 0.85}, line(p.z() + 0.6 * p.y(), 60, 6));
  c = mix(c, {0.93, 0.92, 0.88}, inside(100 - p.z(), 3) * inside(p.y() - 34, 3));  // toe cap
  if (p.y() < 18) c = Vec3(0.90, 0.88, 0.82);
  return p.y() < 6 ? Vec3(0.25, 0.22, 0.2) : c;
}

}  // namespace

Vec3 paint(const BodyShape& shape, Part part, const Vec3& p) {
  const bool woman = shape.outfit() == Outfit::kSkirt;
  switch (part) {
    case kHairPart:
      return hair(shape, p);
    case kFacePart:
      return face(shape, p);
    case kTopPart:
      return woman ? striped_top(shape, p) : patterned_shirt(shape, p);
    case kBottomPart:
      return woman ? checked_skirt(p) : denim(p);
    case kShoePart:
      return shoe(shape, p);
    default:
      return skin(shape, p);
  }
}

FaceFeatures face_features(const BodyShape&) {
  return {{kEyeX, kEyeY, 90}, {-kEyeX, kEyeY, 90}, {0, 1564, 123}, {0, kMouthY, 95}};
}

}  // namespace livecap::synth
