// gather_board_views of calibrate.h.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <memory>

#include "base/luminance.h"
#include "base/median.h"
#include "base/text.h"
#include "calibrate/calibrate.h"
#include "image/image_io.h"
#include "image/video.h"
#include "livecap/error.h"

namespace livecap {

namespace {

using std::filesystem::path;

constexpr int kSamples = 6;               // pictures that are looked at to recognise the board
constexpr double kPerSecond = 4;          // frames of a video that are looked at
constexpr int kMostFrames = 240;          // of these at most
constexpr double kLeastDifference = .01;  // of two views, share of the picture's diagonal

struct Picture {
  std::string name;
  ImageGray image;
};

ImageGray gray_of(const ImageRgb& rgb) {
  ImageGray gray{rgb.width, rgb.height, std::vector<uint8_t>(size_t(rgb.width) * rgb.height)};
  for (size_t i = 0; i < gray.pixels.size(); ++i)
    gray.pixels[i] = static_cast<uint8_t>((kRedPerMille * rgb.pixels[3 * i] + kGreenPerMille * rgb.pixels[3 * i + 1] +
                                           kBluePerMille * rgb.pixels[3 * i + 2] + 500) /
                                          1000);
  return gray;
}

// The pictures of a folder or the frames of a video that are looked at, one after the other.
class Pictures {
 public:
  explicit Pictures(const std::string& source) : source_(source) {
    if (std::filesystem::is_directory(source)) {
      for (const auto& entry : std::filesystem::directory_iterator(source)) {
        std::string suffix = entry.path().extension().string();
        std::transform(suffix.begin(), suffix.end(), suffix.begin(), [](unsigned char c) { return std::tolower(c); });
        if (suffix == ".png" || suffix == ".jpg" || suffix == ".jpeg") files_.push_back(entry.path());
      }
      std::sort(files_.begin(), files_.end());
      if (files_.empty()) throw IoError(source + ": holds no .png or .jpg picture");
    } else {
      video_ = std::make_unique<VideoReader>(source);
      const VideoInfo info = video_->info();
      step_ = std::max(1, static_cast<int>(std::lround(info.fps / kPerSecond)));
      if (info.frame_count_hint > 0)
        step_ = std::max<int>(step_, static_cast<int>((info.frame_count_hint + kMostFrames - 1) / kMostFrames));
      hint_ = static_cast<int>(info.frame_count_hint / step_);
    }
  }

  int n_expected() const { return video_ ? std::max(hint_, 0) : static_cast<int>(files_.size()); }
  bool is_video() const { return video_ != nullptr; }

  // False at the end. Pictures that cannot be read are left out with a note.
  bool next(Picture& picture, std::vector<std::string>& notes) {
    if (!video_) {
      while (next_ < files_.size()) {
        const path& file = files_[next_++];
        try {
          picture = {file.filename().string(), read_image_gray(file)};
          return true;
        } catch (const IoError& error) {
          notes.push_back(std::string(error.what()) + "; left out");
        }
      }
      return false;
    }
    Frame frame;
    while (video_->read(frame)) {
      if (next_++ % step_ != 0 || frame.damaged) continue;
      picture = {format("frame %zu", next_ - 1), gray_of(frame.image)};
      return true;
    }
    return false;
  }

 private:
  std::string source_;
  std::vector<path> files_;
  std::unique_ptr<VideoReader> video_;
  size_t next_ = 0;
  int step_ = 1;
  int hint_ = 0;
};

// How much two views differ: the mean way of the corners they share, in px.
double difference(const BoardCorners& a, const BoardCorners& b) {
  double sum = 0;
  int n = 0;
  for (size_t i = 0; i < a.board.size(); ++i)
    for (size_t j = 0; j < b.board.size(); ++j)
      if ((a.board[i] - b.board[j]).squaredNorm() < 0.25) sum += (a.pixels[i] - b.pixels[j]).norm(), ++n;
  return n > 0 ? sum / n : std::numeric_limits<double>::infinity();
}

// An edge between black and white wider than this is blurred, px.
double widest_edge(int width, int height) {
  return std::max(5.0, 0.003 * std::max(width, height));
}

// Of the sharp views those farthest from all that were taken before, starting with the sharpest.
void keep_most_different(int max_views, double least_px, std::vector<BoardView>& views) {
  if (views.empty()) return;
  std::vector<double> nearest(views.size(), std::numeric_limits<double>::infinity());
  std::vector<char> kept(views.size(), 0);
  size_t next = 0;
  for (size_t i = 1; i < views.size(); ++i)
    if (views[i].corners.edge_px < views[next].corners.edge_px) next = i;
  for (int n = 0; n < max_views; ++n) {
    if (kept[next] || nearest[next] < least_px) break;
    kept[next] = 1;
    for (size_t i = 0; i < views.size(); ++i)
      nearest[i] = std::min(nearest[i], kept[i] ? 0 : difference(views[i].corners, views[next].corners));
    next = std::max_element(nearest.begin(), nearest.end()) - nearest.begin();
  }
  std::vector<BoardView> chosen;
  for (size_t i = 0; i < views.size(); ++i)
    if (kept[i]) chosen.push_back(std::move(views[i]));
  views = std::move(chosen);
}

}  // namespace

void CalibrateOptions::validate() const {
  board.validate();
  if (source.empty()) throw ConfigError("calibrate: --images or --video is needed");
  if (max_views < kMinBoardViews || max_views > 200)
    throw ConfigError(format("--max-views is %d; it must be within %d..200", max_views, kMinBoardViews));
}

BoardViews gather_board_views(const CalibrateOptions& options, const CalibrateProgress& progress) {
  options.validate();
  BoardViews result;
  BoardOptions board = options.board;
  Pictures pictures(options.source);
  const std::string what = pictures.is_video() ? "frames" : "pictures";

  std::vector<Picture> waiting;  // until the board is recognised
  std::string first_name;
  bool recognized = false;
  const auto look_at = [&](const Picture& picture) {
    BoardCorners corners = find_board(picture.image, board);
    if (!corners.empty()) result.views.push_back({picture.name, std::move(corners), 0, ""});
  };
  const auto recognize = [&] {
    std::vector<ImageGray> samples;
    for (const Picture& picture : waiting) samples.push_back(picture.image);
    std::string note;
    if (recognize_board(samples, board, note)) {
      recognized = true;
      if (!note.empty()) result.notes.push_back(note);
      for (const Picture& picture : waiting) look_at(picture);
    }
    waiting.clear();
  };
  Picture picture;
  while (pictures.next(picture, result.notes)) {
    if (result.n_pictures++ == 0) {
      result.width = picture.image.width, result.height = picture.image.height;
      first_name = picture.name;
    } else if (picture.image.width != result.width || picture.image.height != result.height) {
      const bool turned = picture.image.width == result.height && picture.image.height == result.width;
      throw ConfigError(options.source + format(": %s is %dx%d, %s is %dx%d; all must be of one camera %s",
                                                first_name.c_str(), result.width, result.height, picture.name.c_str(),
                                                picture.image.width, picture.image.height,
                                                turned ? "held one way" : "at one resolution"));
    }
    if (recognized) {
      look_at(picture);
    } else {
      waiting.push_back(std::move(picture));
      if (static_cast<int>(waiting.size()) == kSamples) recognize();
    }
    if (progress && !progress(result.n_pictures, std::max(pictures.n_expected(), result.n_pictures)))
      throw Error("interrupted");
  }
  if (!recognized && !waiting.empty()) recognize();
  if (result.n_pictures == 0) throw IoError(options.source + ": none of its " + what + " can be read");

  const char* counted = board.is_charuco() ? "squares" : "inner corners";
  if (result.views.empty())
    throw ConfigError(options.source + format(": no board with %dx%d %s in any of %d %s; it must be sharp, evenly lit, "
                                              "wholly in the picture and have a white rim",
                                              board.columns, board.rows, counted, result.n_pictures, what.c_str()));
  // Blurred ones.
  const double limit = widest_edge(result.width, result.height);
  std::vector<double> edges;
  for (const BoardView& view : result.views) edges.push_back(view.corners.edge_px);
  const size_t n_found = result.views.size();
  std::erase_if(result.views, [&](const BoardView& view) { return view.corners.edge_px > limit; });
  const size_t n_blurred = n_found - result.views.size();
  if (n_blurred > 0 && static_cast<int>(result.views.size()) < kMinBoardViews)
    throw ConfigError(
        options.source +
        format(": %zu of %zu views of the board are blurred (edges %.0f px wide, at most %.0f are usable); "
               "focus on the board, hold it still, give more light",
               n_blurred, n_found, median(edges), limit));
  if (n_blurred > 0) result.notes.push_back(format("%zu blurred %s left out", n_blurred, what.c_str()));
  const double least_px = kLeastDifference * std::hypot(result.width, result.height);
  keep_most_different(options.max_views, least_px, result.views);
  if (static_cast<int>(result.views.size()) < kMinBoardViews)
    throw ConfigError(
        options.source +
        format(": %zu different views of the board in %d %s (found in %zu); at least %d are needed, 15 to "
               "30 are good",
               result.views.size(), result.n_pictures, what.c_str(), n_found, kMinBoardViews));
  return result;
}

}  // namespace livecap
