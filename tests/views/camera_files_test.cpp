#include "views/camera_files.h"

#include <gtest/gtest.h>

#include "base/text.h"
#include "livecap/error.h"
#include "support/comma_locale.h"
#include "support/refusal.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

class CameraFiles : public testing::Test {
 protected:
  CameraFiles() : folder_(std::filesystem::path(testing::TempDir()) / "camera_files_test") {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  ~CameraFiles() override { std::filesystem::remove_all(folder_); }

  void write(const char* name, const std::string& text) { write_file_atomically(folder_ / name, text); }
  // The message of the IoError that reading `path` throws.
  std::string failure(const std::filesystem::path& path) {
    try {
      read_view_poses(path);
    } catch (const IoError& error) {
      return error.what();
    }
    return "no error";
  }

  std::filesystem::path folder_;
};

constexpr char kCameras[] =
    "# comment\n1 PINHOLE 640 480 500 510 320 240\n7 OPENCV 640 480 500 510 320 240 0.1 0.02 0.003 0.004\n";

TEST_F(CameraFiles, ColmapGivesPixelsPosesAndDistortion) {
  write("cameras.txt", kCameras);
  // A quarter turn about y: w = z = cos 45.
  write("images.txt",
        "# IMAGE_ID ...\n2 0.70710678 0 0.70710678 0 1 2 3 7 b side.jpg\n1 2 3 4\n1 1 0 0 0 0 0 5 1 a.png\n\n");
  const std::vector<ViewPose> views = read_view_poses(folder_);
  ASSERT_EQ(views.size(), 2u);
  EXPECT_EQ(views[0].picture, "a.png");
  EXPECT_EQ(views[1].picture, "b side.jpg");
  EXPECT_DOUBLE_EQ(views[0].camera.cx, 319.5);  // COLMAP counts pixel centres from a half
  EXPECT_DOUBLE_EQ(views[0].camera.cy, 239.5);
  EXPECT_DOUBLE_EQ(views[1].camera.distortion[3], 0.004);
  // World x goes to camera -z under a quarter turn about y.
  const Eigen::Vector3d p = views[1].camera_from_world * Eigen::Vector3d(1, 0, 0);
  EXPECT_NEAR((p - Eigen::Vector3d(1, 2, 2)).norm(), 0, test::kPoseDigits);
}

TEST_F(CameraFiles, NumbersHaveAPointInEveryLocale) {
  write("cameras.txt", kCameras);
  write("images.txt", "1 1 0 0 0 0.5 0 5.25 7 a.png\n\n");
  const test::CommaLocale commas;  // of streams in any case
  const std::vector<ViewPose> views = read_view_poses(folder_);
  EXPECT_EQ(views.at(0).camera_from_world.translation(), Eigen::Vector3d(0.5, 0, 5.25));
  EXPECT_EQ(views[0].camera.distortion[1], 0.02);
}

TEST_F(CameraFiles, ColmapFaultsNameFileAndLine) {
  EXPECT_NE(failure(folder_).find("cameras.txt and images.txt"), std::string::npos);
  write("cameras.txt", "1 FISHEYE 640 480 500 320 240 0\n");
  write("images.txt", "1 1 0 0 0 0 0 5 1 a.png\n\n");
  EXPECT_NE(failure(folder_).find("line 1: camera model FISHEYE"), std::string::npos) << failure(folder_);
  write("cameras.txt", "1 PINHOLE 640 480 500\n");
  EXPECT_NE(failure(folder_).find("PINHOLE has 1 parameters, needs 4"), std::string::npos) << failure(folder_);
  write("cameras.txt", kCameras);
  write("images.txt", "1 1 0 0 0 0 0 5 3 a.png\n\n");
  EXPECT_NE(failure(folder_).find("camera 3 is not in cameras.txt"), std::string::npos) << failure(folder_);
  write("images.txt", "1 1 0 0 0 zero\n\n");
  EXPECT_NE(failure(folder_).find("line 1 is not IMAGE_ID"), std::string::npos) << failure(folder_);
  write("images.txt", "1 0 0 0 0 0 0 5 1 a.png\n\n");
  EXPECT_NE(failure(folder_).find("quaternion"), std::string::npos) << failure(folder_);
  write("images.txt", "# nothing\n");
  EXPECT_NE(failure(folder_).find("holds no picture"), std::string::npos) << failure(folder_);
}

constexpr char kYaml[] = R"(%YAML:1.0
---
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [500, 0, 320, 0, 510, 240, 0, 0, 1]
views:
   - { image: "b.png", rvec: [0, 1.5707963267948966, 0], tvec: [1, 2, 3] }
   - { image: "a.png", rvec: [0, 0, 0], tvec: [0, 0, 5] }
)";

TEST_F(CameraFiles, OpenCvYamlGivesTheSame) {
  std::string text = kYaml;
  // FileStorage reads plain lists of numbers as matrices only when they say so.
  const auto matrix = [](const std::string& data) {
    return "!!opencv-matrix { rows: 3, cols: 1, dt: d, data: " + data + " }";
  };
  for (const std::string data : {"[0, 1.5707963267948966, 0]", "[1, 2, 3]", "[0, 0, 0]", "[0, 0, 5]"})
    text.replace(text.find(data), data.size(), matrix(data));
  write("cameras.yml", text);
  const std::vector<ViewPose> views = read_view_poses(folder_ / "cameras.yml");
  ASSERT_EQ(views.size(), 2u);
  EXPECT_EQ(views[1].picture, "b.png");
  EXPECT_DOUBLE_EQ(views[1].camera.cx, 320);
  const Eigen::Vector3d p = views[1].camera_from_world * Eigen::Vector3d(1, 0, 0);
  EXPECT_NEAR((p - Eigen::Vector3d(1, 2, 2)).norm(), 0, test::kPoseDigits);

  write("cameras.yml", "%YAML:1.0\n---\nviews: 3\n");
  EXPECT_NE(failure(folder_ / "cameras.yml").find("list `views`"), std::string::npos);
  write("cameras.yml", text.substr(0, text.find("camera_matrix")) + text.substr(text.find("views")));
  EXPECT_NE(failure(folder_ / "cameras.yml").find("view 0: camera_matrix is missing"), std::string::npos)
      << failure(folder_ / "cameras.yml");
  write("cameras.yml", "nonsense");
  EXPECT_NE(failure(folder_ / "cameras.yml").find("cameras.yml"), std::string::npos);
}

// The nearest folder first; every name that the message lists.
TEST_F(CameraFiles, AreLookedForAroundThePictures) {
  const auto pictures = folder_ / "shoot" / "images", shoot = folder_ / "shoot";
  std::filesystem::create_directories(pictures);
  std::filesystem::create_directories(shoot / "sparse" / "0");
  for (const auto& where : {shoot / "sparse", shoot / "sparse" / "0", shoot, pictures})
    for (const char* name : {"cameras.calibration", "cameras.xml", "cameras.json", "cameras.yaml", "cameras.yml"}) {
      write_file_atomically(where / name, "x");
      EXPECT_EQ(find_view_poses(pictures), where / name);
    }
  for (const char* name : {"cameras.txt", "images.txt"}) write_file_atomically(pictures / name, "x");
  EXPECT_EQ(find_view_poses(pictures), pictures);
  std::filesystem::remove_all(shoot);
  test::expect_refused<ConfigError>([&] { find_view_poses(pictures); },
                                    {"sparse/0 and sparse", "cameras.yml, .yaml, .json, .xml or .calibration"});
}

TEST_F(CameraFiles, SkeletoolCamerasTakeThePicturesOfTheirNames) {
  const std::string camera =
      "  sensor 10 10\n  size 640 480\n  animated 0\n  intrinsic 500 0 321 0 0 510 241 0 0 0 1 0 0 0 0 1\n"
      "  extrinsic 0 -1 0 100 1 0 0 -200 0 0 1 3000 0 0 0 1\n  radial 0\n";
  std::string text = "Skeletool Camera Calibration File V1.0\n";
  for (const char* name : {"right", "left", "spare"}) text += "name " + std::string(name) + "\n" + camera;
  write("rig.calibration", text);
  const auto read = [&] { return read_view_poses(folder_ / "rig.calibration", folder_ / "images"); };
  EXPECT_THROW(read(), IoError);
  std::filesystem::create_directories(folder_ / "images");
  for (const char* name : {"images/left.png", "images/right.jpg", "images/notes.txt"}) write(name, "x");
  const auto views = read();
  ASSERT_EQ(views.size(), 2u);
  EXPECT_EQ(views[0].picture, "left.png");
  EXPECT_EQ(views[1].picture, "right.jpg");
  EXPECT_DOUBLE_EQ(views[0].camera.cx, 321);
  // World x goes to camera y, and 3 m away.
  const Eigen::Vector3d p = views[1].camera_from_world * Eigen::Vector3d(1000, 0, 0);
  EXPECT_NEAR((p - Eigen::Vector3d(100, 800, 3000)).norm(), 0, test::kPoseDigits);

  // No picture of their name: in order when there are as many, else refused.
  std::filesystem::remove(folder_ / "images" / "left.png");
  std::filesystem::remove(folder_ / "images" / "right.jpg");
  for (const char* name : {"images/b.png", "images/a.png"}) write(name, "x");
  try {
    read();
    FAIL() << "two pictures for three cameras";
  } catch (const IoError& error) {
    EXPECT_NE(std::string(error.what()).find("its 3 cameras (\"right\""), std::string::npos) << error.what();
  }
  write("images/c.png", "x");
  EXPECT_EQ(read()[0].picture, "a.png");
  EXPECT_EQ(read().size(), 3u);
  // Faults keep file and line.
  write("rig.calibration", "Skeletool Camera Calibration File V1.0\nname a\n  size 640\n");
  EXPECT_THROW(read(), IoError);
}

}  // namespace
}  // namespace livecap
