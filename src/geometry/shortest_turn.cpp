#include "geometry/shortest_turn.h"

#include <cmath>

namespace livecap {

Eigen::Quaterniond shortest_turn(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  const Eigen::Vector3d a = from.normalized(), b = to.normalized();
  const double cosine = a.dot(b);
  Eigen::Quaterniond turn;
  if (cosine < -1 + 1e-12) {  // opposed: half a turn about anything across
    turn.w() = 0;
    turn.vec() = a.unitOrthogonal();
  } else {
    turn.w() = std::sqrt((1 + cosine) / 2);
    turn.vec() = a.cross(b) / (2 * turn.w());
  }
  return turn.normalized();  // which cancellation has spoilt between nearly opposite directions
}

}  // namespace livecap
