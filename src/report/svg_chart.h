// Curves over the frames of a video as inline SVG, without scripts: hovering shows a frame's values.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace livecap {

struct ChartSeries {
  std::string name;
  std::string color;           // CSS
  std::vector<double> values;  // one per frame; NaN: a gap
};

struct Chart {
  std::string title;
  std::string unit;             // of the values, " mm"
  int digits = 1;               // of the values
  std::vector<int64_t> frames;  // rising
  std::vector<ChartSeries> series;
  std::vector<bool> tracked;  // [n_frames] false: the frame is shaded; empty: all are
  double bar = 0;             // drawn when has_bar: what the mean is held to
  bool has_bar = false;
  bool from_zero = true;  // the axis begins at 0; otherwise where the values do
  double at_most = 0;     // > 0: the axis ends here at the latest
};

// Steps of 1, 2 or 5 times a power of ten, so that `span` has about `n` of them. 1 when span is not positive.
double nice_step(double span, int n);

// "" when no series has a value. Throws LogicError when lists differ in length.
std::string svg_chart(const Chart& chart);

}  // namespace livecap
