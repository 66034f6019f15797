#include "calibrate/board.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "base/median.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap {

namespace {

constexpr int kSearchSide = 1400;  // px; larger pictures are searched reduced and refined at full size

struct Dictionary {
  const char* name;
  int id;
};
constexpr Dictionary kDictionaries[] = {
    {"4x4_50", cv::aruco::DICT_4X4_50},          {"4x4_100", cv::aruco::DICT_4X4_100},
    {"4x4_250", cv::aruco::DICT_4X4_250},        {"4x4_1000", cv::aruco::DICT_4X4_1000},
    {"5x5_50", cv::aruco::DICT_5X5_50},          {"5x5_100", cv::aruco::DICT_5X5_100},
    {"5x5_250", cv::aruco::DICT_5X5_250},        {"5x5_1000", cv::aruco::DICT_5X5_1000},
    {"6x6_50", cv::aruco::DICT_6X6_50},          {"6x6_100", cv::aruco::DICT_6X6_100},
    {"6x6_250", cv::aruco::DICT_6X6_250},        {"6x6_1000", cv::aruco::DICT_6X6_1000},
    {"7x7_50", cv::aruco::DICT_7X7_50},          {"7x7_100", cv::aruco::DICT_7X7_100},
    {"7x7_250", cv::aruco::DICT_7X7_250},        {"7x7_1000", cv::aruco::DICT_7X7_1000},
    {"original", cv::aruco::DICT_ARUCO_ORIGINAL}};

cv::Mat as_mat(const ImageGray& image) {
  return {image.height, image.width, CV_8UC1, const_cast<uint8_t*>(image.pixels.data())};
}

// The picture as corners are searched in it.
cv::Mat reduced(const cv::Mat& image) {
  const double share = static_cast<double>(kSearchSide) / std::max(image.cols, image.rows);
  if (share >= 1) return image;
  cv::Mat small;
  cv::resize(image, small, {}, share, share, cv::INTER_AREA);
  return small;
}

cv::Ptr<cv::aruco::Dictionary> dictionary_of(const std::string& name) {
  for (const Dictionary& known : kDictionaries)
    if (name == known.name) return cv::aruco::getPredefinedDictionary(known.id);
  throw LogicError("board: unknown dictionary " + name);
}

cv::Ptr<cv::aruco::CharucoBoard> charuco_board(const BoardOptions& options) {
  return cv::aruco::CharucoBoard::create(options.columns, options.rows, 1.0f, static_cast<float>(options.marker_share),
                                         dictionary_of(options.dictionary));
}

struct Markers {
  std::vector<std::vector<cv::Point2f>> corners;
  std::vector<int> ids;
};

Markers find_markers(const cv::Mat& image, const std::string& dictionary) {
  Markers markers;
  cv::aruco::detectMarkers(image, dictionary_of(dictionary), markers.corners, markers.ids);
  return markers;
}

// Grey value between pixels; false outside.
bool sample(const cv::Mat& image, const Eigen::Vector2d& p, double& value) {
  const int x = static_cast<int>(std::floor(p.x())), y = static_cast<int>(std::floor(p.y()));
  if (x < 0 || y < 0 || x + 1 >= image.cols || y + 1 >= image.rows) return false;
  const double fx = p.x() - x, fy = p.y() - y;
  const auto at = [&](int dx, int dy) { return static_cast<double>(image.at<uint8_t>(y + dy, x + dx)); };
  value = (1 - fy) * ((1 - fx) * at(0, 0) + fx * at(1, 0)) + fy * ((1 - fx) * at(0, 1) + fx * at(1, 1));
  return true;
}

// How many pixels the step from black to white takes across the edge from corner a to its neighbour b: the step over
// the steepest slope. 0 when it is not in the picture or there is no contrast.
double edge_width(const cv::Mat& image, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  const Eigen::Vector2d along = b - a, middle = 0.5 * (a + b);
  const double reach = 0.3 * along.norm(), spacing = 0.5;
  const Eigen::Vector2d across = Eigen::Vector2d(-along.y(), along.x()).normalized();
  double low = 255, high = 0, steepest = 0, before = 0;
  bool first = true;
  for (double s = -reach; s <= reach; s += spacing) {
    double value;
    if (!sample(image, middle + s * across, value)) return 0;
    if (!first) steepest = std::max(steepest, std::abs(value - before) / spacing);
    low = std::min(low, value), high = std::max(high, value);
    before = value, first = false;
  }
  return high - low > 20 && steepest > 0 ? (high - low) / steepest : 0;
}

double median_edge_width(const cv::Mat& image, const BoardCorners& corners) {
  std::map<std::pair<int, int>, int> at;
  const auto key = [&](size_t i) {
    return std::pair(static_cast<int>(std::lround(corners.board[i].x())),
                     static_cast<int>(std::lround(corners.board[i].y())));
  };
  for (size_t i = 0; i < corners.board.size(); ++i) at[key(i)] = static_cast<int>(i);
  std::vector<double> widths;
  for (size_t i = 0; i < corners.board.size(); ++i) {
    for (const auto& [dx, dy] : {std::pair{1, 0}, std::pair{0, 1}}) {
      const auto next = at.find({key(i).first + dx, key(i).second + dy});
      if (next == at.end()) continue;
      const double width = edge_width(image, corners.pixels[i], corners.pixels[next->second]);
      if (width > 0) widths.push_back(width);
    }
  }
  return median(widths);
}

// The shortest way between two neighbouring corners, px.
double shortest_side(const BoardCorners& corners) {
  double shortest = 1e9;
  for (size_t i = 0; i < corners.board.size(); ++i)
    for (size_t j = 0; j < i; ++j)
      if ((corners.board[i] - corners.board[j]).norm() < 1.2)
        shortest = std::min(shortest, (corners.pixels[i] - corners.pixels[j]).norm());
  return shortest;
}

void refine(const cv::Mat& image, BoardCorners& corners) {
  const int window = std::clamp(static_cast<int>(0.2 * shortest_side(corners)), 2, 15);
  std::vector<cv::Point2f> points;
  for (const auto& p : corners.pixels) points.emplace_back(static_cast<float>(p.x()), static_cast<float>(p.y()));
  cv::cornerSubPix(image, points, {window, window}, {-1, -1},
                   {cv::TermCriteria::COUNT + cv::TermCriteria::EPS, 40, 0.001});
  for (size_t i = 0; i < points.size(); ++i) corners.pixels[i] = {points[i].x, points[i].y};
}

BoardCorners find_chessboard(const cv::Mat& image, const BoardOptions& options) {
  const cv::Size size(options.columns, options.rows);
  std::vector<cv::Point2f> points;
  const bool found =
      cv::findChessboardCornersSB(image, size, points, cv::CALIB_CB_NORMALIZE_IMAGE) ||
      cv::findChessboardCorners(image, size, points,
                                cv::CALIB_CB_ADAPTIVE_THRESH | cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_FAST_CHECK);
  BoardCorners corners;
  if (!found || static_cast<int>(points.size()) != options.columns * options.rows) return corners;
  for (int i = 0; i < static_cast<int>(points.size()); ++i) {
    corners.pixels.emplace_back(points[i].x, points[i].y);
    corners.board.emplace_back(i % options.columns, i / options.columns);
  }
  return corners;
}

BoardCorners find_charuco(const cv::Mat& image, const BoardOptions& options) {
  const Markers markers = find_markers(image, options.dictionary);
  BoardCorners corners;
  if (markers.ids.empty()) return corners;
  const auto board = charuco_board(options);
  std::vector<cv::Point2f> points;
  std::vector<int> ids;
  cv::aruco::interpolateCornersCharuco(markers.corners, markers.ids, image, board, points, ids);
  for (size_t i = 0; i < ids.size(); ++i) {
    const cv::Point3f on_board = board->chessboardCorners[ids[i]];
    corners.pixels.emplace_back(points[i].x, points[i].y);
    corners.board.emplace_back(on_board.x, on_board.y);
  }
  return corners;
}

// Mean distance of the corners from the best plane perspective of the board, in squares.
double perspective_error(const BoardCorners& corners) {
  std::vector<cv::Point2f> from, to;
  for (size_t i = 0; i < corners.pixels.size(); ++i) {
    from.emplace_back(static_cast<float>(corners.pixels[i].x()), static_cast<float>(corners.pixels[i].y()));
    to.emplace_back(static_cast<float>(corners.board[i].x()), static_cast<float>(corners.board[i].y()));
  }
  const cv::Mat homography = cv::findHomography(from, to);
  if (homography.empty()) return 1e9;
  std::vector<cv::Point2f> moved;
  cv::perspectiveTransform(from, moved, homography);
  double sum = 0;
  for (size_t i = 0; i < to.size(); ++i) sum += cv::norm(moved[i] - to[i]);
  return sum / static_cast<double>(to.size());
}

// Enough corners, not on one line, that look like a plane board through some lens.
bool believable(const BoardCorners& corners) {
  if (corners.pixels.size() < 6) return false;
  Eigen::Vector2d low = corners.board[0], high = low;
  for (const auto& p : corners.board) low = low.cwiseMin(p), high = high.cwiseMax(p);
  return (high - low).minCoeff() > 0.5 && perspective_error(corners) < 0.25;
}

std::string size_name(int columns, int rows) {
  return format("%dx%d", columns, rows);
}

bool found_in_any(const std::vector<ImageGray>& samples, const BoardOptions& options) {
  return std::any_of(samples.begin(), samples.end(),
                     [&](const ImageGray& picture) { return !find_board(picture, options).empty(); });
}

// The number of inner corners most pictures agree on, unless what was said is found as well.
bool recognize_chessboard(const std::vector<ImageGray>& samples, BoardOptions& options) {
  std::map<std::pair<int, int>, int> votes;
  std::vector<ImageGray> with_board;
  for (const ImageGray& picture : samples) {
    if (with_board.size() == 3) break;
    std::vector<cv::Point2f> points;
    cv::Mat meta;
    if (!cv::findChessboardCornersSB(reduced(as_mat(picture)), {3, 3}, points,
                                     cv::CALIB_CB_NORMALIZE_IMAGE | cv::CALIB_CB_LARGER, meta) ||
        meta.empty())
      continue;
    with_board.push_back(picture);
    ++votes[{std::max(meta.cols, meta.rows), std::min(meta.cols, meta.rows)}];
  }
  const std::pair said(std::max(options.columns, options.rows), std::min(options.columns, options.rows));
  if (votes.count(said) > 0 || found_in_any(with_board.empty() ? samples : with_board, options)) return true;
  int most = 0;
  for (const auto& [size, count] : votes)
    if (count >= most) most = count, options.columns = size.first, options.rows = size.second;
  return most > 0 && found_in_any(with_board, options);  // the search for any size also sees boards in noise
}

// The layout and dictionary with the most corners that fit a plane.
bool recognize_charuco(const std::vector<ImageGray>& samples, BoardOptions& options) {
  BoardOptions best = options;
  size_t most = 0;
  const auto try_dictionary = [&](const std::string& name) {
    const int c = options.columns, r = options.rows;
    for (const auto& [columns, rows] :
         {std::pair{c, r}, std::pair{r, c}, std::pair{c + 1, r + 1}, std::pair{r + 1, c + 1}}) {
      BoardOptions candidate = options;
      candidate.dictionary = name, candidate.columns = columns, candidate.rows = rows;
      if (columns * rows / 2 > static_cast<int>(dictionary_of(name)->bytesList.rows)) continue;
      size_t count = 0;
      for (const ImageGray& picture : samples) {
        const BoardCorners corners = find_charuco(reduced(as_mat(picture)), candidate);
        if (believable(corners)) count += corners.pixels.size();
      }
      if (count > most) most = count, best = candidate;
    }
  };
  try_dictionary(options.dictionary);
  // Of each marker size the largest set holds the markers of the smaller ones.
  if (most == 0)
    for (const char* name : {"4x4_1000", "5x5_1000", "6x6_1000", "7x7_1000", "original"}) try_dictionary(name);
  options = best;
  return most > 0;
}

}  // namespace

const std::vector<std::string>& board_dictionaries() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Dictionary& known : kDictionaries) list.emplace_back(known.name);
    return list;
  }();
  return names;
}

void BoardOptions::validate() const {
  const char* what = is_charuco() ? "squares" : "inner corners";
  if (std::min(columns, rows) < 3 || std::max(columns, rows) > 60)
    throw ConfigError(format("board of %dx%d %s: each must be within 3..60", columns, rows, what));
  if (!is_charuco()) return;
  const auto& names = board_dictionaries();
  if (std::find(names.begin(), names.end(), dictionary) == names.end()) {
    std::string message = "--dictionary " + dictionary + ": there is no such dictionary; there are:";
    for (const auto& name : names) message += " " + name;
    throw ConfigError(message);
  }
  if (!(marker_share > 0.2 && marker_share < 1))
    throw ConfigError(
        format("--marker is %g; a marker's side is within 0.2..1 of its square's, mostly 0.7 to 0.8", marker_share));
  if (columns * rows / 2 > static_cast<int>(dictionary_of(dictionary)->bytesList.rows))
    throw ConfigError(format("--dictionary %s: a board of %dx%d squares has %d markers, it holds %d",
                             dictionary.c_str(), columns, rows, columns * rows / 2,
                             static_cast<int>(dictionary_of(dictionary)->bytesList.rows)));
}

BoardCorners find_board(const ImageGray& image, const BoardOptions& options) {
  const cv::Mat full = as_mat(image);
  const cv::Mat small = reduced(full);
  BoardCorners corners = options.is_charuco() ? find_charuco(small, options) : find_chessboard(small, options);
  if (!believable(corners)) return {};
  if (small.cols < full.cols) {
    const double sx = static_cast<double>(image.width) / small.cols,
                 sy = static_cast<double>(image.height) / small.rows;
    for (auto& p : corners.pixels) p = {(p.x() + 0.5) * sx - 0.5, (p.y() + 0.5) * sy - 0.5};
  }
  // The chessboard detector's own sub-pixel corners made the focal length of blurred boards 0.4 % too long.
  refine(full, corners);
  corners.edge_px = median_edge_width(full, corners);
  if (corners.edge_px == 0) return {};  // no contrast: corners seen in noise
  return corners;
}

bool recognize_board(const std::vector<ImageGray>& samples, BoardOptions& options, std::string& note) {
  const BoardOptions said = options;
  if (options.is_charuco()) {
    if (found_in_any(samples, options)) return true;
    if (!recognize_charuco(samples, options)) return false;
  } else if (!recognize_chessboard(samples, options)) {
    options = said;
    return false;
  }
  if (options.columns == said.columns && options.rows == said.rows && options.dictionary == said.dictionary)
    return true;
  const std::string found = size_name(options.columns, options.rows), was = size_name(said.columns, said.rows);
  const std::pair said_size(std::max(said.columns, said.rows), std::min(said.columns, said.rows));
  const std::pair size(std::max(options.columns, options.rows), std::min(options.columns, options.rows));
  const char* what = options.is_charuco() ? "squares" : "inner corners";
  if (options.dictionary != said.dictionary)
    note = "the markers are of dictionary " + options.dictionary + ", not " + said.dictionary + "; ";
  if (size == said_size) {
    if (options.columns != said.columns) note += "the board is " + found + ", not " + was + " (columns x rows); ";
  } else {
    note += "the board has " + found + " " + what + ", not " + was;
    if (!options.is_charuco() && size == std::pair(said_size.first - 1, said_size.second - 1))
      note += " (that is how many squares it has: count the corners where four squares meet)";
    if (options.is_charuco() && size == std::pair(said_size.first + 1, said_size.second + 1))
      note += " (that is how many inner corners it has)";
    note += "; ";
  }
  note += "going on with " + found;
  return true;
}

void read_board_size(const std::string& text, const std::string& option, int& columns, int& rows) {
  char rest = 0;
  if (std::sscanf(text.c_str(), "%dx%d%c", &columns, &rows, &rest) != 2)
    throw ConfigError(option + " " + text + ": must be COLUMNSxROWS, e.g. 9x6");
}

}  // namespace livecap
