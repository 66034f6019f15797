// How the person stands in the world of the cameras or the scan: the turn and scale to the actor's rest frame
// (mm, +X the subject's left, +Y up, +Z front).
#pragma once

#include <Eigen/Geometry>
#include <string>
#include <vector>

#include "acquire/keypoints.h"
#include "scan/volume.h"
#include "views/view.h"

namespace livecap::acquire {

// rest = scale_mm * rotation * world + translation_mm.
struct PersonFrame {
  double scale_mm = 1;  // mm per unit of the world
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
  Eigen::Vector3d translation_mm = Eigen::Vector3d::Zero();

  Eigen::Vector3d to_rest(const Eigen::Vector3d& world) const { return scale_mm * (rotation * world) + translation_mm; }
};

// "m", "cm", "mm" or "inch" in mm; 0 for "auto". Throws ConfigError for anything else.
double unit_in_mm(const std::string& unit);

// The unit in which a person `height_units` tall is between 1.1 m and 2.3 m, of m, cm, mm and inch; 0 when none fits.
// name: what it is called.
double guess_unit_mm(double height_units, std::string& name);

// Up, either way, when the cameras were held level: across all their horizontals, or an axis of the world as good as
// there. Zero when these say nothing.
Eigen::Vector3d vertical_of(const std::vector<View>& views);

// The frame from the keypoints: up from the ankles to the shoulders (`vertical`, or when that is zero an axis of the
// world, within 8 degrees of it is taken instead), left from hips and shoulders, the origin below the pelvis at the
// ankles' level. unit_mm 0: guessed from the height, with a note; height_mm > 0: the scale gives the person that
// height. Throws ConfigError when hips, shoulders or ankles were not found or coincide, or the unit cannot be told.
PersonFrame find_person_frame(const SpaceKeypoints& world, double unit_mm, double height_mm,
                              std::vector<std::string>& notes,
                              const Eigen::Vector3d& vertical = Eigen::Vector3d::Zero());

// The frame that does both, `first` before `then`.
PersonFrame composed(const PersonFrame& then, const PersonFrame& first);

// Views and keypoints in the rest frame.
void move_views(const PersonFrame& frame, std::vector<View>& views);
SpaceKeypoints move_keypoints(const PersonFrame& frame, const SpaceKeypoints& world);
// A grid has no directions of its own: frame must not turn (LogicError).
void move_volume(const PersonFrame& frame, Volume& volume);

}  // namespace livecap::acquire
