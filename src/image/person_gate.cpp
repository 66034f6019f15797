#include "image/person_gate.h"

#include <algorithm>
#include <cmath>

#include "image/foreground.h"

namespace livecap {
namespace {

constexpr int kHalf = 128;

// Cells for which cell >= least.
ImageGray at_least(const ImageGray& cells, double least) {
  ImageGray result = cells;
  for (uint8_t& cell : result.pixels) cell = cell >= least ? 255 : 0;
  return result;
}

// How far away the nearest cell that covers is in its row, for each cell; more than `radius` where that is further. Of
// cells 1, 2, 4, ... further on at a time, many beside each other: not each from the one before.
void steps_in_row(const uint8_t* row, int width, int radius, bool covering, uint8_t* steps) {
  constexpr uint8_t kFar = 255;
  std::vector<uint8_t> before(width);
  for (int x = 0; x < width; ++x) steps[x] = (row[x] != 0) == covering ? 0 : kFar;
  const auto nearer = [](uint8_t here, uint8_t there, uint8_t apart) {
    const auto further = static_cast<uint8_t>(there > kFar - apart ? kFar : there + apart);
    return std::min(here, further);
  };
  for (int apart = 1; apart <= radius && apart < width; apart *= 2) {
    std::copy(steps, steps + width, before.begin());
    for (int x = apart; x < width; ++x) steps[x] = nearer(steps[x], before[x - apart], uint8_t(apart));
    std::copy(steps, steps + width, before.begin());
    for (int x = 0; x < width - apart; ++x) steps[x] = nearer(steps[x], before[x + apart], uint8_t(apart));
  }
}

// The disc row by row: within `radius` of a cell's row a row reaches so many cells to both sides. A cell is covered
// when the nearest one is within reach in any row. At most 254 cells.
void cover_by_disc(ImageGray& mask, int radius, bool covering) {
  const int width = mask.width, height = mask.height;
  std::vector<uint8_t> steps(mask.pixels.size());
  for (int y = 0; y < height; ++y)
    steps_in_row(&mask.pixels[size_t(y) * width], width, radius, covering, &steps[size_t(y) * width]);
  const uint8_t paint = covering ? 255 : 0;
  std::vector<uint8_t> reach(radius + 1);  // OpenCV's rounding
  for (int d = 0; d <= radius; ++d)
    reach[d] =
        static_cast<uint8_t>(std::lrint(radius * std::sqrt(double(radius * radius - d * d) / (radius * radius))));
  for (int y = 0; y < height; ++y) {
    uint8_t* row = &mask.pixels[size_t(y) * width];
    for (int v = std::max(0, y - radius); v <= std::min(height - 1, y + radius); ++v) {
      const uint8_t* away = &steps[size_t(v) * width];
      const uint8_t limit = reach[std::abs(v - y)];
      for (int x = 0; x < width; ++x) row[x] = away[x] <= limit ? paint : row[x];
    }
  }
}

}  // namespace

PixelBox grown(const PixelBox& box, int margin, int width, int height) {
  return {std::max(0, box.x0 - margin), std::max(0, box.y0 - margin), std::min(width, box.x1 + margin),
          std::min(height, box.y1 + margin)};
}

PixelBox bounding_box(const ImageGray& mask) {
  PixelBox box{mask.width, mask.height, 0, 0};
  for (int y = 0; y < mask.height; ++y) {
    const auto begin = mask.pixels.begin() + ptrdiff_t(y) * mask.width, end = begin + mask.width;
    const auto is_set = [](uint8_t pixel) { return pixel != 0; };
    const auto first = std::find_if(begin, end, is_set);
    if (first == end) continue;
    const auto last = std::find_if(std::make_reverse_iterator(end), std::make_reverse_iterator(first), is_set);
    box.x0 = std::min(box.x0, static_cast<int>(first - begin));
    box.x1 = std::max(box.x1, static_cast<int>(last.base() - begin));
    box.y0 = std::min(box.y0, y);
    box.y1 = y + 1;
  }
  return box.empty() ? PixelBox{} : box;
}

void grow_by_disc(ImageGray& mask, int radius) {
  if (radius > 0) cover_by_disc(mask, std::min(radius, 254), true);
}

void shrink_by_disc(ImageGray& mask, int radius) {
  if (radius > 0) cover_by_disc(mask, std::min(radius, 254), false);
}

PersonGate find_person_gate(const ImageGray& cells, int width, int height, const ForegroundOptions& options) {
  PersonGate result;
  result.gate = at_least(cells, kHalf);
  const PixelBox person = bounding_box(result.gate);
  if (person.empty()) return result;
  const auto radius = [&](float margin) {
    return std::max(1, static_cast<int>(std::lround(margin * static_cast<float>(person.height()))));
  };
  const int gate_radius = radius(options.gate_margin);
  const auto height_px = static_cast<float>(kGateCell * person.height());
  result.seam_px = std::max(2, static_cast<int>(std::lround(options.seam * height_px)));
  const int reach = std::max(kGateCell, static_cast<int>(std::lround(options.stranger_reach * height_px)));
  grow_by_disc(result.gate, gate_radius);
  result.core = at_least(cells, std::floor(255 * options.core_probability) + 1);
  shrink_by_disc(result.core, radius(options.core_margin));
  result.search = grown({person.x0 * kGateCell, person.y0 * kGateCell, person.x1 * kGateCell, person.y1 * kGateCell},
                        gate_radius * kGateCell + reach, width, height);
  return result;
}

}  // namespace livecap
