#include "calibrate/calibrate.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "calibrate/rendered_board.h"
#include "image/image_io.h"
#include "image/video.h"
#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using test::BoardCamera;
using test::BoardPaint;

// A folder of its own that goes away.
class Calibrate : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ =
        std::filesystem::temp_directory_path() / ("livecap_calibrate_" + std::to_string(::getpid()) + "_" +
                                                  ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  static Camera lens() {
    Camera camera{640, 480, 702.5, 698.0, 331.0, 228.5, {-0.21, 0.07, 0.0012, -0.0008, 0}};
    return camera;
  }

  static const BoardCamera& camera() {
    static const BoardCamera camera(lens());
    return camera;
  }

  std::string file(int i) const { return (folder_ / ("view" + std::to_string(100 + i) + ".png")).string(); }

  // n views of a board of columns x rows squares.
  void take(int n, const BoardPaint& paint, int columns, int rows, double tilt_deg = 38, double blur_px = 0.6) {
    for (int i = 0; i < n; ++i)
      write_png(camera().take(paint, test::board_pose(lens(), columns / 2.0, rows / 2.0, i, tilt_deg, 5), blur_px, 1.5,
                              100 + i),
                file(i));
  }

  CalibrateOptions chessboard(int columns, int rows) const {
    CalibrateOptions options;
    options.source = folder_.string();
    options.board.columns = columns, options.board.rows = rows;
    return options;
  }

  static void expect_lens(const Calibration& result) {
    const Camera truth = lens();
    EXPECT_NEAR(result.camera.fx / truth.fx, 1, test::kFocalShare);
    EXPECT_NEAR(result.camera.fy / truth.fy, 1, test::kFocalShare);
    EXPECT_NEAR(result.camera.cx, truth.cx, test::kPrincipalPointPx);
    EXPECT_NEAR(result.camera.cy, truth.cy, test::kPrincipalPointPx);
    EXPECT_LT(result.rms_px, test::kBoardRmsPx);
    // The lens as a whole: where a ray near the corner of the picture falls.
    const auto bent = [](const Camera& c, double x, double y) {
      const auto& [k1, k2, p1, p2, k3] = c.distortion;
      const double r2 = x * x + y * y, radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
      return Eigen::Vector2d(c.fx * (x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x)) + c.cx,
                             c.fy * (y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y) + c.cy);
    };
    for (const double sx : {-1.0, 1.0})
      for (const double sy : {-1.0, 1.0})
        EXPECT_LT((bent(result.camera, 0.38 * sx, 0.28 * sy) - bent(truth, 0.38 * sx, 0.28 * sy)).norm(),
                  test::kPrincipalPointPx);
  }

  // What the refusal says.
  static std::string refusal(const CalibrateOptions& options) {
    try {
      calibrate(gather_board_views(options));
    } catch (const ConfigError& error) {
      return error.what();
    } catch (const IoError& error) {
      return error.what();
    }
    return "no refusal";
  }

  std::filesystem::path folder_;
};

bool says(const std::vector<std::string>& notes, const std::string& text) {
  return std::any_of(notes.begin(), notes.end(),
                     [&](const std::string& note) { return note.find(text) != std::string::npos; });
}

TEST_F(Calibrate, FindsTheLensFromAChessboard) {
  take(16, test::chessboard_paint(10, 7), 10, 7);
  const Calibration result = calibrate(gather_board_views(chessboard(9, 6)));
  EXPECT_GE(result.n_used, 14);
  expect_lens(result);
  EXPECT_LT(result.focal_sigma, test::kFocalShare);
  for (double tilt : result.tilts_deg) EXPECT_GT(tilt, 15);
}

TEST_F(Calibrate, FindsTheLensFromACharucoBoard) {
  take(16, test::charuco_paint(8, 6, 0.75, cv::aruco::DICT_4X4_50), 8, 6);
  CalibrateOptions options = chessboard(8, 6);
  options.board.dictionary = "4x4_50";
  const Calibration result = calibrate(gather_board_views(options));
  EXPECT_GE(result.n_used, 14);
  expect_lens(result);
}

TEST_F(Calibrate, CorrectsTheCountOfCorners) {
  take(2, test::chessboard_paint(8, 6), 8, 6);  // 7x5 inner corners
  const std::vector<ImageGray> samples = {read_image_gray(file(0)), read_image_gray(file(1))};
  BoardOptions board{8, 6, "", 0.75};
  std::string note;
  ASSERT_TRUE(recognize_board(samples, board, note));
  EXPECT_EQ(std::pair(board.columns, board.rows), std::pair(7, 5));
  EXPECT_NE(note.find("7x5 inner corners, not 8x6 (that is how many squares"), std::string::npos) << note;

  board.columns = 5, board.rows = 7, note.clear();  // swapped: a chessboard does not care
  ASSERT_TRUE(recognize_board(samples, board, note));
  EXPECT_TRUE(note.empty()) << note;
  EXPECT_EQ(find_board(samples[0], board).pixels.size(), 35u);
}

TEST_F(Calibrate, CorrectsASwappedCharucoBoardAndItsDictionary) {
  take(7, test::charuco_paint(8, 5, 0.75, cv::aruco::DICT_4X4_50), 8, 5);
  CalibrateOptions options = chessboard(5, 8);
  options.board.dictionary = "5x5_100";
  const BoardViews views = gather_board_views(options);
  EXPECT_EQ(views.views.size(), 7u);
  EXPECT_TRUE(says(views.notes, "dictionary 4x4_1000, not 5x5_100; the board is 8x5, not 5x8"));
}

TEST_F(Calibrate, TakesDifferentSharpFramesOfAVideo) {
  const BoardPaint paint = test::chessboard_paint(8, 6);
  VideoWriter video((folder_ / "board.mp4").string(), 640, 480, 4);
  const auto write = [&](const ImageGray& gray) {
    ImageRgb rgb{640, 480, {}};
    for (uint8_t value : gray.pixels) rgb.pixels.insert(rgb.pixels.end(), 3, value);
    video.write(rgb);
  };
  for (int i = 0; i < 12; ++i) {
    const Eigen::Isometry3d pose = test::board_pose(lens(), 4, 3, i, 38, 5);
    const ImageGray sharp = camera().take(paint, pose, 0.6, 1.5, i);
    write(sharp);
    if (i % 2 == 0) write(sharp);                                  // held still
    if (i % 3 == 0) write(camera().take(paint, pose, 4, 1.5, i));  // moved
  }
  video.close();
  CalibrateOptions options = chessboard(7, 5);
  options.source = (folder_ / "board.mp4").string();
  const BoardViews views = gather_board_views(options);
  EXPECT_EQ(views.n_pictures, 22);
  EXPECT_GE(views.views.size(), 11u);
  EXPECT_LE(views.views.size(), 12u);
  expect_lens(calibrate(views));
}

TEST_F(Calibrate, LeavesOutAViewThatDoesNotFit) {
  take(10, test::chessboard_paint(8, 6), 8, 6);
  BoardViews views = gather_board_views(chessboard(7, 5));
  for (size_t i = 0; i < views.views[3].corners.pixels.size(); ++i)  // as a bent board would
    views.views[3].corners.pixels[i].x() += 3 * std::sin(0.7 * views.views[3].corners.board[i].x());
  const Calibration result = calibrate(views);
  EXPECT_EQ(result.n_used, 9);
  EXPECT_FALSE(result.views[3].left_out.empty());
  expect_lens(result);
}

TEST_F(Calibrate, SaysWhatIsMissing) {
  take(10, test::chessboard_paint(8, 6), 8, 6);
  BoardViews views = gather_board_views(chessboard(7, 5));
  // All views in the left half, which no camera with a centre elsewhere would see so: only the notes matter.
  for (BoardView& view : views.views)
    for (auto& p : view.corners.pixels) p = {0.5 * p.x(), 120 + 0.5 * p.y()};
  Calibration result;
  ASSERT_NO_THROW(result = calibrate(views));
  EXPECT_TRUE(says(result.notes, "upper right"));
  EXPECT_TRUE(says(result.notes, "lower right"));
  EXPECT_EQ(result.coverage[2], 0);
}

TEST_F(Calibrate, RefusesBadSets) {
  const BoardPaint paint = test::chessboard_paint(8, 6);
  EXPECT_NE(refusal(chessboard(7, 5)).find("holds no .png or .jpg"), std::string::npos);

  take(4, paint, 8, 6);
  EXPECT_NE(refusal(chessboard(7, 5)).find("4 different views"), std::string::npos) << refusal(chessboard(7, 5));

  ImageGray small{320, 240, std::vector<uint8_t>(320 * 240, 90)};
  write_png(small, file(50));
  EXPECT_NE(refusal(chessboard(7, 5)).find("view150.png is 320x240"), std::string::npos);
  std::filesystem::remove(file(50));

  take(8, paint, 8, 6, 2);
  EXPECT_NE(refusal(chessboard(7, 5)).find("parallel"), std::string::npos) << refusal(chessboard(7, 5));

  take(8, paint, 8, 6, 38, 4.5);
  EXPECT_NE(refusal(chessboard(7, 5)).find("blurred"), std::string::npos) << refusal(chessboard(7, 5));

  take(
      8, [](double, double) { return 0.5; }, 8, 6);
  EXPECT_NE(refusal(chessboard(7, 5)).find("no board with 7x5 inner corners"), std::string::npos)
      << refusal(chessboard(7, 5));

  CalibrateOptions options = chessboard(9, 6);
  options.board.dictionary = "9x9";
  EXPECT_NE(refusal(options).find("there is no such dictionary"), std::string::npos);
}

}  // namespace
}  // namespace livecap
