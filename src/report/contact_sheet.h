// Single frames side by side for people to look at: the input, the captured surface over it, the outline against the
// true one, the error of every vertex.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "base/image_rgb.h"
#include "eval/evaluate.h"

namespace livecap {

// Vertex errors of this size have the last colour of the scale, mm.
inline constexpr double kHeatScaleMm = 100;

struct ContactSheet {
  std::map<int64_t, ImageRgb> pictures;  // by input frame, panels from left to right, cut to the person
  bool has_video = false;                // false: the panels have no background
  bool has_outline = false;              // true masks were there
  bool has_error = false;                // true vertices were there
};

// frames: judged ones (FrameEval::index); others are left out. video: empty = what report.json names; when it cannot be
// read a warning is logged. Every panel is height_px high. Throws like evaluate().
ContactSheet contact_sheet(const EvalOptions& options, const std::string& video, const std::vector<int64_t>& frames,
                           int height_px);

}  // namespace livecap
