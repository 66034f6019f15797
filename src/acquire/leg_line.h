// The legs as lines hip - knee - ankle, and what is between them at one height. y up, mm.
#pragma once

#include <Eigen/Core>

#include "scan/volume.h"

namespace livecap::acquire {

struct LegLine {
  Eigen::Vector3d hip, knee, ankle;
  Eigen::Vector3d at(double y) const;  // the line's point at this height; its ends beyond them
};

// True where one closed ring of cloth (a skirt, a dress) or of flesh goes around both legs at this height: what is
// between them is inside of the solid, or outside by no more than slack_mm.
bool around_both_legs(const LegLine& left, const LegLine& right, const Volume& volume, double y, double slack_mm);

}  // namespace livecap::acquire
