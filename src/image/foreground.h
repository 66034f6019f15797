// The person's mask in one frame (paper, "Input Stream Processing"): background subtraction against the empty scene,
// gated and steadied by the network's person mask; without an empty scene the network's mask alone.
#pragma once

#include "base/image_rgb.h"
#include "image/background_model.h"
#include "livecap/detections.h"

namespace livecap {

struct ForegroundOptions {
  BackgroundOptions background;
  float gate_margin = 0.08f;   // the network mask grows by this share of the person's height before it gates
  float core_margin = 0.012f;  // and shrinks by this share to the core that is always foreground
  float core_probability = 0.9f;
  float seam = 0.006f;  // what differs so near to the network's mask, share of the height, is never a stranger's
  float stranger_reach = 0.08f;  // how far beyond the gate strangers are looked for, share of the height
  float least_stranger = 0.04f;  // a stranger is at least this share of the person in the picture
  float trust = 2.0f;            // at network probability 1 a difference counts 1 + trust times as much
  float edge_share = 0.45f;      // border pixels with less than this share of the contrast beside them are background
  float smooth_px = 1.0f;        // standard deviation of the smoothing before the decision
  float min_part = 0.02f;        // pieces below this share of the largest one are dropped
  float max_hole = 0.0015f;      // holes below this share of the person's area are closed

  void validate() const;  // throws ConfigError
};

class ForegroundModel {
 public:
  explicit ForegroundModel(const ForegroundOptions& options = {});

  // One picture of the empty scene, undistorted; call it once for a single plate, or with every empty frame.
  void train(const ImageRgb& empty_plate) { background_.train(empty_plate); }
  bool has_background() const { return background_.trained(); }

  // 255 = person. network_mask: of the frame's size, or empty where the network gave none (then the whole picture is
  // looked at). A mask without anybody, or neither mask nor plate, gives an empty (all zero) result, not an error.
  // Throws ConfigError when sizes differ.
  ImageGray segment(const ImageRgb& frame, const PersonMask& network_mask) const;

 private:
  ForegroundOptions options_;
  BackgroundModel background_;
};

}  // namespace livecap
