#include "image/distance_field.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace livecap {
namespace {

constexpr int16_t kNone = 32000;  // no pixel of the other kind in this column
constexpr float kHalfPixel = 0.5f;

// [rows*cols] distance along the column to the nearest pixel of the other kind, px.
std::vector<int16_t> column_distances(const cv::Mat& inside) {
  const int width = inside.cols;
  std::vector<int16_t> distance(size_t(width) * inside.rows, kNone);
  const auto follow = [&](int y, int from_y) {
    const uint8_t* kind = inside.ptr<uint8_t>(y);
    const uint8_t* from_kind = inside.ptr<uint8_t>(from_y);
    int16_t* __restrict d = &distance[size_t(y) * width];
    const int16_t* from = &distance[size_t(from_y) * width];
    for (int x = 0; x < width; ++x) {
      const int16_t further = std::min<int16_t>(from[x] + 1, kNone);
      const int16_t next = (kind[x] != 0) == (from_kind[x] != 0) ? further : int16_t(1);
      d[x] = std::min(d[x], next);
    }
  };
  for (int y = 1; y < inside.rows; ++y) follow(y, y - 1);
  for (int y = inside.rows - 2; y >= 0; --y) follow(y, y + 1);
  return distance;
}

// The columns whose nearest pixel of the other kind is the nearest of all somewhere in the run: the lower envelope of
// the parabolas (x - column)^2 + height.
class Envelope {
 public:
  explicit Envelope(int width) : sites_(width + 2) {}

  void clear() { n_ = 0; }

  // Columns in rising order.
  void add(int column, int height, int begin, int end) {
    while (n_ > 0 && value(sites_[n_ - 1], sites_[n_ - 1].from) > squared(sites_[n_ - 1].from - column) + height) --n_;
    int from = begin;
    if (n_ > 0) {
      const Site& top = sites_[n_ - 1];
      // Right of this the new one is lower; not negative, since it is not lower where the top one begins.
      const double meet =
          double(column * column - top.column * top.column + height - top.height) / (2.0 * (column - top.column));
      if (meet >= end) return;
      from = static_cast<int>(meet) + 1;
    }
    if (from < end) sites_[n_++] = {column, height, from};
  }

  // squares: [end] squared distances of the run that ends at `end`.
  void write(int end, int* squares) const {
    for (int i = 0; i < n_; ++i) {
      const Site site = sites_[i];
      const int stop = i + 1 < n_ ? sites_[i + 1].from : end;
      for (int x = site.from; x < stop; ++x) squares[x] = value(site, x);
    }
  }

 private:
  struct Site {
    int column, height;
    int from;  // first pixel it is the nearest of
  };
  static int squared(int x) { return x * x; }
  static int value(const Site& site, int x) { return squared(x - site.column) + site.height; }

  std::vector<Site> sites_;
  int n_ = 0;
};

}  // namespace

void signed_distance(const cv::Mat& inside, cv::Mat& distance) {
  const int width = inside.cols;
  const std::vector<int16_t> columns = column_distances(inside);
  std::vector<int> squares(width);
  Envelope envelope(width);
  for (int y = 0; y < inside.rows; ++y) {
    const uint8_t* kind = inside.ptr<uint8_t>(y);
    const int16_t* column = &columns[size_t(y) * width];
    for (int begin = 0, end; begin < width; begin = end) {
      for (end = begin + 1; end < width && (kind[end] != 0) == (kind[begin] != 0);) ++end;
      envelope.clear();
      if (begin > 0) envelope.add(begin - 1, 0, begin, end);
      for (int x = begin; x < end; ++x) {
        if (column[x] < kNone) envelope.add(x, column[x] * column[x], begin, end);
      }
      if (end < width) envelope.add(end, 0, begin, end);
      envelope.write(end, squares.data());
    }
    float* out = distance.ptr<float>(y);
    for (int x = 0; x < width; ++x) {
      const float from_contour = std::sqrt(static_cast<float>(squares[x])) - kHalfPixel;
      out[x] = kind[x] ? -from_contour : from_contour;
    }
  }
}

}  // namespace livecap
