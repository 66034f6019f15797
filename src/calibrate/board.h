// A calibration board (chessboard or ChArUco) and its corners in a picture (paper, "Input Stream Processing": there
// with a Matlab toolbox). OpenCV finds the corners.
#pragma once

#include <Eigen/Core>
#include <string>
#include <vector>

#include "base/image_rgb.h"

namespace livecap {

struct BoardOptions {
  int columns = 9;             // inner corners; of a ChArUco board squares, as its maker counts them
  int rows = 6;                // the same
  std::string dictionary;      // empty: a plain chessboard; else that of the markers, see board_dictionaries()
  double marker_share = 0.75;  // ChArUco: side of a marker over that of a square

  bool is_charuco() const { return !dictionary.empty(); }
  void validate() const;  // throws ConfigError
};

// "4x4_50", ..., "7x7_1000", "original".
const std::vector<std::string>& board_dictionaries();

// Between a board's corners in a picture and where its pose has them, RMS: more is refused, more is doubted.
inline constexpr double kLargestRmsPx = 3, kDoubtfulRmsPx = 1;

struct BoardCorners {
  std::vector<Eigen::Vector2d> pixels;
  std::vector<Eigen::Vector2d> board;  // the same corners on the board, in squares
  double edge_px = 0;                  // median width of the edges between black and white: what blur makes large

  bool empty() const { return pixels.empty(); }
};

// Empty when the board is not found; a ChArUco board may be found in part.
BoardCorners find_board(const ImageGray& image, const BoardOptions& options);

// Looks at sample pictures for the board that is really there: counts that were swapped, squares counted instead of
// corners or the reverse, another dictionary. Corrects `options` and says so in `note`; false when nothing is found.
bool recognize_board(const std::vector<ImageGray>& samples, BoardOptions& options, std::string& note);

// "9x6" -> 9, 6. option: its name, for the message. Throws ConfigError.
void read_board_size(const std::string& text, const std::string& option, int& columns, int& rows);

}  // namespace livecap
