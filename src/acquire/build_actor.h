// `livecap actor build`: from pictures of a person standing still, or a video of them turning, to actor.glb
// (docs/actor_build.md; paper, "Actor Model Acquisition").
#pragma once

#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "acquire/body_rig.h"
#include "acquire/parsing_network.h"
#include "base/value_range.h"
#include "meshing/actor_glb.h"
#include "ocl/context.h"
#include "scan/volume.h"
#include "views/load_views.h"
#include "views/turntable.h"

namespace livecap::acquire {

struct BuildOptions {
  static constexpr ValueRange kTargetVertices{500, 40000}, kGridMm{3, 30}, kTextureSize{128, 8192};

  ViewFiles views;               // pictures; views.images empty: none
  bool colmap = false;           // COLMAP finds the cameras of the pictures
  TurntableOptions turntable;    // instead of pictures; turntable.video empty: none
  std::filesystem::path mesh;    // a scan; empty: a hull is carved
  std::filesystem::path joints;  // joints.json; empty: all from the network
  ParserOptions parser;          // labels from a network instead of label images
  std::string name = "actor";
  std::string model = "full";  // of the pose network
  std::string unit = "auto";   // of the cameras' or the scan's world: m, cm, mm, inch
  double height_mm = 0;        // > 0: the person is this tall
  int target_vertices = 5000;
  double grid_mm = 7;       // of the hull
  int texture_size = 2048;  // px
  bool refine = true;       // move the hull to where the pictures agree in colour

  bool has_pictures() const { return !views.images.empty() || !turntable.video.empty(); }
  void validate() const;  // throws ConfigError
};

// What a build found out on its way, for the report.
struct BuildResult {
  meshing::ActorFile actor;
  BodyJoints joints;
  std::vector<char> seen;          // [n_vertices] 0: no picture shows the vertex; empty without pictures
  std::vector<std::string> notes;  // what was assumed, left out or looks wrong, one line each
  std::vector<std::pair<std::string, double>> stage_s;
  std::string turn;  // of a turntable video: how well it is known, one line
  int n_views = 0;
  int n_detected = 0;       // views in which the network saw a person
  double keypoint_rad = 0;  // rms angle between the views' keypoints and their points in space
  double overlap = std::numeric_limits<double>::quiet_NaN();  // mean IoU of the surface's silhouettes with the masks
};

// stage: what is being done; done of total. false stops with an Error.
using BuildProgress = std::function<bool(const std::string& stage, int done, int total)>;

// Throws ConfigError, IoError, OclError.
BuildResult build_actor(ocl::DeviceContext& network_device, ocl::DeviceContext& device, const BuildOptions& options,
                        const BuildProgress& progress = {});

}  // namespace livecap::acquire
