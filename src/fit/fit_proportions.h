// The proportions of a person from keypoints and silhouettes of several frames: one Gauss-Newton problem over the
// proportions and all poses, the poses eliminated frame by frame.
#pragma once

#include <vector>

#include "fit/frame_poser.h"
#include "fit/proportions.h"

namespace livecap {

struct FitOptions {
  int steps = 8;
  double keypoint_share = 0.012;    // standard deviation of a keypoint, of the person's height in the picture
  double silhouette_share = 0.004;  // of a point of the outline
  double outline_points = 120;      // as how many independent points an outline counts
  double length_prior = 0.12;       // standard deviation of a length, relative, in each frame
  double girth_prior = 0.2;         // of a girth
  double shoulder_prior = 0.05;     // of the shoulders\' width, which trades against the arms\' length
  // Of thigh against shank and upper arm against forearm: people differ little in them, and a network that sees knees
  // and elbows too high or too low does so in every frame.
  double ratio_prior = 0.03;
  double angle_prior_rad = 0.15;     // of a joint angle around that of the frame's own solution
  double rotation_prior_rad = 0.08;  // of the root
};

// actor: that of `poser`, whose keypoints are the network's. Frames that are not posed do not count; the others' poses
// become those of the actor with the new proportions (at the actor's scale).
Proportions fit_proportions(FramePoser& poser, const Actor& actor, const Camera& camera, const FitOptions& options,
                            std::vector<FitFrame>& frames);

}  // namespace livecap
