// `livecap actor fit`: a built-in actor with the proportions and colours of the person in a short video; no scan, no
// pictures from all around (docs/actor_build.md).
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "base/value_range.h"
#include "fit/fit_proportions.h"
#include "meshing/actor_glb.h"
#include "ocl/context.h"

namespace livecap {

struct FitActorOptions {
  static constexpr ValueRange kFitFrames{4, 200};

  std::string video;               // file or folder of pictures
  std::string camera;              // camera.json; or
  double fov_deg = 0;              // field of view of the longer side
  std::string background;          // picture of the empty scene; or
  int background_frames = 0;       // the first frames of the video are empty; or neither
  std::string actor = "trousers";  // name of the built-in actor
  double height_mm = 0;            // of the person; 0: the built-in actor's
  std::string model = "full";      // of the pose network
  int max_frames = 600;            // of the video that are looked at
  int n_frames = 24;               // that are fitted to, at least half of it when the video has them

  void validate() const;  // throws ConfigError
};

struct FitResult {
  meshing::ActorFile actor;
  std::array<double, kProportionCount> scales{};  // against the built-in actor of the same height
  int n_looked_at = 0, n_seen = 0, n_used = 0;    // frames; with the whole person; fitted to
  double overlap_before = 0, overlap_after = 0;   // mean silhouette IoU of the posed actor over the frames used
  double seen_share = 0;                          // of the vertices, by some frame
  std::vector<std::string> notes;
};

// Frames of the video that show a whole person, evenly spread; the reading part of fit_actor.
struct FitFootage {
  Camera camera;  // undistorted
  std::vector<FitFrame> frames;
  int n_looked_at = 0, n_seen = 0;
  std::vector<std::string> notes;
};

using FitProgress = std::function<bool(const std::string& stage, int done, int total)>;

// The network runs on network_device, the segmentation on device. Throws IoError, ConfigError (nobody in the video, too
// few frames with a whole person), OclError.
FitFootage read_footage(ocl::DeviceContext& network_device, ocl::DeviceContext& device, const FitActorOptions& options,
                        const FitProgress& progress = {});

// The same on footage that is there already.
FitResult fit_actor(ocl::DeviceContext& device, FitFootage footage, const FitActorOptions& options,
                    const FitProgress& progress = {});

// Colours of the vertices, sRGB in [0,1]: the median over the frames that see one well; unseen ones take that of their
// mirror image, else their neighbours'. seen_share: of the vertices that some frame shows.
std::vector<Eigen::Vector3d> colors_from_frames(FramePoser& poser, const meshing::Surface& surface,
                                                const std::vector<FitFrame>& frames, double& seen_share);

}  // namespace livecap
