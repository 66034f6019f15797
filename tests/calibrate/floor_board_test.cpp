// The floor from rendered pictures of a board that lies on it: the picture is made by cutting rays with the plane, so
// that the truth owes nothing to the pose that is solved for.
#include "calibrate/floor_board.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <Eigen/Geometry>
#include <filesystem>

#include "calibrate/rendered_board.h"
#include "image/image_io.h"
#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

constexpr double kSquareMm = 60;
constexpr int kColumns = 9, kRows = 6;  // inner corners

Camera lens() {
  return {960, 720, 1052.5, 1048.0, 491.0, 348.5, {-0.21, 0.07, 0.0012, -0.0008, 0}};
}

const test::BoardCamera& camera() {
  static const test::BoardCamera camera(lens());
  return camera;
}

// A camera at this height that looks down and is rolled: its up vector.
Eigen::Vector3d up_of(double down_deg, double roll_deg) {
  const double down = down_deg * M_PI / 180, roll = roll_deg * M_PI / 180;
  return {std::cos(down) * std::sin(roll), -std::cos(down) * std::cos(roll), -std::sin(down)};
}

// A board whose normal is n, its middle at a point, turned about its normal. In squares, as BoardCamera takes it.
Eigen::Isometry3d lying(const Eigen::Vector3d& n, const Eigen::Vector3d& middle_mm, double turn) {
  const Eigen::Vector3d x = Eigen::AngleAxisd(turn, n) * (Eigen::Vector3d::UnitX() - n.x() * n).normalized();
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear().col(0) = x;
  pose.linear().col(1) = n.cross(x);
  pose.linear().col(2) = n;
  pose.translation() = middle_mm / kSquareMm;
  return pose;
}

// Where the ray through a pixel (of a camera without distortion) meets the floor.
Eigen::Vector3d on_floor(const Eigen::Vector3d& up, double height_mm, double u, double v) {
  const Camera c = lens();
  const Eigen::Vector3d ray((u - c.cx) / c.fx, (v - c.cy) / c.fy, 1);
  return ray * (-height_mm / up.dot(ray));
}

class FloorBoardPicture {
 public:
  ~FloorBoardPicture() { std::filesystem::remove(path_); }

  FloorBoardOptions take(const test::BoardPaint& paint, const Eigen::Isometry3d& pose, unsigned seed = 1) const {
    write_png(camera().take(paint, pose, 0.6, 1.5, seed), path_);
    FloorBoardOptions options;
    options.picture = path_.string();
    options.board.columns = kColumns, options.board.rows = kRows;
    options.square_mm = kSquareMm;
    return options;
  }

 private:
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / ("livecap_floor_" + std::to_string(::getpid()) + ".png");
};

FloorBoard floor_of(const FloorBoardOptions& options) {
  return find_floor(read_floor_picture(options), lens());
}

std::string refusal(const FloorBoardOptions& options, const Camera& camera) {
  try {
    find_floor(read_floor_picture(options), camera);
  } catch (const Error& error) {
    return error.what();
  }
  return "no refusal";
}

// How far the found plane is from the true one a metre around the board, and what was said of it.
void expect_floor(const FloorBoard& found, const Eigen::Vector3d& up, double height_mm,
                  const Eigen::Vector3d& middle_mm) {
  const auto& [x, y, z] = found.floor.normal;
  const Eigen::Vector3d normal(x, y, z);
  EXPECT_NEAR(normal.norm(), 1, 1e-9);
  const Eigen::Vector3d side = up.unitOrthogonal();
  double most = 0;
  for (int i = 0; i < 8; ++i) {
    const Eigen::Vector3d p = middle_mm + 1000 * (Eigen::AngleAxisd(M_PI * i / 4, up) * side);
    ASSERT_NEAR(up.dot(p) + height_mm, 0, 1e-6);
    most = std::max(most, std::abs(normal.dot(p) + found.floor.distance_mm));
  }
  ::testing::Test::RecordProperty("floor_mm", std::to_string(most));
  ::testing::Test::RecordProperty("sigma_mm", std::to_string(found.sigma_mm));
  EXPECT_LT(most, test::kFloorBoardMm);
  EXPECT_LT(most, 4 * found.sigma_mm) << "surer of itself than it should be";
  EXPECT_LT(found.rms_px, test::kBoardRmsPx);
  EXPECT_NEAR(found.away_mm, middle_mm.norm(), test::kFloorBoardMm);
}

TEST(FloorBoard, TellsThePlane) {
  const FloorBoardPicture picture;
  int i = 0;
  for (const auto& [down_deg, roll_deg, height_mm, turn] :
       {std::tuple{25.0, 1.5, 1400.0, 0.3}, {40.0, -3.0, 2000.0, 1.2}, {18.0, 0.0, 900.0, -0.8}}) {
    const Eigen::Vector3d up = up_of(down_deg, roll_deg), middle = on_floor(up, height_mm, 470, 500);
    const FloorBoard found =
        floor_of(picture.take(test::chessboard_paint(kColumns + 1, kRows + 1), lying(up, middle, turn), ++i));
    expect_floor(found, up, height_mm, middle);
    EXPECT_NEAR(found.tilt.down_deg, down_deg, test::kFloorBoardDeg);
    EXPECT_NEAR(found.tilt.roll_deg, roll_deg, test::kFloorBoardDeg);
    EXPECT_TRUE(found.notes.empty()) << found.notes[0];
  }
}

TEST(FloorBoard, TellsThePlaneOfACharucoBoard) {
  const FloorBoardPicture picture;
  const Eigen::Vector3d up = up_of(35, 2), middle = on_floor(up, 1200, 500, 420);
  // OpenCV draws it with y down, as its back shows it to who looks at the plane's other side.
  Eigen::Isometry3d pose = lying(up, middle, 0.2);
  pose.linear().col(1) *= -1, pose.linear().col(2) *= -1;
  FloorBoardOptions options = picture.take(test::charuco_paint(8, 6, 0.75, cv::aruco::DICT_4X4_50), pose);
  options.board.columns = 8, options.board.rows = 6, options.board.dictionary = "4x4_50";
  expect_floor(floor_of(options), up, 1200, middle);
}

TEST(FloorBoard, TheSquareIsTheScale) {
  const FloorBoardPicture picture;
  const Eigen::Vector3d up = up_of(25, 0), middle = on_floor(up, 1400, 470, 500);
  FloorBoardOptions options = picture.take(test::chessboard_paint(kColumns + 1, kRows + 1), lying(up, middle, 0.3));
  options.square_mm = kSquareMm / 2;
  EXPECT_NEAR(floor_of(options).floor.distance_mm, 700, test::kFloorBoardMm);
  options.square_mm = kSquareMm / 1000;  // metres
  EXPECT_NE(refusal(options, lens()).find("side of a square in mm"), std::string::npos) << refusal(options, lens());
}

TEST(FloorBoard, RefusesWhatIsNoFloor) {
  const FloorBoardPicture picture;
  const test::BoardPaint paint = test::chessboard_paint(kColumns + 1, kRows + 1);
  const auto refused = [&](const test::BoardPaint& seen, const Eigen::Isometry3d& pose, const std::string& word) {
    const std::string message = refusal(picture.take(seen, pose), lens());
    EXPECT_NE(message.find(word), std::string::npos) << message;
    EXPECT_NE(message.find(".png: "), std::string::npos) << message;
  };
  // On a wall, and under the ceiling.
  refused(paint, lying(up_of(80, 0), {0, 0, 1500}, 0.1), "seems to stand");
  const Eigen::Vector3d down(0.02, 0.9, -0.43);
  refused(paint, lying(down.normalized(), {0, -300, 1500}, 0.1), "hang above");
  refused(paint, lying(up_of(25, 0), {0, 9000, 20000}, 0.1), "no board with 9x6 inner corners");

  const Eigen::Vector3d up = up_of(25, 0);
  FloorBoardOptions options = picture.take(paint, lying(up, on_floor(up, 1400, 470, 500), 0.3));
  Camera other = lens();
  other.width = 640;
  EXPECT_NE(refusal(options, other).find("the picture is 960x720, the camera is for 640x720"), std::string::npos);
  const test::BoardPaint bent = [&](double x, double y) { return paint(x + 0.35 * std::sin(0.9 * y), y); };
  refused(bent, lying(up, on_floor(up, 700, 470, 450), 0.3), "px off; is the board flat");
  options.square_mm = 0;
  EXPECT_NE(refusal(options, lens()).find("--square"), std::string::npos);
  options.square_mm = 60;
  options.picture = "/nowhere.png";
  EXPECT_NE(refusal(options, lens()).find("/nowhere.png"), std::string::npos);
}

// Far away and small, the board tells its own height but hardly the floor's tilt.
TEST(FloorBoard, IsLessSureOfAFarBoard) {
  const FloorBoardPicture picture;
  const Eigen::Vector3d up = up_of(40, 0), middle = on_floor(up, 2400, 480, 330);
  const test::BoardPaint paint = test::chessboard_paint(kColumns + 1, kRows + 1);
  const FloorBoard near = floor_of(picture.take(paint, lying(up, on_floor(up, 1200, 480, 330), 0.3)));
  const FloorBoard far = floor_of(picture.take(paint, lying(up, middle, 0.3)));
  EXPECT_GT(far.sigma_mm, 2 * near.sigma_mm);
}

}  // namespace
}  // namespace livecap
