// Connected pieces of a mask, as runs of pixels within rows: a person has a few thousand runs and some 100,000 pixels.
#pragma once

#include <opencv2/core/mat.hpp>
#include <vector>

namespace livecap {

struct Piece {
  int area = 0;  // px
  bool touches_border = false;
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // the smallest box [x0, x1) x [y0, y1) around it
};

class Pieces {
 public:
  // mask: 8-bit, 0 or 255. Pieces of the pixels that equal `value`; with `diagonal` also over corners (8 neighbours).
  Pieces(const cv::Mat& mask, uint8_t value, bool diagonal);

  const std::vector<Piece>& all() const { return pieces_; }

  // How many pixels of each piece lie where `place`, of the mask's size, is not 0; index as in all().
  std::vector<int> areas_in(const cv::Mat& place) const;

  // Sets the pixels of the chosen pieces (index as in all()) to value.
  void paint(cv::Mat& mask, const std::vector<bool>& chosen, uint8_t value) const;

 private:
  struct Run {
    int y, begin, end;  // pixels [begin, end)
    int piece;          // index; while connecting an earlier run of the same piece, or this one
  };
  int root(int run);
  void connect(size_t above_begin, size_t begin, bool diagonal);

  std::vector<Run> runs_;
  std::vector<Piece> pieces_;
};

}  // namespace livecap
