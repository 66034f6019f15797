// The legs as lines hip - knee - ankle, and what is between them at one height. y up, mm.
#pragma once

#include <Eigen/Core>

#include "acquire/body_rig.h"
#include "scan/volume.h"

namespace livecap::acquire {

struct LegLine {
  Eigen::Vector3d hip, knee, ankle;
  Eigen::Vector3d at(double y) const;  // the line's point at this height; its ends beyond them

  // How far p is off the leg's flesh, mm; below 0 within. A thigh's girth is 1.3 of its length at the top and 0.92 at
  // the knee, a shank is as thick as that.
  double gap_to(const Eigen::Vector3d& p) const;
};

LegLine leg_line(const BodyJoints& joints, int thigh);  // thigh: kLeftUpLegBone or kRightUpLegBone

// True where one closed ring of cloth (a skirt, a dress) or of flesh goes around both legs at this height: what is
// between them is inside of the solid, or outside by no more than slack_mm.
bool around_both_legs(const LegLine& left, const LegLine& right, const Volume& volume, double y, double slack_mm);

}  // namespace livecap::acquire
