#include "views/turn_tracks.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

namespace livecap {

namespace {

constexpr int kWindow = 17;  // px
constexpr int kLevels = 3;
constexpr double kQuality = 0.01;
constexpr int kLeastViews = 3;

struct Picture {
  std::vector<cv::Mat> pyramid;
  cv::Mat gray, inside;  // inside: well within the mask, where no outline slides over the background
};

Picture prepare(const View& view) {
  Picture picture;
  const int w = view.image.width, h = view.image.height;
  const cv::Mat rgb(h, w, CV_8UC3, const_cast<uint8_t*>(view.image.pixels.data()));
  cv::cvtColor(rgb, picture.gray, cv::COLOR_RGB2GRAY);
  cv::buildOpticalFlowPyramid(picture.gray, picture.pyramid, {kWindow, kWindow}, kLevels);
  if (view.mask.empty()) {  // the network saw nobody
    picture.inside = cv::Mat::zeros(h, w, CV_8UC1);
    return picture;
  }
  const cv::Mat mask(h, w, CV_8UC1, const_cast<uint8_t*>(view.mask.pixels.data()));
  const int margin = std::max(2, h / 200);
  cv::erode(mask > 127, picture.inside, cv::getStructuringElement(cv::MORPH_ELLIPSE, {2 * margin + 1, 2 * margin + 1}));
  return picture;
}

bool is_inside(const Picture& picture, const cv::Point2f& p) {
  const int x = cvRound(p.x), y = cvRound(p.y);
  return x >= 0 && y >= 0 && x < picture.inside.cols && y < picture.inside.rows && picture.inside.at<uchar>(y, x) > 0;
}

// Where `from` of one picture is in the next; kept[i] = 0 where it is lost.
std::vector<cv::Point2f> follow(const Picture& here, const Picture& there, const std::vector<cv::Point2f>& from,
                                double return_px, std::vector<char>& kept) {
  std::vector<cv::Point2f> to, back;
  std::vector<uchar> found, returned;
  std::vector<float> error;
  const cv::Size window(kWindow, kWindow);
  cv::calcOpticalFlowPyrLK(here.pyramid, there.pyramid, from, to, found, error, window, kLevels);
  cv::calcOpticalFlowPyrLK(there.pyramid, here.pyramid, to, back, returned, error, window, kLevels);
  kept.resize(from.size());
  for (size_t i = 0; i < from.size(); ++i)
    kept[i] = found[i] && returned[i] && cv::norm(back[i] - from[i]) < return_px && is_inside(there, to[i]);
  return to;
}

}  // namespace

std::vector<TurnObservation> track_turn(const std::vector<View>& views, bool closed, int first_point,
                                        const TurnTracksOptions& options) {
  std::vector<Picture> pictures;
  for (const View& view : views) pictures.push_back(prepare(view));
  const int n = static_cast<int>(views.size());
  std::vector<TurnObservation> observations;
  int next_point = first_point;
  for (int start = 0; start < n; ++start) {
    std::vector<cv::Point2f> at;
    const double apart = std::max(4.0, pictures[start].gray.rows / 120.0);
    cv::goodFeaturesToTrack(pictures[start].gray, at, options.per_view, kQuality, apart, pictures[start].inside);
    if (at.empty()) continue;
    std::vector<std::vector<TurnObservation>> tracks;
    for (const cv::Point2f& p : at) tracks.push_back({{start, 0, {p.x, p.y}, options.sigma_px}});
    std::vector<int> who(at.size());
    for (size_t i = 0; i < who.size(); ++i) who[i] = static_cast<int>(i);
    for (int step = 1; step < std::min(options.longest, n) && !at.empty(); ++step) {
      if (!closed && start + step >= n) break;
      const int view = (start + step) % n;
      std::vector<char> kept;
      const auto to = follow(pictures[(start + step - 1) % n], pictures[view], at, options.return_px, kept);
      std::vector<cv::Point2f> still;
      std::vector<int> still_who;
      for (size_t i = 0; i < to.size(); ++i) {
        if (!kept[i]) continue;
        tracks[who[i]].push_back({view, 0, {to[i].x, to[i].y}, options.sigma_px});
        still.push_back(to[i]);
        still_who.push_back(who[i]);
      }
      at = std::move(still);
      who = std::move(still_who);
    }
    for (auto& track : tracks) {
      if (static_cast<int>(track.size()) < kLeastViews) continue;
      for (TurnObservation& seen : track) {
        seen.point = next_point;
        observations.push_back(seen);
      }
      ++next_point;
    }
  }
  return observations;
}

}  // namespace livecap
