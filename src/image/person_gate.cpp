#include "image/person_gate.h"

#include <algorithm>
#include <cmath>

#include "image/foreground.h"

namespace livecap {
namespace {

// Cells for which cell >= least.
ImageGray at_least(const ImageGray& cells, double least) {
  ImageGray result = cells;
  for (uint8_t& cell : result.pixels) cell = cell >= least ? 255 : 0;
  return result;
}

struct Run {
  int begin, end;
};

// The disc row by row: within `radius` of a cell's row a row reaches so many cells to both sides. What rows around a
// row cover of it begins and ends at known places: a sum along the row says where anything does.
void cover_by_disc(ImageGray& mask, int radius, bool covering) {
  const int width = mask.width, height = mask.height;
  std::vector<Run> runs;  // of cells that cover, row by row
  std::vector<int> first_of{0};
  for (int y = 0; y < height; ++y) {
    const uint8_t* row = &mask.pixels[size_t(y) * width];
    for (int x = 0; x < width; ++x) {
      if ((row[x] != 0) != covering) continue;
      const int begin = x;
      while (x < width && (row[x] != 0) == covering) ++x;
      runs.push_back({begin, x});
    }
    first_of.push_back(static_cast<int>(runs.size()));
  }
  const uint8_t paint = covering ? 255 : 0;
  std::vector<int> reach(radius + 1);  // OpenCV's rounding
  for (int d = 0; d <= radius; ++d)
    reach[d] = static_cast<int>(std::lrint(radius * std::sqrt(double(radius * radius - d * d) / (radius * radius))));
  std::vector<int> changes(width + 1);  // by how much the number of covering runs grows here
  for (int y = 0; y < height; ++y) {
    const uint8_t* from = &mask.pixels[size_t(y) * width];
    if (!covering && std::none_of(from, from + width, [](uint8_t cell) { return cell != 0; })) continue;
    std::fill(changes.begin(), changes.end(), 0);
    int first = width, last = 0;
    for (int v = std::max(0, y - radius); v <= std::min(height - 1, y + radius); ++v) {
      const int far = reach[std::abs(v - y)];
      for (int i = first_of[v]; i < first_of[v + 1]; ++i) {
        const int begin = std::max(0, runs[i].begin - far), end = std::min(width, runs[i].end + far);
        ++changes[begin];
        --changes[end];
        first = std::min(first, begin);
        last = std::max(last, end);
      }
    }
    uint8_t* row = &mask.pixels[size_t(y) * width];
    int n_covering = 0;
    for (int x = first; x < last; ++x) {
      n_covering += changes[x];
      if (n_covering > 0) row[x] = paint;
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
  if (radius > 0) cover_by_disc(mask, radius, true);
}

void shrink_by_disc(ImageGray& mask, int radius) {
  if (radius > 0) cover_by_disc(mask, radius, false);
}

PersonGate find_person_gate(const ImageGray& cells, int width, int height, const ForegroundOptions& options) {
  PersonGate result;
  result.gate = at_least(cells, kHalfProbability);
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
