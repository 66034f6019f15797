// Pictures from all around out of a video of a person who turns in place before a static camera: which frames, and how
// far the person had turned in each as the network sees it (docs/actor_build.md).
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "base/detections.h"
#include "ocl/context.h"
#include "views/view.h"

namespace livecap {

struct TurntableOptions {
  std::string video;        // file or folder of pictures; empty: none
  std::string camera;       // camera.json; empty:
  double fov_deg = 0;       // of the longer side; 0: kAssumedFovDeg
  int n_views = 70;         // frames taken, evenly around
  int max_looked_at = 900;  // frames; of a longer video every second, third, ...
  int max_side_px = 1280;   // larger pictures are reduced

  void validate() const;  // throws ConfigError
};

inline constexpr double kAssumedFovDeg = 60;  // of a phone that films upright

// One full turn, in its order.
struct TurntableViews {
  std::vector<View> views;        // where the cameras were is not known yet
  std::vector<double> angle_rad;  // how far the person has turned to their left since facing the camera
};

// What one look at a frame says, for choose_turn.
struct TurnSample {
  bool person = false, whole = false;  // whole: all of the person is inside the picture
  double facing_rad = 0;               // where the person faces, see facing_rad()
  double sharpness = 0;
};

// Where hips and shoulders face: 0 = the camera, rising as the person turns to their left, in (-pi, pi].
double facing_rad(const Detections& detections);

// Indices of the samples to take, evenly spread over the quickest full turn, the sharpest of each side: n_views at
// most, and some more where the network sees one direction for long. angle_rad: of each, without jumps. Throws
// ConfigError: nobody, no turn, less than a full one, to and fro, not the whole person. what: named in the messages.
std::vector<int> choose_turn(const std::vector<TurnSample>& samples, int n_views, const std::string& what,
                             std::vector<double>& angle_rad);

// Throws IoError (video, camera), ConfigError (options, and as choose_turn), OclError.
TurntableViews read_turntable(ocl::DeviceContext& device, const std::string& model, const TurntableOptions& options,
                              std::vector<std::string>& notes,
                              const std::function<void(int done, int total)>& progress);

}  // namespace livecap
