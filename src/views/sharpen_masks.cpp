#include "views/sharpen_masks.h"

#include <algorithm>
#include <future>
#include <opencv2/core.hpp>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "image/mask_iou.h"

namespace livecap {

namespace {

constexpr double kInside = 0.01, kOutside = 0.015;  // of the person's height: how far a network's outlines are off
constexpr double kAround = 0.05;                    // of it: what of the picture tells the background's colours
constexpr int kFewest = 64;                         // px that tell the colours of either
constexpr int kRounds = 2;
constexpr double kStillThePerson = 0.75;  // IoU with the network's mask
constexpr int kSeed = 1;

}  // namespace

ImageGray sharpened_mask(const ImageRgb& picture, const ImageGray& mask) {
  const cv::Size size(mask.width, mask.height);
  const cv::Mat rgb(size, CV_8UC3, const_cast<uint8_t*>(picture.pixels.data()));
  const cv::Mat all = cv::Mat(size, CV_8UC1, const_cast<uint8_t*>(mask.pixels.data())) > 127;
  const cv::Rect box = cv::boundingRect(all);
  if (box.empty()) return mask;
  const double height = box.height;
  const int margin = std::max(2, static_cast<int>(kAround * height));
  const cv::Rect around =
      cv::Rect(box.x - margin, box.y - margin, box.width + 2 * margin, box.height + 2 * margin) & cv::Rect({}, size);
  const cv::Mat person = all(around);
  cv::Mat inside, outside;
  cv::distanceTransform(person, inside, cv::DIST_L2, cv::DIST_MASK_5);
  cv::distanceTransform(~person, outside, cv::DIST_L2, cv::DIST_MASK_5);
  cv::Mat cut(around.size(), CV_8UC1, cv::Scalar(cv::GC_PR_BGD));
  cut.setTo(cv::GC_PR_FGD, person);
  cut.setTo(cv::GC_FGD, inside > kInside * height);
  cut.setTo(cv::GC_BGD, outside > kOutside * height);
  if (cv::countNonZero(cut == cv::GC_FGD) < kFewest || cv::countNonZero(cut == cv::GC_BGD) < kFewest) return mask;
  cv::Mat background_colors, person_colors;
  cv::setRNGSeed(kSeed);  // of this thread; the colours' clusters begin at random
  cv::grabCut(rgb(around), cut, {}, background_colors, person_colors, kRounds, cv::GC_INIT_WITH_MASK);
  ImageGray sharpened{mask.width, mask.height, std::vector<uint8_t>(mask.pixels.size())};
  cv::Mat(size, CV_8UC1, sharpened.pixels.data())(around).setTo(255, (cut & 1) != 0);  // GC_FGD, GC_PR_FGD
  return mask_iou(sharpened, mask) < kStillThePerson ? mask : sharpened;
}

void sharpen_masks(std::vector<View>& views, const std::vector<size_t>& which,
                   const std::function<void(int done, int total)>& progress) {
  const size_t at_once = std::max(1u, std::thread::hardware_concurrency());
  for (size_t first = 0; first < which.size(); first += at_once) {
    const size_t last = std::min(which.size(), first + at_once);
    std::vector<std::future<ImageGray>> sharpened;
    for (size_t k = first; k < last; ++k)
      sharpened.push_back(std::async(std::launch::async, sharpened_mask, std::cref(views[which[k]].image),
                                     std::cref(views[which[k]].mask)));
    for (size_t k = first; k < last; ++k) views[which[k]].mask = sharpened[k - first].get();
    progress(static_cast<int>(last), static_cast<int>(which.size()));
  }
}

}  // namespace livecap
