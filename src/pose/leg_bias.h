// How straight the network sees one person's legs. Who stands with bent knees has them 90 to 120 mm nearer to the
// camera than the hips, and networks see 0 to 40 of it, in every frame alike. What the solved poses differ by on
// average is taken out of the 3D detections, so that E_3D tells how legs move and the picture how bent they are.
#pragma once

#include <array>

#include "actor/actor.h"
#include "base/detections.h"
#include "geometry/skeleton.h"
#include "pose/leg_exchange.h"

namespace livecap {

struct LegBiasOptions {
  double memory = 60;  // frames that face the camera, or turn their back on it, after which a leg's say is 1/e
  double prior = 10;   // so many of these say that there is no bias

  void validate() const;  // throws ConfigError
};

// Of thighs and of shins, both legs alike: what is missing along the line of sight from their unit vectors in who faces
// straight away from the camera, with the sign turned in who faces it. Who stands sideways neither tells nor needs it.
class LegBias {
 public:
  explicit LegBias(const LegBiasOptions& options);  // throws ConfigError

  // A pose that is believed, and what the network saw. A part of a leg one of whose ends was not seen tells nothing.
  void learn(const Actor& actor, const KeypointDetections& detected, const Pose& pose);

  // The detections with legs that reach as far in depth as those of solved poses do; lengths stay. pose: tells where
  // the person faces, e.g. the last one.
  KeypointDetections corrected(const KeypointDetections& detected, const Pose& pose) const;

  void forget() { thigh_ = shin_ = {}; }

 private:
  struct Mean {
    double sum = 0;
    double weight = 0;
  };
  void add(const Actor& actor, const KeypointDetections& detected, const Pose& pose,
           const std::array<Eigen::Vector3d, kKeypointCount>& solved, int from, int to, Mean& mean) const;
  double bias(const Mean& mean) const { return mean.sum / (mean.weight + options_.prior); }

  LegBiasOptions options_;
  Mean thigh_, shin_;
};

}  // namespace livecap
