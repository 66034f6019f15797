#include "synth/cloth.h"

#include <algorithm>
#include <cmath>

#include "geometry/segment.h"
#include "meshing/surface_parts.h"

namespace livecap::synth {

namespace {

constexpr int kSubsteps = 10;
constexpr double kHold = 0.25;  // share of the displacement lost per substep where the cloth is held
constexpr double kEdgeStiffness = 0.55;
constexpr double kWaistband = 60;  // of a skirt, shape units: held
constexpr int kLidRounds = 30;     // a frame

double ramp(double x, double low, double high) {
  const double t = std::clamp((x - low) / (high - low), 0.0, 1.0);
  return t * t * (3 - 2 * t);
}

}  // namespace

Cloth::Cloth(const ActorModel& actor) : actor_(actor), neighbors_(vertex_neighbors(actor.surface)) {
  const BodyShape shape(outfit_from_name(actor.name));
  const bool skirt = shape.outfit() == Outfit::kSkirt;
  const size_t n = actor.surface.vertices.size();
  freedom_.assign(n, 0);
  spring_.assign(n, 0);
  for (size_t i = 0; i < n; ++i) {
    const Vec3 p = actor.surface.vertices[i] / actor.scale;  // shape units
    double freedom = 0, frequency = 1;                       // Hz of the swing
    if (actor.parts[i] == kTopPart) {
      // The trunk of the top below the chest; a t-shirt worn outside also at its hem. Sleeves stay.
      const double below = 1330 - p.y();
      const double tucked = skirt ? ramp(p.y() - shape.bottom_waist_y(), 10, 70) : 1;
      if (std::abs(p.x()) < 215) freedom = ramp(below, 20, skirt ? 160 : 300) * tucked;
      frequency = skirt ? 3.2 : 3.4 - 1.4 * ramp(below, 150, 430);
    } else if (actor.parts[i] == kBottomPart && !skirt) {
      // Trouser legs: the loose ends below the knee.
      freedom = 0.8 * ramp(470 - p.y(), 0, 250);
      frequency = 3.2;
    }
    if (freedom <= 0) continue;
    freedom_[i] = freedom;
    spring_[i] = std::pow(2 * M_PI * frequency, 2);
    close_.push_back(static_cast<int>(i));
  }
  for (int i = 0; i < static_cast<int>(n); ++i)
    for (int j : neighbors_[i])
      if (i < j && (freedom_[i] > 0 || freedom_[j] > 0)) {
        const double length = (actor.surface.vertices[i] - actor.surface.vertices[j]).norm();
        edges_.push_back({i, j, length});
      }
  const double s = actor.scale;
  for (int shift : {0, kRightShoulder - kLeftShoulder}) {
    const double margin = skirt ? 10 : 4;
    limbs_.push_back({kLeftUpLeg + shift, kLeftLeg + shift, s * (84 + margin), s * (54 + margin)});
    limbs_.push_back({kLeftLeg + shift, kLeftFoot + shift, s * (52 + margin), s * (36 + margin)});
  }
  moving_ = close_;
  if (skirt) set_up_skirt(shape);
}

void Cloth::set_up_skirt(const BodyShape& shape) {
  const double s = actor_.scale;
  limbs_.push_back({kHips, kSpine, s * 105, s * 95});
  limbs_.push_back({kLeftUpLeg, kRightUpLeg, s * 94, s * 94});
  const std::vector<Vec3>& rest = actor_.surface.vertices;
  const std::vector<Vec3> normals = meshing::vertex_normals(actor_.surface);
  std::vector<char> held(rest.size(), 1), lid(rest.size(), 0);
  for (size_t i = 0; i < rest.size(); ++i) {
    if (actor_.parts[i] != kBottomPart) continue;
    const Vec3 p = rest[i] / s;
    lid[i] = p.y() < shape.bottom_hem_y() + 110 && normals[i].y() < -0.35 && std::hypot(p.x(), p.z()) < 235;
    if (lid[i]) lid_.push_back(static_cast<int>(i));
    held[i] = lid[i] || p.y() > shape.bottom_waist_y() - kWaistband;
  }
  std::vector<Eigen::Vector3i> outer;
  for (const auto& t : actor_.surface.triangles) {
    const std::array<int, 3> corners{t[0], t[1], t[2]};
    if (std::any_of(corners.begin(), corners.end(), [&](int i) { return !held[i]; }) &&
        std::none_of(corners.begin(), corners.end(), [&](int i) { return lid[i]; }))
      outer.push_back(t);
  }
  // In the rest pose nothing is pushed.
  std::vector<std::vector<double>> reach;
  for (const Limb& limb : limbs_) {
    const Vec3 &from = actor_.joints[limb.from], &to = actor_.joints[limb.to];
    auto& mm = reach.emplace_back();
    for (const Vec3& p : rest) mm.push_back((p - from - segment_parameter(p, from, to) * (to - from)).norm());
  }
  skirt_.emplace(rest, outer, held, reach, Fabric{});
  // What hangs on the underside alone goes along with it.
  std::vector<char> falls(rest.size(), 0);
  for (int i : skirt_->vertices()) falls[i] = 1;
  for (size_t i = 0; i < rest.size(); ++i)
    if (!held[i] && !falls[i]) lid_.push_back(static_cast<int>(i));
  moving_.insert(moving_.end(), skirt_->vertices().begin(), skirt_->vertices().end());
  moving_.insert(moving_.end(), lid_.begin(), lid_.end());
}

void Cloth::reset(const std::vector<Vec3>& skinned, const BonePose& pose) {
  position_ = previous_target_ = skinned;
  velocity_.assign(skinned.size(), Vec3::Zero());
  previous_origins_.assign(pose.origins.begin(), pose.origins.end());
  if (skirt_) skirt_->reset(skinned);
}

const std::vector<Vec3>& Cloth::step(const std::vector<Vec3>& skinned, const BonePose& pose, double seconds) {
  std::vector<Vec3> target(skinned.size()), origins(kBoneCount);
  for (int k = 1; k <= kSubsteps; ++k) {
    const double t = static_cast<double>(k) / kSubsteps;
    for (size_t i = 0; i < target.size(); ++i) target[i] = (1 - t) * previous_target_[i] + t * skinned[i];
    for (int b = 0; b < kBoneCount; ++b) origins[b] = (1 - t) * previous_origins_[b] + t * pose.origins[b];
    substep(target, origins, seconds / kSubsteps);
  }
  if (skirt_) step_skirt(skinned, pose, seconds);
  previous_target_ = skinned;
  previous_origins_.assign(pose.origins.begin(), pose.origins.end());
  return position_;
}

void Cloth::step_skirt(const std::vector<Vec3>& skinned, const BonePose& pose, double seconds) {
  std::vector<MovingCone> cones;
  for (const Limb& limb : limbs_)
    cones.push_back({{previous_origins_[limb.from], pose.origins[limb.from]},
                     {previous_origins_[limb.to], pose.origins[limb.to]},
                     limb.radius_from,
                     limb.radius_to});
  const std::vector<Vec3>& fallen = skirt_->step(skinned, cones, seconds);
  for (int i : skirt_->vertices()) position_[i] = fallen[i];
  // Between hem and legs each is displaced as its neighbours are, in the mean.
  for (int round = 0; round < kLidRounds; ++round)
    for (int i : lid_) {
      Vec3 mean = Vec3::Zero();
      for (int j : neighbors_[i]) mean += position_[j] - skinned[j];
      position_[i] = skinned[i] + mean / static_cast<double>(neighbors_[i].size());
    }
}

void Cloth::substep(const std::vector<Vec3>& target, const std::vector<Vec3>& origins, double dt) {
  std::vector<Vec3> before = position_;
  for (size_t i = 0; i < position_.size(); ++i)
    if (freedom_[i] == 0) position_[i] = target[i];
  for (int i : close_) {
    // Springs to the skinned place and to where the neighbours' displacement would put it, air drag, a sag by gravity.
    Vec3 mean = Vec3::Zero();
    for (int j : neighbors_[i]) mean += before[j] - target[j];
    mean /= static_cast<double>(neighbors_[i].size());
    const Vec3 displacement = before[i] - target[i];
    const double omega = std::sqrt(spring_[i]);
    Vec3 acceleration = -spring_[i] * displacement + 2500.0 * (mean - displacement);
    acceleration -= (2 * 0.2 * omega) * velocity_[i];
    acceleration.y() -= 0.06 * kGravity;
    velocity_[i] += dt * acceleration;
    position_[i] += dt * velocity_[i];
  }
  for (int round = 0; round < 3; ++round) {
    for (const Edge& edge : edges_) {
      const double wa = freedom_[edge.a], wb = freedom_[edge.b];
      const Vec3 d = position_[edge.b] - position_[edge.a];
      const double length = d.norm();
      if (length < 1e-6 || wa + wb <= 0) continue;
      const Vec3 correction = kEdgeStiffness * (length - edge.length) / (length * (wa + wb)) * d;
      position_[edge.a] += wa * correction;
      position_[edge.b] -= wb * correction;
    }
    for (int i : close_) {
      for (const Limb& c : limbs_) {
        const double t = segment_parameter(position_[i], origins[c.from], origins[c.to]);
        const Vec3 axis_point = origins[c.from] + t * (origins[c.to] - origins[c.from]);
        const Vec3 out = position_[i] - axis_point;
        const double radius = c.radius_from + t * (c.radius_to - c.radius_from), distance = out.norm();
        if (distance < radius && distance > 1e-6)
          position_[i] += 0.7 * freedom_[i] * (radius - distance) / distance * out;
      }
    }
  }
  const double longest = 260 * actor_.scale;
  for (int i : close_) {
    // Held places are blended, and nothing strays farther than cloth could.
    Vec3 displacement = (1 - kHold * (1 - freedom_[i])) * (position_[i] - target[i]);
    const double length = displacement.norm();
    if (length > longest) displacement *= longest / length;
    position_[i] = target[i] + displacement;
    velocity_[i] = (position_[i] - before[i]) / dt;
  }
}

}  // namespace livecap::synth
