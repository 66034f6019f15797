#include "views/turn_masks.h"

#include <algorithm>
#include <array>
#include <functional>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "image/foreground.h"
#include "image/mask_iou.h"
#include "views/foot_masks.h"

namespace livecap {

namespace {

constexpr double kNetworkMargin = 0.02;  // of the person's height: how far a network's masks are off
constexpr double kMargin = 0.005;        // and those of a first round
constexpr int kSomewhatPerson = 25;      // of 255
constexpr size_t kLeastSamples = 3, kMostSamples = 15;
constexpr double kBrightness = 0.8;   // of a place's samples, from dark to bright: the others may be in the shadow
constexpr double kFillPx = 6;         // what nobody saw so near to what somebody saw looks the same
constexpr int kMaskRounds = 3;        // the network's, then from colours, then with floor where there was shadow
constexpr double kSamePerson = 0.85;  // IoU with the network's masks, in the mean

// How far each pixel is from where the person may be, px, at most 255; 0 there, and everywhere if the mask is empty.
ImageGray distance_to_person(const ImageGray& mask, double margin) {
  ImageGray near = mask;
  for (uint8_t& pixel : near.pixels) pixel = pixel > kSomewhatPerson ? 255 : 0;
  const PixelBox box = bounding_box(near);
  if (box.empty()) return near;
  grow_by_disc(near, std::max(2, static_cast<int>(margin * box.height())));
  cv::Mat person(near.height, near.width, CV_8UC1, near.pixels.data()), distance;
  cv::distanceTransform(person == 0, distance, cv::DIST_L2, cv::DIST_MASK_3);
  distance.convertTo(person, CV_8U);  // in place of the mask
  return near;
}

// Unknown places take the colour of the nearest known one; those within kFillPx of it become known.
void fill_unknown(TurnBackground& background) {
  std::vector<uint8_t>& known = background.known.pixels;
  const cv::Mat unknown = cv::Mat(background.known.height, background.known.width, CV_8UC1, known.data()) == 0;
  cv::Mat_<float> distance;
  cv::Mat_<int> nearest;  // a number for each known pixel
  cv::distanceTransform(unknown, distance, nearest, cv::DIST_L2, cv::DIST_MASK_5, cv::DIST_LABEL_PIXEL);
  std::vector<size_t> pixel_of(known.size() + 1);
  for (size_t p = 0; p < known.size(); ++p)
    if (known[p] != 0) pixel_of[nearest.begin()[static_cast<int>(p)]] = p;
  for (size_t p = 0; p < known.size(); ++p) {
    if (known[p] != 0) continue;
    const size_t from = pixel_of[nearest.begin()[static_cast<int>(p)]];
    std::copy_n(&background.plate.pixels[3 * from], 3, &background.plate.pixels[3 * p]);
    if (distance.begin()[static_cast<int>(p)] <= kFillPx) known[p] = 255;
  }
}

}  // namespace

TurnBackground find_background(const std::vector<View>& views, const std::vector<ImageGray>& masks, double margin) {
  const int width = views.front().image.width, height = views.front().image.height;
  const size_t n = size_t(width) * height;
  std::vector<ImageGray> distance;
  for (const ImageGray& mask : masks) distance.push_back(distance_to_person(mask, margin));
  TurnBackground background{{width, height, std::vector<uint8_t>(3 * n)}, {width, height, std::vector<uint8_t>(n)}};
  std::vector<std::pair<uint8_t, size_t>> empty;  // views, by how far the person is
  for (size_t p = 0; p < n; ++p) {
    empty.clear();
    for (size_t i = 0; i < views.size(); ++i)
      if (!distance[i].empty() && distance[i].pixels[p] > 0) empty.emplace_back(distance[i].pixels[p], i);
    if (empty.size() < kLeastSamples) continue;
    background.known.pixels[p] = 255;
    const size_t n_samples = std::min(empty.size(), kMostSamples);
    std::nth_element(empty.begin(), empty.begin() + (n_samples - 1), empty.end(), std::greater<>());
    for (int c = 0; c < 3; ++c) {
      std::array<uint8_t, kMostSamples> samples;
      for (size_t k = 0; k < n_samples; ++k) samples[k] = views[empty[k].second].image.pixels[3 * p + c];
      const auto chosen = samples.begin() + static_cast<int>(kBrightness * static_cast<double>(n_samples));
      std::nth_element(samples.begin(), chosen, samples.begin() + n_samples);
      background.plate.pixels[3 * p + c] = *chosen;
    }
  }
  fill_unknown(background);
  return background;
}

bool mask_by_background(ocl::DeviceContext& device, std::vector<View>& views) {
  const int width = views.front().image.width, height = views.front().image.height;
  std::vector<ImageGray> masks;
  std::vector<size_t> seen;  // views that show somebody
  for (const View& view : views) {
    if (!bounding_box(view.mask).empty()) seen.push_back(masks.size());
    masks.push_back(view.mask);
  }
  DeviceFrame frame(device, width, height);
  for (int round = 0; round < kMaskRounds; ++round) {
    const bool first = round == 0;
    const TurnBackground background = find_background(views, masks, first ? kNetworkMargin : kMargin);
    BackgroundModel model;
    model.train(background.plate);
    ForegroundSegmenter segmenter(device, model, width, height);
    for (size_t i : seen) {
      const ImageGray& network = views[i].mask;
      segmenter.segment(views[i].image, PersonMask{width, height, network.pixels}, frame, masks[i]);
      // What nobody ever saw is inside of the person; with the wide margin of the first round also beside them.
      for (size_t p = 0; p < network.pixels.size(); ++p)
        if (background.known.pixels[p] == 0) masks[i].pixels[p] = !first || network.pixels[p] > 127 ? 255 : 0;
    }
    if (first) continue;
    cv::parallel_for_({0, static_cast<int>(seen.size())}, [&](const cv::Range& range) {
      for (int k = range.start; k < range.end; ++k)
        cut_feet_from_shadows(background.plate, background.known, views[seen[k]].image, masks[seen[k]]);
    });
  }
  double agreement = 0;
  for (size_t i : seen) agreement += mask_iou(masks[i], views[i].mask);
  if (!(agreement > kSamePerson * static_cast<double>(seen.size()))) return false;
  for (size_t i = 0; i < views.size(); ++i) views[i].mask = std::move(masks[i]);
  return true;
}

}  // namespace livecap
