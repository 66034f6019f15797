// capture.glb: the actor with its skeleton animation and the non-rigid motion as morph targets (docs/formats.md). Opens
// in Blender 3.4+ and three.js; `livecap` reads it back as an actor.
#pragma once

#include <Eigen/Geometry>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "actor/actor.h"
#include "livecap/camera.h"

namespace livecap {

struct CapturedFrame {
  bool tracked = false;  // frames without a result of their own get no key: viewers interpolate across them
  Pose pose;             // camera_from_root, mm
};

struct CaptureGlbOptions {
  double fps = 30;                 // of the input; frame i is keyed at i / fps seconds, or
  std::vector<double> times_s{};   // at times_s[i]: one for each frame, growing
  int max_morph_targets = 64;      // 0 or 1: skeleton only
  double tolerance_mm = 0.02;      // shapes stop when what they leave out is below this (root mean square)
  std::optional<Camera> camera{};  // becomes a node; glTF knows its fields of view, the rest is in its extras
  // Where poses and vertices are, from the frame of that camera; mm.
  Eigen::Isometry3d frame_from_camera = Eigen::Isometry3d::Identity();
};

struct CaptureGlbReport {
  int n_frames = 0;
  int n_keys = 0;  // tracked frames
  int n_morph_targets = 0;
  double mean_error_mm = 0;  // captured vertex against morph + linear skinning as a viewer computes it, quantised
  double max_error_mm = 0;
  size_t bytes = 0;
};

// Fills vertices_m with the captured surface of input frame `frame`: [3*n_vertices] metres, glTF frame, template order.
using FrameVertices = std::function<void(int frame, std::span<float> vertices_m)>;

// Each tracked frame's vertices are asked for three times. A tracked frame with non-finite vertices keeps its pose and
// gets no displacement. An empty `vertices` writes the skeleton alone. Written atomically; the error is logged. Throws
// IoError when the file cannot be written, ConfigError for options that make no sense.
CaptureGlbReport write_capture_glb(const std::filesystem::path& path, const Actor& actor,
                                   std::span<const CapturedFrame> frames, const FrameVertices& vertices,
                                   const CaptureGlbOptions& options = {});

// The same from vertices.pc2, whose sample i is frame i. Throws IoError when it has other points or fewer samples.
CaptureGlbReport write_capture_glb(const std::filesystem::path& path, const Actor& actor,
                                   std::span<const CapturedFrame> frames, const std::filesystem::path& vertices_pc2,
                                   const CaptureGlbOptions& options = {});

}  // namespace livecap
