// Where the floor is, from one picture of a calibration board that lies on it, by a camera that is calibrated already.
#pragma once

#include <string>
#include <vector>

#include "base/camera_tilt.h"
#include "calibrate/board.h"
#include "livecap/camera.h"

namespace livecap {

struct FloorBoardOptions {
  std::string picture;
  BoardOptions board;
  double square_mm = 0;  // side of one of the board's squares

  void validate() const;  // throws ConfigError
};

// The board in the picture, by whatever camera.
struct FloorPicture {
  std::string name;
  int width = 0, height = 0;  // px
  BoardCorners corners;
  double square_mm = 0;
  std::vector<std::string> notes;  // what was corrected, one line each
};

struct FloorBoard {
  FloorPlane floor;
  int n_corners = 0;
  double rms_px = 0;  // of the reprojection
  CameraTilt tilt;
  double away_mm = 0;   // the board, from the camera
  double sigma_mm = 0;  // standard deviation of the floor's height a metre from the board, where it is largest
  std::vector<std::string> notes;  // what was corrected or is doubtful, one line each
};

// Throws IoError when the picture cannot be read, ConfigError when the board is not in it.
FloorPicture read_floor_picture(const FloorBoardOptions& options);

// Throws IoError when the picture is not of the camera's size, ConfigError when the board does not lie on a floor below
// a camera that is held upright.
FloorBoard find_floor(const FloorPicture& picture, const Camera& camera);

}  // namespace livecap
