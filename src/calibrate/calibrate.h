// A camera's intrinsics and distortion from views of a calibration board (paper, "Input Stream Processing": there with
// a Matlab toolbox): what is used, how good it is, and what is missing.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "calibrate/board.h"
#include "livecap/camera.h"

namespace livecap {

struct CalibrateOptions {
  std::string source;  // folder of pictures, or a video file
  BoardOptions board;
  int max_views = 40;  // the most different ones are taken

  void validate() const;  // throws ConfigError
};

inline constexpr int kMinBoardViews = 6;

struct BoardView {
  std::string name;
  BoardCorners corners;
  double rms_px = 0;     // of the reprojection
  std::string left_out;  // why; empty: used
};

struct BoardViews {
  int width = 0, height = 0;  // px, of every picture
  std::vector<BoardView> views;
  int n_pictures = 0;              // looked at
  std::vector<std::string> notes;  // what was corrected or skipped
};

struct Calibration {
  Camera camera;
  double rms_px = 0;       // over all corners used
  double focal_sigma = 0;  // standard deviation of the focal length, relative
  int n_used = 0;
  std::vector<BoardView> views;
  std::array<double, 9> coverage{};   // share of the corners in each ninth of the picture, row by row
  std::array<double, 4> tilts_deg{};  // the most the left, right, upper, lower side of the board was farther away
  std::vector<std::string> notes;     // what was corrected, left out or is missing, one line each
};

// done of total pictures; false stops with an Error.
using CalibrateProgress = std::function<bool(int done, int total)>;

// The views of the board that are worth using: of a video the sharp ones that differ most. Throws IoError and
// ConfigError: no pictures, pictures of different sizes, no board in them, all of them blurred.
BoardViews gather_board_views(const CalibrateOptions& options, const CalibrateProgress& progress = {});

// Throws ConfigError when the views cannot determine the camera: too few, all parallel, or not of one flat board.
Calibration calibrate(const BoardViews& gathered);

}  // namespace livecap
