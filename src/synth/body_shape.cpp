#include "synth/body_shape.h"

#include "livecap/error.h"
#include "synth/synth.h"

namespace livecap::synth {

const std::array<BoneInfo, kBoneCount> kBones = {{
    {"Hips", -1},
    {"Spine", kHips},
    {"Spine1", kSpine},
    {"Spine2", kSpine1},
    {"Neck", kSpine2},
    {"Head", kNeck},
    {"LeftShoulder", kSpine2},
    {"LeftArm", kLeftShoulder},
    {"LeftForeArm", kLeftArm},
    {"LeftHand", kLeftForeArm},
    {"LeftUpLeg", kHips},
    {"LeftLeg", kLeftUpLeg},
    {"LeftFoot", kLeftLeg},
    {"LeftToeBase", kLeftFoot},
    {"RightShoulder", kSpine2},
    {"RightArm", kRightShoulder},
    {"RightForeArm", kRightArm},
    {"RightHand", kRightForeArm},
    {"RightUpLeg", kHips},
    {"RightLeg", kRightUpLeg},
    {"RightFoot", kRightLeg},
    {"RightToeBase", kRightFoot},
}};

namespace {

constexpr double kUpperArm = 268, kForeArm = 245;
constexpr int kSkirtFolds = 9;

// Rings from the top down.
const std::vector<Ring> kWomanTrunk = {{1438, 62, 56, -14},  {1415, 108, 66, -14}, {1385, 140, 82, -10},
                                       {1350, 150, 95, -4},  {1300, 150, 110, 4},  {1262, 146, 118, 8},
                                       {1215, 135, 102, 2},  {1140, 122, 93, -2},  {1060, 119, 93, 0},
                                       {1000, 138, 104, -4}, {940, 155, 112, -8}};
const std::vector<Ring> kSkirt = {{1052, 127, 100, 0}, {1020, 137, 107, -2}, {960, 165, 127, -6}, {900, 188, 148, -8},
                                  {780, 221, 180, -8}, {660, 250, 210, -6},  {530, 282, 243, -4}};
const std::vector<Ring> kManTrunk = {{1442, 66, 60, -14},  {1420, 118, 74, -14}, {1390, 158, 92, -10},
                                     {1350, 170, 108, -4}, {1290, 172, 120, 2},  {1220, 164, 117, 2},
                                     {1130, 156, 113, 2},  {1050, 162, 116, 1},  {990, 178, 123, 0},
                                     {930, 196, 132, -4},  {872, 204, 142, -6}};
const std::vector<Ring> kTrousersSeat = {
    {1040, 140, 100, 0}, {960, 150, 108, -4}, {880, 160, 116, -8}, {800, 150, 108, -8}};

Vec3 mirrored(const Vec3& p) {
  return {-p.x(), p.y(), p.z()};
}

Vec3 arm_direction() {
  const double a = kArmRestDeg * M_PI / 180;
  return {std::cos(a), -std::sin(a), 0};
}

Ring ring_at(const std::vector<Ring>& rings, double y) {
  if (y >= rings.front().y) return rings.front();
  for (size_t i = 1; i < rings.size(); ++i) {
    if (y < rings[i].y) continue;
    const Ring &a = rings[i - 1], &b = rings[i];
    const double t = (a.y - y) / (a.y - b.y);
    return {y, a.half_width + t * (b.half_width - a.half_width), a.half_depth + t * (b.half_depth - a.half_depth),
            a.center_z + t * (b.center_z - a.center_z)};
  }
  return rings.back();
}

// A stack of rounded rectangles-to-ellipses, closed at both ends. `waves` folds of relative depth `depth`.
double ring_stack(const std::vector<Ring>& rings, const Vec3& p, double power, double wave_depth = 0) {
  const Ring r = ring_at(rings, p.y());
  const double x = std::abs(p.x()) / r.half_width, z = (p.z() - r.center_z) / r.half_depth;
  double q = std::pow(std::pow(x, power) + std::pow(std::abs(z), power), 1 / power);
  if (wave_depth > 0) q /= 1 + wave_depth * std::cos(kSkirtFolds * std::atan2(z, x) + M_PI);
  const double side = (q - 1) * std::min(r.half_width, r.half_depth);
  return smooth_max(side, std::max(p.y() - rings.front().y, rings.back().y - p.y()), 14);
}

}  // namespace

Outfit outfit_from_name(const std::string& name) {
  if (name == "skirt") return Outfit::kSkirt;
  if (name == "trousers") return Outfit::kTrousers;
  throw ConfigError("there is no built-in actor '" + name + "'; there are: skirt, trousers");
}

BodyShape::BodyShape(Outfit outfit) : outfit_(outfit) {
  const bool woman = outfit == Outfit::kSkirt;
  trunk_ = woman ? kWomanTrunk : kManTrunk;
  garment_ = woman ? kSkirt : kTrousersSeat;
  const Vec3 shoulder(woman ? 152 : 168, 1352, -18);
  joints_[kHips] = {0, 930, -5};
  joints_[kSpine] = {0, 1020, -5};
  joints_[kSpine1] = {0, 1130, -6};
  joints_[kSpine2] = {0, 1250, -10};
  joints_[kNeck] = {0, 1420, -16};
  joints_[kHead] = {0, 1508, 0};
  joints_[kLeftShoulder] = {28, 1372, -10};
  joints_[kLeftArm] = shoulder;
  joints_[kLeftForeArm] = shoulder + kUpperArm * arm_direction() + Vec3(0, 0, -4);
  joints_[kLeftHand] = shoulder + (kUpperArm + kForeArm) * arm_direction() + Vec3(0, 0, 6);
  joints_[kLeftUpLeg] = {86, 900, -4};
  joints_[kLeftLeg] = {112, 490, 4};
  joints_[kLeftFoot] = {130, 84, -22};
  joints_[kLeftToeBase] = {142, 26, 98};
  for (int bone = kLeftShoulder; bone <= kLeftToeBase; ++bone)
    joints_[bone + kRightShoulder - kLeftShoulder] = mirrored(joints_[bone]);
}

void BodyShape::head_distances(const Vec3& p, std::array<double, kPartCount>& d) const {
  const bool woman = outfit_ == Outfit::kSkirt;
  const double jaw = woman ? 33 : 38;
  double face = ellipsoid(p, {0, 1607, 0}, {74, 84, 92});
  face = smooth_min(face, tapered_capsule(p, {0, 1575, 26}, {0, 1505, 55}, 62, jaw), 45);
  const double socket = (p - Vec3(31, 1594, 103)).norm() - 17;
  face = smooth_max(face, -socket, 12);
  face = smooth_min(face, tapered_capsule(p, {0, 1596, 90}, {0, 1563, 110}, 8, 13), 12);  // nose
  face = smooth_min(face, tapered_capsule(p, {0, 1535, 86}, {13, 1535, 83}, 8, 6), 12);   // lips
  face = smooth_min(face, ellipsoid(p, {77, 1582, 2}, {10, 30, 18}), 10);                 // ear
  d[kFacePart] = face;
  d[kNeckPart] = tapered_capsule(p, {0, 1405, -18}, {0, 1530, 0}, woman ? 52 : 62, woman ? 44 : 54);

  // Hair: a cap around the skull, cut free of the face and the ears.
  const double volume = woman ? 12 : 8;
  double hair = ellipsoid(p, {0, 1610, -8}, {78 + volume, 82 + volume, 92 + volume});
  const double face_cut = p.z() - (52 + 0.62 * (p.y() - 1600));
  const double nape_cut = 1540 - p.y();
  hair = smooth_max(hair, std::max(face_cut, nape_cut), 12);
  if (woman) hair = smooth_min(hair, (p - Vec3(0, 1662, -100)).norm() - 40, 16);  // bun
  d[kHairPart] = hair;
}

void BodyShape::arm_distances(const Vec3& p, std::array<double, kPartCount>& d) const {
  const bool woman = outfit_ == Outfit::kSkirt;
  const double thick = woman ? 0 : 6;
  const Vec3 &shoulder = joints_[kLeftArm], &elbow = joints_[kLeftForeArm], &wrist = joints_[kLeftHand];
  const Vec3 along = arm_direction();
  const double upper = tapered_capsule(p, shoulder, elbow, 46 + thick, 37 + thick);
  const Vec3 muscle = elbow + 0.28 * (wrist - elbow);
  double fore = smooth_min(tapered_capsule(p, elbow, muscle, 37 + thick, 38 + thick),
                           tapered_capsule(p, muscle, wrist, 38 + thick, 26 + 0.5 * thick), 8);
  d[kArmPart] = smooth_min(upper, fore, 14);

  // The mitten hand: flat, palm down, thumb to the front.
  const Vec3 across(0, 0, 1);
  const Vec3 normal = across.cross(along).normalized();
  const Vec3 q = p - wrist;
  const Vec3 flat(q.dot(along), 2.0 * q.dot(normal), q.dot(across));
  double hand = tapered_capsule(flat, {28, 0, 0}, {88, 0, 2}, 34, 38);
  hand = smooth_min(hand, tapered_capsule(flat, {80, 0, 6}, {158, 0, 4}, 36, 24), 14) * 0.6;
  const Vec3 local(q.dot(along), q.dot(normal), q.dot(across));
  hand = smooth_min(hand, tapered_capsule(local, {25, 0, 22}, {88, -6, 62}, 16, 11), 10);
  d[kHandPart] = smooth_min(hand, (q - 12 * along).norm() - 24, 16);

  // Sleeve, cut square.
  const double length = sleeve_length();
  const Vec3 end = shoulder + length * along;
  const double sleeve = tapered_capsule(p, shoulder, end, 57 + thick, 56 + thick);
  d[kTopPart] = smooth_min(d[kTopPart], smooth_max(sleeve, (p - end).dot(along), 8), 40);
}

void BodyShape::leg_distances(const Vec3& p, std::array<double, kPartCount>& d) const {
  const Vec3 &hip = joints_[kLeftUpLeg], &knee = joints_[kLeftLeg], &ankle = joints_[kLeftFoot];
  const double thigh = tapered_capsule(p, hip, knee, 84, 54);
  double shin = tapered_capsule(p, knee, ankle, 52, 34);
  shin = smooth_min(shin, tapered_capsule(p, {122, 390, -18}, {127, 270, -26}, 50, 42), 30);  // calf
  d[kLegPart] = smooth_min(thigh, shin, 20);

  // Shoe: a flattened capsule cut by the floor, and the part that holds the ankle.
  const Vec3 flat(p.x(), 1.25 * p.y(), p.z());
  double shoe = 0.8 * tapered_capsule(flat, {132, 44, -48}, {150, 34, 118}, 42, 46);
  shoe = smooth_min(shoe, tapered_capsule(p, {131, 60, -24}, {130, 92, -22}, 44, 42), 30);
  shoe = smooth_max(shoe, p.y() - 104, 6);
  d[kShoePart] = smooth_max(shoe, -p.y(), 6);

  if (outfit_ == Outfit::kTrousers) {
    const Vec3 hem = ankle + Vec3(0, -30, 6);
    double leg = smooth_min(tapered_capsule(p, hip, knee, 99, 73), tapered_capsule(p, knee, hem, 73, 64), 20);
    leg = smooth_max(leg, (hem.y() + 2) - p.y(), 8);
    d[kBottomPart] = smooth_min(d[kBottomPart], leg, 25);
  }
}

std::array<double, kPartCount> BodyShape::part_distances(const Vec3& p) const {
  std::array<double, kPartCount> d;
  if (outfit_ == Outfit::kSkirt) {
    d[kTopPart] = ring_stack(trunk_, p, 2.3);
    const double t = std::clamp((garment_.front().y - p.y()) / (garment_.front().y - garment_.back().y), 0.0, 1.0);
    const double skirt = ring_stack(garment_, p, 2.0, 0.085 * t * t + 0.01 * t);
    // Hollow from below, so that the legs leave it well above the hem.
    const double hollow = ellipsoid(p, {0, garment_.back().y - 10, -4}, {222, 80, 182});
    d[kBottomPart] = smooth_max(skirt, -hollow, 10);
  } else {
    d[kTopPart] = ring_stack(trunk_, p, 2.4);
    d[kBottomPart] = ring_stack(garment_, p, 2.3);
  }
  head_distances(p, d);
  arm_distances(p, d);
  leg_distances(p, d);
  return d;
}

double BodyShape::distance(const Vec3& point) const {
  const Vec3 p(std::abs(point.x()), point.y(), point.z());
  const auto d = part_distances(p);
  double head = smooth_min(d[kFacePart], d[kNeckPart], 22);
  head = smooth_min(head, d[kHairPart], 6);
  double all = smooth_min(head, d[kTopPart], 7);
  const double arm = smooth_min(d[kArmPart], d[kHandPart], 14);
  all = smooth_min(all, arm, 5);
  all = smooth_min(all, d[kBottomPart], 8);
  all = smooth_min(all, d[kLegPart], 5);
  return smooth_min(all, d[kShoePart], 6);
}

Vec3 BodyShape::gradient(const Vec3& p) const {
  constexpr double kStep = 0.5;
  Vec3 g;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 step = Vec3::Zero();
    step[axis] = kStep;
    g[axis] = distance(p + step) - distance(p - step);
  }
  const double length = g.norm();
  return length > 1e-12 ? Vec3(g / length) : Vec3::UnitY();
}

Part BodyShape::part(const Vec3& point) const {
  const auto d = part_distances({std::abs(point.x()), point.y(), point.z()});
  return static_cast<Part>(std::min_element(d.begin(), d.end()) - d.begin());
}

int BodyShape::label(Part part, const Vec3& p) const {
  const bool left = p.x() > 0;
  switch (part) {
    case kHairPart:
      return 2;
    case kFacePart:
    case kNeckPart:
      return 13;
    case kTopPart:
      return 5;
    case kArmPart:
    case kHandPart:
      return left ? 14 : 15;
    case kBottomPart:
      return outfit_ == Outfit::kSkirt ? 12 : 9;
    case kLegPart:
      return left ? 16 : 17;
    default:
      return left ? 18 : 19;
  }
}

double BodyShape::bottom_hem_y() const {
  return outfit_ == Outfit::kSkirt ? garment_.back().y : joints_[kLeftFoot].y() - 28;
}
double BodyShape::bottom_waist_y() const {
  return outfit_ == Outfit::kSkirt ? garment_.front().y : trunk_.back().y;
}
double BodyShape::sleeve_length() const {
  return outfit_ == Outfit::kSkirt ? 120 : 165;
}

}  // namespace livecap::synth
