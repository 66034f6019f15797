#include "image/self_test.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "image/device_distance.h"
#include "image/foreground.h"

namespace livecap {
namespace {

// A bright square person of 20x20 pixels in front of a grey wall.
constexpr int kWidth = 70, kHeight = 61, kFrom = 21, kTo = 41, kBelow = 2;

bool in_person(int x, int y) {
  return x >= kFrom && x < kTo && y >= kFrom && y < kTo;
}

ocl::SelfTestResult counted(const char* kernel, long expected, long found) {
  return {kernel, expected == found, expected == found ? "" : format("expected %ld, found %ld", expected, found)};
}

}  // namespace

std::vector<ocl::SelfTestResult> image_self_test(ocl::DeviceContext& device) {
  ImageRgb plate{kWidth, kHeight, std::vector<uint8_t>(size_t(3) * kWidth * kHeight, 100)};
  ImageRgb picture = plate;
  PersonMask network{kWidth, kHeight, std::vector<uint8_t>(size_t(kWidth) * kHeight, 0)};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (!in_person(x, y)) continue;
      std::fill_n(&picture.pixels[3 * (y * kWidth + x)], 3, uint8_t{220});
      network.probability[y * kWidth + x] = 200;
    }
  }
  BackgroundModel background;
  background.train(plate);
  ForegroundSegmenter with_plate(device, background, kWidth, kHeight);
  ForegroundSegmenter without_plate(device, BackgroundModel(), kWidth, kHeight);
  DeviceFrame frame(device, kWidth, kHeight);
  ImageGray mask;
  std::vector<ocl::SelfTestResult> results;
  // Smoothing takes off the four corners.
  constexpr long kArea = (kTo - kFrom) * (kTo - kFrom);
  const ForegroundResult found = with_plate.segment(picture, network, frame, mask);
  results.push_back(counted("coarse_means, foreground_score, score_border, smooth_rows, decide, trim_border", kArea - 4,
                            found.area_px));
  // What lies below it is as dark as a shadow may be, and none of the network's. Its last column is beyond the gate,
  // and smoothing takes off two corners.
  ImageRgb shaded = picture;
  for (int y = kTo; y < kTo + kBelow; ++y)
    std::fill_n(&shaded.pixels[3 * (y * kWidth + kFrom)], 3 * (kTo - kFrom), uint8_t{40});
  const long all = with_plate.segment(shaded, network, frame, mask).area_px;
  const auto undoubted = with_plate.find_sure(mask);
  results.push_back(
      counted("foreground_score: in doubt", kBelow * (kTo - 1 - kFrom) - 2, undoubted ? all - undoubted->area_px : 0));
  // The same mask as a crop of half the size, its pixels in the middle of 2 x 2.
  CropMask crop{
      {35, 35, std::vector<uint8_t>(size_t(35) * 35, 200)}, {0.5, 0, -0.25, 0, 0.5, -0.25}, {kFrom, kFrom, kTo, kTo}};
  results.push_back(counted("lay_mask", kArea - 4, without_plate.segment(picture, crop, frame, mask).area_px));
  results.push_back(counted("network_score", kArea - 4, without_plate.segment(picture, network, frame, mask).area_px));

  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) mask.pixels[y * kWidth + x] = in_person(x, y) ? 255 : 0;
  }
  frame.mask.write(mask.pixels);
  DeviceDistanceField field(device, kWidth, kHeight);
  field.compute(frame.mask, {kFrom, kFrom, kTo, kTo}, kArea, frame.signed_distance);
  const std::vector<float> distance = frame.signed_distance.read_all();
  const auto at = [&](int x, int y) { return std::lround(1000 * distance[y * kWidth + x]); };
  results.push_back(counted("column_steps or column_squares, row_distances: inside", -9500, at(30, 30)));
  results.push_back(counted("row_distances: outside", 4500, at(kFrom - 3, kFrom - 4)));  // 3, 4, 5
  results.push_back(counted("extend_distances", std::lround(1000 * (std::hypot(29.0, 1.0) - 0.5)), at(69, 41)));

  // The left half of the person is sure.
  ocl::Buffer<float> sure(device, distance);
  constexpr int kMiddle = (kFrom + kTo) / 2;
  for (int y = kFrom; y < kTo; ++y) std::fill_n(&mask.pixels[y * kWidth + kMiddle], kTo - kMiddle, uint8_t{0});
  frame.mask.write(mask.pixels);
  field.compute(frame.mask, {kFrom, kFrom, kMiddle, kTo}, kArea / 2, sure);
  field.leave_open(sure, frame.signed_distance);
  const std::vector<float> open = frame.signed_distance.read_all();
  const auto open_at = [&](int x) { return std::lround(1000 * open[30 * kWidth + x]); };
  results.push_back(counted("leave_open: inside", -500, open_at(kMiddle - 1)));
  results.push_back(counted("leave_open: between", 0, open_at(kMiddle + 1)));
  results.push_back(counted("leave_open: outside", 500, open_at(kTo)));
  return results;
}

}  // namespace livecap
