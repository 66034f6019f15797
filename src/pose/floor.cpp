#include "pose/floor.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "livecap/error.h"
#include "pose/round_weights.h"
#include "pose/targets.h"

namespace livecap {
namespace {

struct Foot {
  Keypoint ankle;
  const char* bone;
};

constexpr Foot kFeet[] = {{kLeftAnkle, "left_ankle"}, {kRightAnkle, "right_ankle"}};
constexpr int kPointsPerSole = 6;
constexpr double kSoleMm = 12;      // above the lowest vertex of a foot
constexpr float kOwnWeight = 0.9f;  // of a vertex that moves with its foot
constexpr float kTrusted = 0.5f;    // confidence of an ankle
// Cosine of a line of sight to the floor. Who looks down more steeply sees where on it feet are, and along the line
// they would move down more than aside.
constexpr double kSteepest = 0.7;
constexpr double kMmPerM = 1000;
// Of a camera from level, rad: edges all in the middle of the picture do not tell how far it looks down.
constexpr double kLevelDeviation = 0.4;

// Level, as what the actor stands on in its rest pose: vertices near a sole's rim lie some mm above that, and of a foot
// on tiptoe the rounded tip is taken for that much too low.
std::vector<Eigen::Vector3d> sole(const Actor& actor, int bone) {
  std::vector<Eigen::Vector3d> foot, low;
  double lowest = std::numeric_limits<double>::infinity();
  for (int i = 0; i < actor.n_vertices(); ++i) {
    float own = 0;
    for (int k = 4 * i; k < 4 * i + 4; ++k)
      if (actor.skin.bones[k] == bone) own += actor.skin.weights[k];
    if (own < kOwnWeight) continue;
    foot.push_back(Eigen::Map<const Eigen::Vector3f>(&actor.mesh.positions[3 * i]).cast<double>());
    lowest = std::min(lowest, foot.back().y());
  }
  std::copy_if(foot.begin(), foot.end(), std::back_inserter(low),
               [&](const Eigen::Vector3d& p) { return p.y() <= lowest + kSoleMm; });
  for (Eigen::Vector3d& p : low) p.y() = lowest;
  return low;
}

// `n` of the points, each as far as can be from those before; the foremost first.
std::vector<Eigen::Vector3d> spread(const std::vector<Eigen::Vector3d>& points, size_t n) {
  std::vector<Eigen::Vector3d> chosen;
  std::vector<double> distance(points.size(), std::numeric_limits<double>::infinity());
  while (chosen.size() < std::min(n, points.size())) {
    size_t next = 0;
    for (size_t i = 1; i < points.size(); ++i)
      if (chosen.empty() ? points[i].z() > points[next].z() : distance[i] > distance[next]) next = i;
    chosen.push_back(points[next]);
    for (size_t i = 0; i < points.size(); ++i) distance[i] = std::min(distance[i], (points[i] - points[next]).norm());
  }
  return chosen;
}

std::vector<Eigen::Vector3d> positions(std::span<const SolePoint> soles, const PosedSkeleton& posed) {
  std::vector<Eigen::Vector3d> points;
  for (const SolePoint& sole : soles) points.push_back(posed.camera_from_rest[sole.bone] * sole.rest_mm);
  return points;
}

// Whether where feet are seen tells how far away they stand.
bool tells_depth(const Eigen::Vector3d& middle_mm, const Eigen::Vector3d& up) {
  return away_along_floor(up).dot(middle_mm) >= kSteepest * middle_mm.norm();
}

// From here on a foot is not on this floor.
double far_mm(const FloorOptions& options) {
  return 3 * options.outlier_mm;
}

}  // namespace

double move_across_mm(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d ray = to.normalized(), move = to - from;
  return (move - ray * ray.dot(move)).norm();
}

std::optional<Floor> measured_floor(const Camera& camera) {
  if (!camera.floor) return std::nullopt;
  const auto& [x, y, z] = camera.floor->normal;
  return Floor{Eigen::Vector3d(x, y, z).normalized(), camera.floor->distance_mm};
}

FloorPlane plane_of(const Floor& floor) {
  return {{floor.up.x(), floor.up.y(), floor.up.z()}, floor.offset_mm};
}

std::vector<SolePoint> sole_points(const Actor& actor) {
  std::vector<SolePoint> points;
  for (const Foot& foot : kFeet) {
    const int bone = actor.skeleton.bone_index(foot.bone);
    if (bone < 0) continue;
    for (const Eigen::Vector3d& p : spread(sole(actor, bone), kPointsPerSole)) points.push_back({bone, p});
  }
  return points;
}

std::vector<double> standing(std::span<const SolePoint> soles, const Skeleton& skeleton, const Floor& floor,
                             const Pose& pose, const Pose* previous, double least) {
  std::vector<double> stands(soles.size(), least);
  if (!previous) return stands;
  const auto now = positions(soles, forward_kinematics(skeleton, pose));
  const auto before = positions(soles, forward_kinematics(skeleton, *previous));
  for (size_t i = 0; i < soles.size(); ++i) {
    const double height = floor.height_mm(now[i]);
    double lowest = height;
    for (size_t j = 0; j < soles.size(); ++j)
      if (soles[j].bone == soles[i].bone) lowest = std::min(lowest, floor.height_mm(now[j]));
    stands[i] = std::max(least, stands_by(height, lowest, move_across_mm(before[i], now[i])));
  }
  return stands;
}

void FloorOptions::validate() const {
  const auto positive = [](const char* field, double value) {
    if (!(value > 0) || !std::isfinite(value))
      throw ConfigError(format("floor: %s is %g; it must be finite and above 0", field, value));
  };
  positive("memory", memory);
  positive("least", least);
  positive("every", every);
  if (!(early >= 0) || !std::isfinite(early))
    throw ConfigError(format("floor: early is %g; it must be finite and at least 0", early));
  positive("tilt_deviation", tilt_deviation);
  positive("height_deviation_mm", height_deviation_mm);
  positive("outlier_mm", outlier_mm);
  positive("higher_foot_mm", higher_foot_mm);
  positive("max_contradicted_frames", max_contradicted_frames);
  balance.validate();
}

FloorFinder::FloorFinder(const Actor& actor, const FloorOptions& options, const std::optional<Floor>& measured)
    : actor_(actor),
      options_(options),
      soles_(sole_points(actor)),
      balance_(options.balance),
      in_balance_(options.balance),
      is_measured_(measured.has_value()),
      floor_(measured) {
  options.validate();
}

void FloorFinder::forget() {
  if (is_measured_) return;
  balance_.forget();
  in_balance_.forget();
  body_up_.setZero();
  products_.setZero();
  sums_.setZero();
  n_resting_ = 0;
  n_asked_ = frames_since_asked_ = 0;
  contradicted_frames_ = 0;
  floor_.reset();
}

bool FloorFinder::asks_for_feet() const {
  if (is_measured_) return false;
  const bool is_early = n_resting_ < options_.early && n_asked_ < 2 * options_.early;
  return is_early || frames_since_asked_ + 1 >= options_.every;
}

void FloorFinder::learn(const Pose& previous, const Pose& pose, const Pose* feet, const Detections& detections) {
  // For the frames that were not asked.
  const double times = n_resting_ < options_.early ? 1 : std::min(frames_since_asked_ + 1, options_.every);
  n_asked_ += asks_for_feet();
  frames_since_asked_ = feet ? 0 : frames_since_asked_ + 1;
  if (is_contradicted()) return;
  for (int k : {kNeck, kLeftAnkle, kRightAnkle})
    if (actor_.keypoints[k].bone < 0) return;
  const PosedSkeleton posed = forward_kinematics(actor_.skeleton, pose);
  const auto now = positions(soles_, posed);
  const auto before = positions(soles_, forward_kinematics(actor_.skeleton, previous));
  const PosedSkeleton posed_feet = feet ? forward_kinematics(actor_.skeleton, *feet) : posed;
  const auto told = positions(soles_, posed_feet);
  const auto joints = keypoint_positions(actor_, posed);
  const Eigen::Vector3d upright = (joints[kNeck] - (joints[kLeftAnkle] + joints[kRightAnkle]) / 2).normalized();
  if (!(upright.y() < kUprightY)) return;
  body_up_ += upright;
  const Eigen::Vector3d up = this->up();
  const bool both_seen = detections.keypoints[kLeftAnkle].confidence >= kTrusted &&
                         detections.keypoints[kRightAnkle].confidence >= kTrusted;
  if (!is_measured_ && floor_ && options_.balance.share > 0 && both_seen) learn_balance(joints, up, before, now);
  const auto believed = feet && !is_measured_ ? balanced(posed_feet, up, told) : told;

  struct Lowest {
    size_t point = 0;
    double height_mm = std::numeric_limits<double>::infinity();
  };
  std::vector<Lowest> resting;
  for (const Foot& foot : kFeet) {
    if (!(detections.keypoints[foot.ankle].confidence >= kTrusted)) continue;
    const int bone = actor_.skeleton.bone_index(foot.bone);
    Lowest lowest;
    for (size_t i = 0; i < soles_.size(); ++i)
      if (soles_[i].bone == bone && up.dot(now[i]) < lowest.height_mm) lowest = {i, up.dot(now[i])};
    if (std::isfinite(lowest.height_mm)) resting.push_back(lowest);
  }
  if (!floor_ && resting.size() == 2)  // there is no height yet that the other could be doubted by
    resting = {resting[0].height_mm < resting[1].height_mm ? resting[0] : resting[1]};
  double lower_mm = std::numeric_limits<double>::infinity();
  for (const Lowest& lowest : resting) lower_mm = std::min(lower_mm, up.dot(believed[lowest.point]));
  bool near = false, still = false;
  for (const Lowest& lowest : resting) {
    const Eigen::Vector3d& p = now[lowest.point];
    double weight = nearness(move_across_mm(before[lowest.point], p), LC_POSE_STILL_MM);
    const bool rests = weight > 0.5;
    still = still || rests;
    if (floor_) {
      const double height = floor_->height_mm(believed[lowest.point]);
      near = near || (rests && std::abs(floor_->height_mm(told[lowest.point])) < far_mm(options_));
      weight /= cauchy_doubt(height * height, options_.outlier_mm);
    }
    weight /= cauchy_doubt(std::pow(up.dot(believed[lowest.point]) - lower_mm, 2), options_.higher_foot_mm);
    if (!is_measured_ && feet) add(believed[lowest.point], times * weight);
  }
  if (floor_ && still) contradicted_frames_ = near ? 0 : contradicted_frames_ + 1;
  if (is_measured_) return;
  if (contradicted_frames_ > options_.max_contradicted_frames) return forget();
  fit();
}

std::optional<double> FloorFinder::beyond_balance_mm(const Pose& pose) const {
  const PosedSkeleton posed = forward_kinematics(actor_.skeleton, pose);
  const std::optional<Eigen::Vector3d> middle = middle_of(positions(soles_, posed));
  const Eigen::Vector3d up = this->up();
  if (!middle || !tells_depth(*middle, up)) return std::nullopt;
  const BalanceOptions& balance = options_.balance;
  const auto farther_mm =
      support_beyond_mass_mm(actor_, keypoint_positions(actor_, posed), *middle, up, balance.least_reach);
  if (!farther_mm) return std::nullopt;
  return *farther_mm - balance.middle_mm;
}

// Between both feet; nullopt for a skeleton that lacks one.
std::optional<Eigen::Vector3d> FloorFinder::middle_of(const std::vector<Eigen::Vector3d>& soles_mm) const {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  for (const Foot& foot : kFeet) {
    const int bone = actor_.skeleton.bone_index(foot.bone);
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int n = 0;
    for (size_t i = 0; i < soles_.size(); ++i) {
      if (soles_[i].bone != bone) continue;
      sum += soles_mm[i];
      ++n;
    }
    if (n == 0) return std::nullopt;
    middle += sum / n / 2;
  }
  return middle;
}

// Of who stands: the soles moved along their lines of sight, which the picture tells, to where balance ends.
std::vector<Eigen::Vector3d> FloorFinder::balanced(const PosedSkeleton& feet, const Eigen::Vector3d& up,
                                                   std::vector<Eigen::Vector3d> soles_mm) {
  const std::optional<Eigen::Vector3d> middle = middle_of(soles_mm);
  if (!middle) return soles_mm;
  const bool stands = balance_.learn(actor_, keypoint_positions(actor_, feet), *middle, up);
  if (!stands || !tells_depth(*middle, up)) return soles_mm;
  const Eigen::Vector3d away = away_along_floor(up);
  for (Eigen::Vector3d& p : soles_mm) p -= p * (balance_.excess_mm() / away.dot(p));
  return soles_mm;
}

// Feet that the floor holds are where it says, so that it is their balance that counts, not that of legs by the picture
// alone: of these the lower foot tells the floor, and where legs hide that is the one which is taken for too far. Not
// of who stands on something, and the less the farther that foot moved: who jumps is in balance in the air, too.
void FloorFinder::learn_balance(const std::array<Eigen::Vector3d, kKeypointCount>& joints, const Eigen::Vector3d& up,
                                const std::vector<Eigen::Vector3d>& before_mm,
                                const std::vector<Eigen::Vector3d>& soles_mm) {
  const std::optional<Eigen::Vector3d> middle = middle_of(soles_mm);
  if (!middle || !tells_depth(*middle, up)) return;
  const auto lowest = std::min_element(soles_mm.begin(), soles_mm.end(),
                                       [&](const auto& a, const auto& b) { return up.dot(a) < up.dot(b); });
  if (!(std::abs(floor_->height_mm(*lowest)) < far_mm(options_))) return;
  const double move = move_across_mm(before_mm[lowest - soles_mm.begin()], *lowest);
  in_balance_.learn(actor_, joints, *middle, *lowest, up, nearness(move, LC_POSE_STILL_MM));
}

void FloorFinder::add(const Eigen::Vector3d& point_mm, double weight) {
  const double fade = std::exp(-weight / options_.memory);
  const Eigen::Vector3d row(1, point_mm.x() / kMmPerM, point_mm.z() / kMmPerM);
  products_ = fade * products_ + weight * row * row.transpose();
  sums_ = fade * sums_ + weight * point_mm.y() / kMmPerM * row;
  n_resting_ = fade * n_resting_ + weight;
}

// What is upright, together. Slopes are taken for turns: before a camera that looks down by 20 degrees what says so
// counts 1.1 times.
FloorFinder::Tilt FloorFinder::tilt() const {
  Tilt both;
  both.information = Eigen::Matrix2d::Identity() / std::pow(kLevelDeviation, 2);
  Eigen::Vector2d sum = Eigen::Vector2d::Zero();
  const auto count = [&](const Eigen::Vector3d& up, const Eigen::Matrix2d& information) {
    both.information += information;
    sum += information * Eigen::Vector2d(-up.x() / up.y(), -up.z() / up.y());
  };
  if (body_up_.y() < 0) count(body_up_, Eigen::Matrix2d::Identity() / std::pow(options_.tilt_deviation, 2));
  if (upright_) count(upright_->up, upright_->information({0, 2}, {0, 2}));
  both.slope = both.information.ldlt().solve(sum);
  return both;
}

Eigen::Vector3d FloorFinder::up() const {
  if (floor_) return floor_->up;
  const Eigen::Vector2d slope = tilt().slope;
  return Eigen::Vector3d(slope.x(), -1, slope.y()).normalized();
}

// y = c + a x + b z, m, with what is upright as a prior of its tilt.
void FloorFinder::fit() {
  if (!floor_ && n_resting_ < options_.least) return;
  const Tilt upright = tilt();
  const Eigen::Matrix2d prior = std::pow(options_.height_deviation_mm / kMmPerM, 2) * upright.information;
  Eigen::Matrix3d matrix = products_;
  matrix.bottomRightCorner<2, 2>() += prior;
  Eigen::Vector3d sums = sums_;
  sums.tail<2>() += prior * upright.slope;
  const Eigen::Vector3d plane = matrix.ldlt().solve(sums);
  if (!plane.allFinite()) return;
  const Eigen::Vector3d normal(plane[1], -1, plane[2]);
  floor_ = Floor{normal.normalized(), kMmPerM * plane[0] / normal.norm()};
  if (const auto sole = in_balance_.place_mm()) floor_->offset_mm -= options_.balance.share * floor_->height_mm(*sole);
}

}  // namespace livecap
