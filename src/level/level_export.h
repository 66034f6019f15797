// A finished capture for other programs, upright: what `livecap capture` writes in the axes of its camera, which may
// look down or be tilted, is turned and moved so that the person stands on y = 0.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/camera_tilt.h"
#include "level/capture_floor.h"

namespace livecap {

struct LevelExportOptions {
  std::filesystem::path capture;           // folder that `livecap capture` wrote
  std::vector<std::filesystem::path> out;  // .glb, .bvh or .pc2 each
  std::string actor;                       // empty: what report.json names
  std::string floor;  // camera.json or report.json whose floor counts, e.g. one measured later; empty: the capture's
  bool level_camera = false;  // take the camera to be level whatever floor is known
  int64_t first = 0;          // frame of the video
  int64_t frames = -1;        // at most so many; -1: all
  double bvh_unit_m = 0.01;
};

struct LevelExportReport {
  size_t files = 0;  // of `out` that are written, in their order; fewer than all: stopped
  FloorSource floor = FloorSource::kLevelCamera;
  CameraTilt tilt;
  double camera_height_mm = 0;
  int64_t frames = 0;
  int64_t tracked = 0;
};

// From the camera's frame to one whose y points straight down: the shortest turn that makes the floor level, then the
// origin on the floor where place_mm (camera frame) is above it. mm.
Eigen::Isometry3d level_from_camera(const Floor& floor, const Eigen::Vector3d& place_mm);

// The files are as `livecap capture` makes them, in a frame whose origin is below the root in the first tracked frame
// of those asked for. A .glb has the camera that captured it. Throws ConfigError for an ending of another kind,
// IoError naming the file of the capture that is missing or does not fit, that tells no floor, or when nobody was
// tracked in what is asked for. go_on is asked once a frame and file: when it says no, the file at hand and those after
// it are left as they were.
LevelExportReport export_level(const LevelExportOptions& options, const std::function<bool()>& go_on = {});

}  // namespace livecap
