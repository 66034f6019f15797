// The shortest turn from one direction to another.
#pragma once

#include <Eigen/Geometry>

namespace livecap {

// After it `from` points along `to`; neither has to be of length 1. Between opposite directions it is half a turn about
// some axis across them. What Eigen's FromTwoVectors is, without the SVD that takes twelve seconds to compile.
Eigen::Quaterniond shortest_turn(const Eigen::Vector3d& from, const Eigen::Vector3d& to);

}  // namespace livecap
