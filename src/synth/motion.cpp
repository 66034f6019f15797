#include "synth/motion.h"

#include <functional>
#include <map>

#include "base/joined.h"
#include "livecap/error.h"
#include "synth/synth.h"

namespace livecap {

const std::vector<std::string>& motion_names() {
  static const std::vector<std::string> names = {"walk",  "raise", "turn", "squat",
                                                 "jacks", "dance", "demo", "turntable"};
  return names;
}

namespace synth {

namespace {

using Eigen::AngleAxisd;
using Eigen::Quaterniond;
using std::cos, std::sin, std::max;

constexpr double kDegree = M_PI / 180;

double ease(double t) {
  t = std::clamp(t, 0.0, 1.0);
  return t * t * t * (10 - 15 * t + 6 * t * t);  // no jump in velocity or acceleration
}

// 0 -> 1 -> 0 with eased flanks.
double window(double t, double start, double end, double flank) {
  return ease((t - start) / flank) * ease((end - t) / flank);
}

Posture standing(double crouch_rad) {
  Posture p;
  for (auto& arm : p.arms) {
    arm.abduction = 17 * kDegree;
    arm.flexion = 3 * kDegree;
    arm.elbow = 12 * kDegree;
  }
  for (auto& leg : p.legs) {
    leg.abduction = 1 * kDegree;
    leg.turn = 4 * kDegree;
    leg.flexion = leg.ankle = crouch_rad;  // thigh and shin are about as long: hips stay above the feet
    leg.knee = 2 * crouch_rad;
  }
  return p;
}

// Each movement adds to `p`; t in seconds from its start, w its strength (0 at both ends).
using Movement = std::function<void(double t, double w, Posture& p)>;

void walk(double t, double w, Posture& p) {
  const double phase = 2 * M_PI * t / 1.15;
  for (int side = 0; side < 2; ++side) {
    const double a = phase + side * M_PI;
    p.legs[side].flexion += w * kDegree * (10 + 24 * sin(a));
    p.legs[side].knee += w * kDegree * (14 + 34 * max(0.0, sin(a + 0.9)) * max(0.0, sin(a + 0.9)));
    p.legs[side].ankle += w * kDegree * 8 * sin(a - 0.6);
    p.arms[side].flexion += w * kDegree * (-22 * sin(a));
    p.arms[side].elbow += w * kDegree * (14 - 10 * sin(a));
  }
  p.x_mm += w * 120 * sin(2 * M_PI * t / 3.4);
  p.z_mm += w * 130 * (1 - cos(2 * M_PI * t / 3.4));
  p.yaw += w * kDegree * 20 * sin(2 * M_PI * t / 3.4);
  p.twist += w * kDegree * 7 * sin(phase + M_PI);
  p.lean_left += w * kDegree * 2.5 * cos(phase);
  p.look_left += w * kDegree * 8 * sin(2 * M_PI * t / 2.3);
}

void raise(double t, double w, Posture& p) {
  // Sideways up, one after the other, then both forwards.
  const double left = window(t, 0, 1.7, 0.7), right = window(t, 0.7, 2.4, 0.7), both = window(t, 2.2, 3.6, 0.55);
  const double up[2] = {left, right};
  for (int side = 0; side < 2; ++side) {
    p.arms[side].abduction += w * kDegree * (128 * up[side] + 12 * both);
    p.arms[side].raise += w * kDegree * (16 * up[side]);
    p.arms[side].flexion += w * kDegree * 82 * both;
    p.arms[side].elbow += w * kDegree * (14 * up[side] + 22 * sin(M_PI * up[side]) + 18 * both);
    p.legs[side].abduction += w * kDegree * 5;
  }
  p.side += w * kDegree * 7 * (right - left);
  p.look_left += w * kDegree * 22 * (left - right);
}

void turn(double t, double w, Posture& p, double duration) {
  p.yaw += 2 * M_PI * ease(t / duration);
  const double phase = 2 * M_PI * t / 0.8;
  for (int side = 0; side < 2; ++side) {
    const double step = max(0.0, sin(phase + side * M_PI));
    p.legs[side].flexion += w * kDegree * 24 * step;
    p.legs[side].knee += w * kDegree * (6 + 40 * step);
    p.arms[side].abduction += w * kDegree * (34 + 8 * sin(phase));
    p.arms[side].elbow += w * kDegree * 18;
  }
  p.lean_left += w * kDegree * 2 * sin(phase);
}

void squat(double t, double w, Posture& p) {
  const double down = w * (0.5 - 0.5 * cos(2 * M_PI * t / 1.6));
  for (int side = 0; side < 2; ++side) {
    p.legs[side].flexion += kDegree * 78 * down;
    p.legs[side].knee += kDegree * 92 * down;
    p.legs[side].ankle += kDegree * 22 * down;
    p.legs[side].abduction += kDegree * (8 * w + 8 * down);
    p.legs[side].turn += kDegree * 14 * down;
    p.arms[side].flexion += kDegree * 74 * down;
    p.arms[side].elbow += kDegree * 14 * down;
  }
  p.lean_forward += kDegree * 22 * down;
  p.bend += kDegree * 10 * down;
  p.nod -= kDegree * 16 * down;
}

void jacks(double t, double w, Posture& p) {
  const double period = 1.0, cycle = 0.5 - 0.5 * cos(2 * M_PI * t / period);
  for (int side = 0; side < 2; ++side) {
    p.arms[side].abduction += w * kDegree * 138 * cycle;
    p.arms[side].raise += w * kDegree * 16 * cycle;
    p.arms[side].elbow += w * kDegree * (16 + 18 * sin(M_PI * cycle));
    p.legs[side].abduction += w * kDegree * 20 * cycle;
    p.legs[side].knee += w * kDegree * (10 + 14 * (1 - sin(M_PI * cycle)));
    p.legs[side].flexion += w * kDegree * (5 + 6 * (1 - sin(M_PI * cycle)));
  }
  p.jump_mm += w * 70 * std::pow(sin(2 * M_PI * t / period), 2);
}

void dance(double t, double w, Posture& p) {
  const double beat = 2 * M_PI * t / 1.2;  // one sway to either side
  const double sway = sin(beat), quick = sin(2 * beat);
  p.x_mm += w * 75 * sway;
  p.yaw += w * kDegree * 26 * sin(0.5 * beat);
  p.lean_left -= w * kDegree * 6 * sway;
  p.side += w * kDegree * 9 * sway;
  p.twist += w * kDegree * 16 * sin(beat + 0.7);
  p.tilt_left += w * kDegree * 7 * sin(beat + 0.5);
  p.look_left += w * kDegree * 14 * cos(0.5 * beat);
  for (int side = 0; side < 2; ++side) {
    const double s = side == 0 ? 1 : -1;
    const double load = 0.5 - 0.5 * s * sway;
    p.legs[side].flexion += w * kDegree * (6 + 22 * load);
    p.legs[side].knee += w * kDegree * (12 + 38 * load);
    p.legs[side].ankle += w * kDegree * 8 * load;
    p.legs[side].abduction += w * kDegree * (7 + 5 * s * sway);
    p.legs[side].turn += w * kDegree * 10 * load;
    p.arms[side].abduction += w * kDegree * (30 + 26 * sin(beat + side * M_PI));
    p.arms[side].flexion += w * kDegree * (16 + 30 * sin(0.5 * beat + side * 2.0));
    p.arms[side].elbow += w * kDegree * (52 + 24 * quick * s);
    p.arms[side].twist += w * kDegree * 20 * sin(beat + side);
  }
}

// One arm up after the other.
void demo_raise(double t, double w, Posture& p) {
  const double up[2] = {window(t, 0, 1.05, 0.5), window(t, 0.2, 1.25, 0.5)};
  for (int side = 0; side < 2; ++side) {
    p.arms[side].abduction += w * kDegree * 112 * up[side];
    p.arms[side].raise += w * kDegree * 14 * up[side];
    p.arms[side].elbow += w * kDegree * (10 * up[side] + 24 * sin(M_PI * up[side]));
    p.legs[side].abduction += w * kDegree * 4;
  }
  p.side += w * kDegree * 8 * (up[1] - up[0]);
}

// A little more than a full turn in the actor's rest pose, as on a turning plate.
void turntable(double t, double w, Posture& p, double duration) {
  constexpr double kStill = 0.5, kStart = 0.7;  // s, with the arms up before and behind; from rest to full speed
  const double length = duration - 2 * kStill - kStart, since = t - kStill;
  // A speed that rises and falls as a smoothstep: the angle is its integral.
  const auto ramp = [](double x) {
    x = std::clamp(x, 0.0, 1.0);
    return x * x * x - 0.5 * x * x * x * x;
  };
  const double steady = std::clamp(since - kStart, 0.0, length - kStart);
  const double turned = kStart * ramp(since / kStart) + steady + kStart * (0.5 - ramp(1 - (since - length) / kStart));
  p.yaw += 2 * M_PI * 1.05 * turned / length;
  const Posture from = p;
  for (int side = 0; side < 2; ++side) {
    ArmAngles& arm = p.arms[side];
    arm.abduction = (1 - w) * from.arms[side].abduction + w * kDegree * (90 - kArmRestDeg);
    for (double* angle : {&arm.flexion, &arm.twist, &arm.elbow}) *angle *= 1 - w;
    LegAngles& leg = p.legs[side];
    for (double* angle : {&leg.flexion, &leg.abduction, &leg.turn, &leg.knee, &leg.ankle}) *angle *= 1 - w;
  }
}

struct Segment {
  double seconds;
  Movement movement;
};

void append_segments(const std::string& name, std::vector<Segment>& segments) {
  constexpr double kTurn = 2.6;
  if (name == "walk")
    segments.push_back({3.4, walk});
  else if (name == "raise")
    segments.push_back({3.6, raise});
  else if (name == "turn")
    segments.push_back({kTurn, [](double t, double w, Posture& p) { turn(t, w, p, kTurn); }});
  else if (name == "squat")
    segments.push_back({3.2, squat});
  else if (name == "jacks")
    segments.push_back({3.0, jacks});
  else if (name == "dance")
    segments.push_back({3.6, dance});
  else if (name == "demo") {
    // Four seconds: both arms up, a dance, and a turn that makes the clothes swing.
    segments.push_back({1.25, demo_raise});
    segments.push_back({1.05, dance});
    segments.push_back({1.7, [](double t, double w, Posture& p) { turn(t, w, p, 1.7); }});
  } else if (name == "turntable") {
    constexpr double kTurntable = 10;
    segments.push_back({kTurntable, [](double t, double w, Posture& p) { turntable(t, w, p, kTurntable); }});
  } else {
    throw ConfigError("there is no motion '" + name + "'; there are: " + joined(motion_names()));
  }
}

Quaterniond about_x(double a) {
  return Quaterniond(AngleAxisd(a, Vec3::UnitX()));
}
Quaterniond about_y(double a) {
  return Quaterniond(AngleAxisd(a, Vec3::UnitY()));
}
Quaterniond about_z(double a) {
  return Quaterniond(AngleAxisd(a, Vec3::UnitZ()));
}

// The mirror image of a rotation of the left side.
Quaterniond mirrored_if(bool right, const Quaterniond& q) {
  return right ? Quaterniond(q.w(), q.x(), -q.y(), -q.z()) : q;
}

}  // namespace

std::vector<Posture> make_motion(const std::vector<std::string>& names, double fps, double crouch_rad) {
  std::vector<Segment> segments;
  for (const auto& name : names) append_segments(name, segments);
  std::vector<Posture> postures;
  constexpr double kFlank = 0.32;  // s
  double start = 0, yaw = 0, total = 0;
  for (const auto& segment : segments) total += segment.seconds;
  size_t index = 0;
  const int n = max(1, static_cast<int>(std::lround(total * fps)));
  for (int frame = 0; frame < n; ++frame) {
    const double t = frame / fps;
    while (index + 1 < segments.size() && t >= start + segments[index].seconds) {
      Posture end;
      segments[index].movement(segments[index].seconds, 0, end);
      yaw += end.yaw;  // a full turn stays turned
      start += segments[index++].seconds;
    }
    Posture p = standing(crouch_rad);
    // Breathing and a little sway, so that nobody stands like a statue.
    p.bend += kDegree * 0.8 * sin(2 * M_PI * t / 3.1);
    p.look_left += kDegree * 3 * sin(2 * M_PI * t / 4.7);
    p.x_mm += 6 * sin(2 * M_PI * t / 3.9);
    p.yaw += yaw;
    segments[index].movement(t - start, window(t - start, 0, segments[index].seconds, kFlank), p);
    postures.push_back(p);
  }
  return postures;
}

BonePose pose_of(const Posture& p, const std::array<Vec3, kBoneCount>& joints, double scale) {
  std::array<Quaterniond, kBoneCount> local;
  local.fill(Quaterniond::Identity());
  local[kHips] = about_y(p.yaw) * about_x(p.lean_forward) * about_z(-p.lean_left);
  const Quaterniond third = about_y(p.twist / 3) * about_x(p.bend / 3) * about_z(-p.side / 3);
  local[kSpine] = local[kSpine1] = local[kSpine2] = third;
  const Quaterniond half = about_y(p.look_left / 2) * about_x(p.nod / 2) * about_z(-p.tilt_left / 2);
  local[kNeck] = local[kHead] = half;
  // Rest arms hang kArmRestDeg below horizontal: angles are given from hanging, the bind pose is this rotation of the
  // T-pose.
  const Quaterniond rest = about_z(-kArmRestDeg * kDegree);
  for (int side = 0; side < 2; ++side) {
    const bool right = side == 1;
    const int shift = right ? kRightShoulder - kLeftShoulder : 0;
    const ArmAngles& arm = p.arms[side];
    const Quaterniond girdle = about_z(arm.raise);
    const Quaterniond t_pose =
        about_x(-arm.flexion) * about_z(arm.abduction - arm.raise - M_PI / 2) * about_x(arm.twist);
    local[kLeftShoulder + shift] = mirrored_if(right, girdle);
    local[kLeftArm + shift] = mirrored_if(right, t_pose * rest.inverse());
    local[kLeftForeArm + shift] = mirrored_if(right, rest * about_y(-arm.elbow) * rest.inverse());
    const LegAngles& leg = p.legs[side];
    local[kLeftUpLeg + shift] = mirrored_if(right, about_x(-leg.flexion) * about_z(leg.abduction) * about_y(leg.turn));
    local[kLeftLeg + shift] = mirrored_if(right, about_x(leg.knee));
    local[kLeftFoot + shift] = mirrored_if(right, about_x(-leg.ankle - (leg.knee - leg.flexion - leg.ankle) * 0.35));
  }
  // Lower the hips until the lowest part of a sole touches the floor.
  const Vec3 hips(scale * p.x_mm, joints[kHips].y(), scale * p.z_mm);
  BonePose pose = pose_bones(joints, local, hips);
  double lowest = 1e9;
  for (int shift : {0, kRightShoulder - kLeftShoulder}) {
    const int foot = kLeftFoot + shift, toe = kLeftToeBase + shift;
    const double out = shift ? -1 : 1;
    const Vec3 soles[4] = {scale * Vec3(out * 132, 0, -70), scale * Vec3(out * 132, 0, 20),
                           scale * Vec3(out * 118, 0, 100), scale * Vec3(out * 150, 0, 150)};
    for (const Vec3& sole : soles) {
      const int bone = &sole - soles < 2 ? foot : toe;
      lowest = std::min(lowest, (pose.origins[bone] + pose.rotations[bone] * (sole - joints[bone])).y());
    }
  }
  for (Vec3& origin : pose.origins) origin.y() += scale * p.jump_mm - lowest;
  return pose;
}

}  // namespace synth
}  // namespace livecap
