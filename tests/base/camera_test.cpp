// camera.json: what is written is read back, and what is wrong in it is named.
#include "livecap/camera.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <tuple>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

class File {
 public:
  ~File() { std::filesystem::remove(path_); }
  const std::filesystem::path& path() const { return path_; }
  std::string refusal() const {
    try {
      load_camera(path_);
      return "";
    } catch (const IoError& error) {
      return error.what();
    }
  }

 private:
  std::filesystem::path path_ =
      std::filesystem::temp_directory_path() / format("livecap_camera_test_%d.json", int(::getpid()));
};

Camera camera() {
  return {540, 960, 1010.5, 1009, 269.25, 479.5, {-0.2, 0.07, 0.001, -0.002, 0.01}};
}

TEST(Camera, IsReadAsItWasWritten) {
  const File file;
  for (const bool with_floor : {false, true}) {
    Camera written = camera();
    if (with_floor) written.floor = FloorPlane{{0.02, -std::sqrt(1 - 0.0404), -0.2}, 1234.5};
    save_camera(written, file.path());
    const Camera read = load_camera(file.path());
    EXPECT_EQ(
        std::tie(read.width, read.height, read.fx, read.fy, read.cx, read.cy, read.distortion),
        std::tie(written.width, written.height, written.fx, written.fy, written.cx, written.cy, written.distortion));
    ASSERT_EQ(read.floor.has_value(), with_floor);
    EXPECT_EQ(read_file(file.path()).find("floor") != std::string::npos, with_floor);
    if (!with_floor) continue;
    EXPECT_EQ(read.floor->normal, written.floor->normal);
    EXPECT_EQ(read.floor->distance_mm, written.floor->distance_mm);
  }
}

// Focal lengths in mm, in shares of the picture, or of another picture than the principal point.
TEST(Camera, IntrinsicsInOtherUnitsAreRefused) {
  const auto refused = [](double fx, double fy, double cx, double cy, const std::string& what) {
    Camera wrong{540, 960, fx, fy, cx, cy, {}};
    try {
      wrong.validate();
      ADD_FAILURE() << fx << " " << cx << " is accepted";
    } catch (const ConfigError& error) {
      EXPECT_NE(std::string(error.what()).find(what), std::string::npos) << error.what();
    }
  };
  refused(1.87, 1.05, 0.5, 0.5, "to a side of its axis, more than 85");
  refused(35, 35, 269.5, 479.5, "pixels of that picture");
  refused(1010, 1009, 269.5, 26950, "cy 26950");
  refused(1e6, 1e6, 269.5, 479.5, "degrees wide, less than 0.1");
  refused(1e308, 1009, 269.5, 479.5, "fx 1e+308, fy 1009: one is more than 2.2 times the other");
  refused(1010, 450, 269.5, 479.5, "more than 2.2 times");
  refused(1010, 2300, 269.5, 479.5, "more than 2.2 times");
  EXPECT_NO_THROW((Camera{540, 960, 1000, 2020, 269.5, 479.5, {}}.validate()));  // anamorphic
  Camera cut_out{540, 960, 4000, 4000, -3500, 1200, {}};                         // of a larger picture
  EXPECT_NO_THROW(cut_out.validate());
}

// Of pixels, of another model or in another order.
TEST(Camera, DistortionThatNoLensHasIsRefused) {
  const auto message = [](const std::array<double, 5>& distortion) {
    const Camera wrong{540, 960, 1010, 1009, 269.5, 479.5, distortion};
    try {
      wrong.validate();
    } catch (const ConfigError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  // The corner is 0.545 focal lengths from the axis: with k1 alone the fold is at sqrt(1 / (3 * 2)) = 0.408 of them.
  EXPECT_EQ(message({-2, 0, 0, 0, 0}),
            "camera: distortion k1 -2, k2 0, p1 0, p2 0, k3 0 folds the picture 75 % of the way to its corner; of "
            "OpenCV's lens model for this picture, without unit, in the order k1, k2, p1, p2, k3");
  EXPECT_NE(message({-1e300, 0, 0, 0, 0}).find("folds"), std::string::npos);
  EXPECT_NE(message({1e308, -1e308, 0, 0, 1e308}).find("distortion"), std::string::npos);
  EXPECT_NE(message({0, 0, 0, 0, -30}).find("folds"), std::string::npos);
  // With k1 alone an action camera's turns back in the last of its corners, where no board was seen.
  EXPECT_NO_THROW((Camera{1920, 1080, 860, 860, 959.5, 539.5, {-0.214, 0, 0, 0, 0}}.validate()));
  EXPECT_NE(message({100, 0, 0, 0, 0}).find("times its distance from the axis, more than 4"), std::string::npos);
  EXPECT_NE(message({0, 0, 5, 0, 0}).find("times its distance"), std::string::npos);
  // Of an action camera, of a telephoto lens, and one that turns back outside of the picture only.
  EXPECT_EQ(message({-0.27, 0.11, 0.0003, -0.0002, -0.02}), "");
  EXPECT_EQ(message({0.12, -0.4, 0, 0, 0.9}), "");
  EXPECT_EQ(message({-1, 0, 0, 0, 0}), "");
}

TEST(Camera, BothEndsOfTheRangeAreFieldsOfView) {
  for (const double fov_deg : {1.0, 170.0}) EXPECT_GT(camera_from_fov(640, 480, fov_deg).fx, 0);
  for (const double fov_deg : {0.9, 170.1}) EXPECT_THROW(camera_from_fov(640, 480, fov_deg), ConfigError);
}

TEST(Camera, FloorsThatCannotBeAreNamed) {
  const File file;
  const auto refusal = [&](const std::string& floor) {
    write_file_atomically(
        file.path(), R"({"width":540,"height":960,"fx":1010,"fy":1010,"cx":269.5,"cy":479.5,"floor":)" + floor + "}");
    return file.refusal();
  };
  EXPECT_EQ(refusal(R"({"normal":[0,-0.96,-0.28],"distance_mm":1500})"), "");
  EXPECT_EQ(refusal(R"({"normal":[1,0,0],"distance_mm":1500})"), "") << "a camera on its side";
  EXPECT_EQ(refusal(R"({"normal":[0,0,-1],"distance_mm":2500})"), "") << "a camera under the ceiling";
  for (const auto& [floor, named] :
       {std::pair{"1200", "field \"floor\" must be"}, std::pair{"null", "field \"floor\" must be"},
        std::pair{R"({"normal":[0,-1,0]})", "distance_mm"}, std::pair{R"({"distance_mm":1200})", "normal"},
        std::pair{R"({"normal":[0,-1],"distance_mm":1200})", "[x, y, z]"},
        std::pair{R"({"normal":[0,"up",0],"distance_mm":1200})", "[x, y, z]"},
        std::pair{R"({"normal":[0,-1,0],"distance_mm":"1200"})", "number"},
        std::pair{R"({"normal":[0,-2,0],"distance_mm":1200})", "length 2"},
        std::pair{R"({"normal":[0,0,0],"distance_mm":1200})", "length 0"},
        std::pair{R"({"normal":[0,0.96,0.28],"distance_mm":1500})", "points down"},
        std::pair{R"({"normal":[0,-1,0],"distance_mm":-1200})", "distance_mm is -1200"},
        std::pair{R"({"normal":[0,-1,0],"distance_mm":0})", "distance_mm is 0"},
        std::pair{R"({"normal":[0,-1,0],"distance_mm":1.2})", "in mm"},
        std::pair{R"({"normal":[0,-1,0],"distance_mm":1e999})", ""}}) {
    const std::string message = refusal(floor);
    EXPECT_EQ(message.find(file.path().string()), 0u) << floor << ": " << message;
    EXPECT_NE(message.find(named), std::string::npos) << floor << ": " << message;
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

}  // namespace
}  // namespace livecap
