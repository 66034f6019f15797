#include "image/foreground_pieces.h"

#include <algorithm>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>

#include "image/pieces.h"

namespace livecap {
namespace {

// A stranger's share beyond the gate, of what is looked at, is at least this.
constexpr double kShareBeyond = 0.1;
// Of the area that cells tell.
constexpr double kSureShare = 0.5;
// A piece that touches less than this many pixels is noise whatever the largest one is.
constexpr int kMinPiecePx = 16;

template <typename Pixels>
cv::Mat part(Pixels& pixels, int width, int height, const PixelBox& box) {
  return cv::Mat(height, width, CV_8UC1,
                 const_cast<uint8_t*>(pixels.data()))(cv::Rect(box.x0, box.y0, box.width(), box.height()));
}

cv::Mat disc(int radius) {
  return cv::getStructuringElement(cv::MORPH_ELLIPSE, cv::Size(2 * radius + 1, 2 * radius + 1));
}

// 255 where the network says person.
cv::Mat known_person(const StrangerSearch& search) {
  cv::Mat known;
  cv::threshold(part(search.network.probability, search.network.width, search.network.height, search.box), known,
                kHalfProbability - 1, 255, cv::THRESH_BINARY);
  return known;
}

int least_area(const StrangerSearch& search, const cv::Mat& known) {
  return static_cast<int>(search.least_share * static_cast<float>(cv::countNonZero(known)));
}

}  // namespace

bool may_be_strangers(const StrangerSearch& search, int n_beyond) {
  return n_beyond > 0 && n_beyond > kShareBeyond * least_area(search, known_person(search));
}

bool few_beyond(const ImageGray& cells, float least_share, int n_beyond) {
  int64_t known = 0, least = 0;  // cells; pixels / 16 that cells of 4 x 4 pixels cannot have less of
  for (int y = 0; y < cells.height; ++y) {
    const uint8_t* row = &cells.pixels[size_t(y) * cells.width];
    for (int x = 0; x < cells.width; ++x) {
      known += row[x] >= kHalfProbability;
      // The others have at most kHalfProbability - 1 each. Cells at the border may be smaller.
      if (row[x] >= kHalfProbability && x + 1 < cells.width && y + 1 < cells.height) least += 2 * row[x] - 255;
    }
  }
  const double known_px = kSureShare * kGateCell * kGateCell * static_cast<double>(known);
  const int least_area = static_cast<int>(least_share * static_cast<float>(least / 16));
  return n_beyond <= std::max(kShareBeyond * least_share * known_px, kShareBeyond * least_area);
}

void drop_strangers(const StrangerSearch& search, const uint8_t* beyond, int stride, ImageGray& mask) {
  const PixelBox& box = search.box;
  cv::Mat known = known_person(search);
  const int least = least_area(search, known);
  cv::dilate(known, known, disc(search.seam_px));
  cv::Mat person = part(mask.pixels, mask.width, mask.height, box);
  const cv::Mat differs(box.height(), box.width(), CV_8UC1, const_cast<uint8_t*>(beyond) + box.x0, stride);
  const cv::Mat others = (person | differs) & ~known;
  const Pieces pieces(others, 255, true);
  std::vector<bool> stranger;
  const std::vector<int> areas_beyond = pieces.areas_in(differs);
  for (size_t i = 0; i < areas_beyond.size(); ++i)
    stranger.push_back(pieces.all()[i].area > least && areas_beyond[i] > kShareBeyond * pieces.all()[i].area);
  pieces.paint(person, stranger, 0);
}

ForegroundResult clean_mask(const PixelBox& box, float min_part, float max_hole, ImageGray& mask) {
  cv::Mat person = part(mask.pixels, mask.width, mask.height, box);
  const Pieces parts(person, 255, true);
  int largest = 0;
  for (const Piece& piece : parts.all()) largest = std::max(largest, piece.area);
  const int smallest = std::max(kMinPiecePx, static_cast<int>(min_part * static_cast<float>(largest)));
  std::vector<bool> drop;
  ForegroundResult result;
  PixelBox around{box.width(), box.height(), 0, 0};
  for (const Piece& piece : parts.all()) {
    drop.push_back(piece.area < smallest);
    if (drop.back()) continue;
    result.area_px += piece.area;
    around = {std::min(around.x0, piece.x0), std::min(around.y0, piece.y0), std::max(around.x1, piece.x1),
              std::max(around.y1, piece.y1)};
  }
  parts.paint(person, drop, 0);
  if (result.area_px == 0) return result;
  result.box = {box.x0 + around.x0, box.y0 + around.y0, box.x0 + around.x1, box.y0 + around.y1};

  const Pieces gaps(person, 0, false);
  std::vector<bool> close;
  const float largest_hole = max_hole * static_cast<float>(result.area_px);
  for (const Piece& gap : gaps.all()) {
    close.push_back(!gap.touches_border && static_cast<float>(gap.area) < largest_hole);
    if (close.back()) result.area_px += gap.area;
  }
  gaps.paint(person, close, 255);
  return result;
}

}  // namespace livecap
