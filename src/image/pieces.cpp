#include "image/pieces.h"

#include <algorithm>
#include <cstring>

namespace livecap {

Pieces::Pieces(const cv::Mat& mask, uint8_t value, bool diagonal) {
  size_t above_begin = 0;
  for (int y = 0; y < mask.rows; ++y) {
    const uint8_t* row = mask.ptr<uint8_t>(y);
    const size_t begin = runs_.size();
    const uint8_t other = value ? 0 : 255;
    const auto find = [&](int from, uint8_t wanted) {  // as fast as the C library's search for a byte
      const void* found = std::memchr(row + from, wanted, mask.cols - from);
      return found ? static_cast<int>(static_cast<const uint8_t*>(found) - row) : mask.cols;
    };
    for (int x = find(0, value); x < mask.cols;) {
      const int end = find(x, other);
      runs_.push_back({y, x, end, static_cast<int>(runs_.size())});
      x = end < mask.cols ? find(end, value) : end;
    }
    connect(above_begin, begin, diagonal);
    above_begin = begin;
  }
  // Roots come before the runs that point to them.
  for (size_t i = 0; i < runs_.size(); ++i) {
    Run& run = runs_[i];
    if (run.piece == static_cast<int>(i)) {
      run.piece = static_cast<int>(pieces_.size());
      pieces_.push_back({0, false, run.begin, run.y, run.end, run.y + 1});
    } else {
      run.piece = runs_[run.piece].piece;
    }
    Piece& piece = pieces_[run.piece];
    piece.area += run.end - run.begin;
    piece.x0 = std::min(piece.x0, run.begin);
    piece.x1 = std::max(piece.x1, run.end);
    piece.y1 = run.y + 1;  // runs come in the order of their rows
    piece.touches_border |= run.y == 0 || run.y == mask.rows - 1 || run.begin == 0 || run.end == mask.cols;
  }
}

int Pieces::root(int run) {
  while (runs_[run].piece != run) run = runs_[run].piece = runs_[runs_[run].piece].piece;
  return run;
}

// The runs of one row, [begin, end of the list), with those of the row above, [above_begin, begin).
void Pieces::connect(size_t above_begin, size_t begin, bool diagonal) {
  const int reach = diagonal ? 1 : 0;
  size_t above = above_begin;
  for (size_t i = begin; i < runs_.size(); ++i) {
    while (above < begin && runs_[above].end + reach <= runs_[i].begin) ++above;
    for (size_t a = above; a < begin && runs_[a].begin < runs_[i].end + reach; ++a) {
      const int one = root(static_cast<int>(a)), other = root(static_cast<int>(i));
      runs_[std::max(one, other)].piece = std::min(one, other);
    }
  }
}

std::vector<int> Pieces::areas_in(const cv::Mat& place) const {
  std::vector<int> areas(pieces_.size(), 0);
  for (const Run& run : runs_) {
    const uint8_t* row = place.ptr<uint8_t>(run.y);
    areas[run.piece] +=
        static_cast<int>(std::count_if(row + run.begin, row + run.end, [](uint8_t pixel) { return pixel != 0; }));
  }
  return areas;
}

void Pieces::paint(cv::Mat& mask, const std::vector<bool>& chosen, uint8_t value) const {
  for (const Run& run : runs_) {
    if (chosen[run.piece]) std::fill_n(mask.ptr<uint8_t>(run.y) + run.begin, run.end - run.begin, value);
  }
}

}  // namespace livecap
