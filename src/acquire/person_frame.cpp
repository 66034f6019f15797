#include "acquire/person_frame.h"

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <utility>

#include "actor/height_range.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap::acquire {

namespace {

using Eigen::Vector3d;

constexpr std::array<std::pair<const char*, double>, 4> kUnits = {{{"m", 1000}, {"cm", 10}, {"mm", 1}, {"inch", 25.4}}};

// From the ankles to the nose a standing person measures about this share of the height.
constexpr double kAnkleToNoseShare = 0.865;

// Of the sum of two unit vectors, across the body: hips and shoulders that contradict each other, or lie along it, say
// nothing.
constexpr double kLeastSideways = 1e-6;

// Hand-held cameras tell the vertical to half a degree. An axis of the world as near to it as this is no chance (one in
// a thousand): somebody made the world upright, more exactly than that.
constexpr double kUprightRad = 1.5 * M_PI / 180;

Vector3d nearest_axis(const Vector3d& direction) {
  int axis;
  direction.cwiseAbs().maxCoeff(&axis);
  return Vector3d::Unit(axis);
}

}  // namespace

double unit_in_mm(const std::string& unit) {
  if (unit == "auto") return 0;
  for (const auto& [name, mm] : kUnits)
    if (unit == name) return mm;
  throw ConfigError("--unit " + unit + ": must be m, cm, mm, inch or auto");
}

double guess_unit_mm(double height_units, std::string& name) {
  for (const auto& [unit, mm] : kUnits)
    if (height_units * mm > 1100 && height_units * mm < 2300) {
      name = unit;
      return mm;
    }
  return 0;
}

Vector3d vertical_of(const std::vector<View>& views) {
  Eigen::Matrix3d sum = Eigen::Matrix3d::Zero();
  for (const View& view : views) {
    const Vector3d right = view.camera_from_world.linear().row(0);
    sum += right * right.transpose() / static_cast<double>(views.size());
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> eigen(sum);
  if (!(eigen.eigenvalues()[1] > 0.1 && eigen.eigenvalues()[0] < 0.05)) return Vector3d::Zero();
  const Vector3d vertical = eigen.eigenvectors().col(0), axis = nearest_axis(vertical);
  return std::abs(vertical.dot(axis)) > std::cos(kUprightRad) ? axis : vertical;
}

PersonFrame find_person_frame(const SpaceKeypoints& world, double unit_mm, double height_mm,
                              std::vector<std::string>& notes, const Vector3d& vertical) {
  for (int k : {kLeftHip, kRightHip, kLeftShoulder, kRightShoulder, kLeftAnkle, kRightAnkle})
    if (!world[k].found)
      throw ConfigError("the network's " + std::string(kKeypointNames[k]) +
                        " does not agree between the pictures; in --joints it has to be in the unit of the world");
  const auto at = [&](int k) { return world[k].position; };
  const Vector3d shoulders = (at(kLeftShoulder) + at(kRightShoulder)) / 2,
                 ankles = (at(kLeftAnkle) + at(kRightAnkle)) / 2;
  const Vector3d hips = at(kLeftHip) - at(kRightHip), width = at(kLeftShoulder) - at(kRightShoulder);
  const auto fail = [] { throw ConfigError("hips, shoulders and ankles coincide: the person has no orientation"); };
  // Eigen's normalized() of nothing is nothing.
  if (!((shoulders - ankles).norm() > 0 && hips.norm() + width.norm() > 0)) fail();
  PersonFrame frame;
  Vector3d up = (shoulders - ankles).normalized();
  const Vector3d level = vertical.isZero() ? nearest_axis(up) : vertical;
  if (std::abs(up.dot(level)) > std::cos(8 * M_PI / 180)) up = (up.dot(level) > 0 ? 1 : -1) * level;
  Vector3d left = hips.normalized() + width.normalized();
  left -= left.dot(up) * up;
  if (!(left.norm() > kLeastSideways)) fail();
  left.normalize();
  frame.rotation << left.transpose(), up.transpose(), left.cross(up).transpose();

  const Vector3d top = world[kNose].found ? at(kNose) : Vector3d(shoulders + 0.24 * (shoulders - ankles));
  const double height_units = up.dot(top - ankles) / kAnkleToNoseShare;
  if (!(height_units > 0)) throw ConfigError("the nose is below the ankles: the person does not stand");
  if (height_mm > 0) {
    frame.scale_mm = height_mm / height_units;
  } else if (unit_mm > 0) {
    frame.scale_mm = unit_mm;
    if (!kPersonHeightMm.contains(height_units * unit_mm))
      throw ConfigError(
          format("--unit: the person would be %.3g m tall; another unit, or --height", height_units * unit_mm / 1000));
  } else {
    std::string name;
    frame.scale_mm = guess_unit_mm(height_units, name);
    if (frame.scale_mm <= 0)
      throw ConfigError(
          format("the person is %.4g units tall, which is no height in m, cm, mm or inch; give --height "
                 "METRES or --unit",
                 height_units));
    notes.push_back(format("the person is %.4g units tall: taken as %s (--unit or --height says otherwise)",
                           height_units, name.c_str()));
  }
  const Vector3d pelvis = (at(kLeftHip) + at(kRightHip)) / 2;
  frame.translation_mm = -frame.scale_mm * (frame.rotation * (pelvis + up * up.dot(ankles - pelvis)));
  return frame;
}

PersonFrame composed(const PersonFrame& then, const PersonFrame& first) {
  PersonFrame both;
  both.scale_mm = then.scale_mm * first.scale_mm;
  both.rotation = then.rotation * first.rotation;
  both.translation_mm = then.scale_mm * (then.rotation * first.translation_mm) + then.translation_mm;
  return both;
}

void move_views(const PersonFrame& frame, std::vector<View>& views) {
  for (View& view : views) {
    const Eigen::Matrix3d turn = view.camera_from_world.linear() * frame.rotation.transpose();
    view.camera_from_world.translation() =
        frame.scale_mm * view.camera_from_world.translation() - turn * frame.translation_mm;
    view.camera_from_world.linear() = turn;
  }
}

SpaceKeypoints move_keypoints(const PersonFrame& frame, const SpaceKeypoints& world) {
  SpaceKeypoints rest = world;
  for (SpacePoint& point : rest) point.position = frame.to_rest(point.position);
  return rest;
}

void move_volume(const PersonFrame& frame, Volume& volume) {
  if (!frame.rotation.isIdentity()) throw LogicError("a volume cannot be turned");
  volume.low = frame.to_rest(volume.low);
  volume.step *= frame.scale_mm;
  for (float& d : volume.distance) d *= static_cast<float>(frame.scale_mm);
}

}  // namespace livecap::acquire
