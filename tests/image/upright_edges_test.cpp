// Which way is up, of drawn rooms whose camera is known.
#include "image/upright_edges.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <random>
#include <vector>

#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

constexpr double kRadPerDeg = std::numbers::pi / 180;

double angle_deg(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kRadPerDeg;
}

// A camera that looks down by pitch and whose picture leans by roll, in a room of posts.
struct Room {
  Camera camera{540, 960, 1010, 1010, 269.5, 479.5};
  Eigen::Vector3d up;
  Eigen::Matrix3d camera_from_room;  // of a room whose y is up
  cv::Mat picture;

  Room(double pitch_deg, double roll_deg)
      : camera_from_room((Eigen::AngleAxisd(roll_deg * kRadPerDeg, Eigen::Vector3d::UnitZ()) *
                          Eigen::AngleAxisd(pitch_deg * kRadPerDeg, Eigen::Vector3d::UnitX()) *
                          Eigen::Vector3d(1, -1, -1).asDiagonal().toDenseMatrix())
                             .matrix()),
        picture(camera.height, camera.width, CV_8UC3, cv::Scalar::all(120)) {
    up = camera_from_room.col(1);
  }

  // Three fractional bits.
  cv::Point pixel(const Eigen::Vector3d& in_room_mm) const {
    const Eigen::Vector3d p = camera_from_room * in_room_mm;
    return {int(std::lround(8 * (camera.fx * p.x() / p.z() + camera.cx))),
            int(std::lround(8 * (camera.fy * p.y() / p.z() + camera.cy)))};
  }
  void bar(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double width_mm, int gray) {
    const Eigen::Vector3d aside = width_mm * Eigen::Vector3d::UnitX();
    const cv::Point corners[] = {pixel(from), pixel(from + aside), pixel(to + aside), pixel(to)};
    cv::fillConvexPoly(picture, corners, 4, cv::Scalar::all(gray), cv::LINE_AA, 3);
  }
  // Upright waves on a board that faces along z, between two of its corners.
  void stripes(const Eigen::Vector3d& low, const Eigen::Vector3d& high, double apart_mm, double contrast) {
    for (int y = 0; y < picture.rows; ++y) {
      for (int x = 0; x < picture.cols; ++x) {
        const Eigen::Vector3d ray((x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1);
        Eigen::Vector3d at = camera_from_room.transpose() * ray;
        at *= low.z() / at.z();
        if ((at - low).head<2>().minCoeff() < 0 || (high - at).head<2>().minCoeff() < 0) continue;
        const double wave = std::sin(2 * std::numbers::pi * at.x() / apart_mm);
        picture.at<cv::Vec3b>(y, x) = cv::Vec3b::all(uchar(std::lround(120 + contrast * wave)));
      }
    }
  }
  // Posts on both sides, 5 m away.
  void posts(int n = 6) {
    for (int k = 0; k < n; ++k) {
      const double x = -1300 + 2600.0 * k / n;
      bar({x, -800, -5000}, {x, 900, -5000}, 110, k % 2 ? 40 : 200);
    }
  }
  std::optional<Upright> found(const ImageGray& person = {}) const {
    cv::Mat noisy = picture.clone();
    cv::RNG rng(3);
    cv::Mat noise(picture.size(), CV_8UC3);
    rng.fill(noise, cv::RNG::NORMAL, 8, 2);
    noisy += noise;
    ImageRgb image{picture.cols, picture.rows, std::vector<uint8_t>(noisy.datastart, noisy.dataend)};
    return upright_by_edges(image, person, camera);
  }
};

TEST(UprightEdges, PostsTellHowTheCameraIsTurned) {
  for (const auto& [pitch, roll] : std::vector<std::pair<double, double>>{{0, 0}, {8, 1}, {-12, -3}, {25, 5}}) {
    Room room(pitch, roll);
    room.posts();
    const auto upright = room.found();
    ASSERT_TRUE(upright) << pitch;
    EXPECT_LT(angle_deg(upright->up, room.up), test::kUprightDeg) << pitch << ' ' << roll;
    EXPECT_NEAR(upright->up.norm(), 1, 1e-9);
    EXPECT_GE(upright->n_edges, 8);
    // What it says of itself: within three of its deviations, which are below 2 degrees.
    const Eigen::Vector3d off = upright->up - room.up;
    EXPECT_LT(off.dot(upright->information * off), 9);
    EXPECT_GT(upright->information({0, 2}, {0, 2}).eval().eigenvalues().real().minCoeff(),
              std::pow(2 * kRadPerDeg, -2));
  }
}

// Stripes a few pixels apart seem to run along columns of pixels: these point 4 to 9 degrees aside.
TEST(UprightEdges, FineStripesDoNotCount) {
  for (const auto& [apart_mm, contrast] : std::vector<std::pair<double, double>>{{16, 20}, {19, 10}, {22, 10}}) {
    Room room(9, 0);
    room.posts(3);
    room.stripes({300, -600, -4900}, {1250, 600, -4900}, apart_mm, contrast);
    const auto upright = room.found();
    ASSERT_TRUE(upright) << apart_mm;
    EXPECT_LT(angle_deg(upright->up, room.up), test::kUprightDeg) << apart_mm;
  }
}

// Posts in the middle of the picture point up and down it however far the camera looks down.
TEST(UprightEdges, PostsInTheMiddleTellLess) {
  Room wide(8, 0), narrow(8, 0);
  wide.posts();
  for (int k = 0; k < 6; ++k)
    narrow.bar({-250 + 80.0 * k, -800, -5000}, {-250 + 80.0 * k, 900, -5000}, 40, k % 2 ? 40 : 200);
  const auto by_wide = wide.found(), by_narrow = narrow.found();
  ASSERT_TRUE(by_wide && by_narrow);
  const Eigen::Vector3d nod = Eigen::Vector3d::UnitX().cross(wide.up);
  EXPECT_GT(nod.dot(by_wide->information * nod), 2 * nod.dot(by_narrow->information * nod));
}

TEST(UprightEdges, WhatLeansOtherwiseDoesNotCount) {
  Room room(7, 0);
  room.posts();
  for (int k = 0; k < 4; ++k)  // ladders against the wall
    room.bar({-1100 + 600.0 * k, -700, -4900}, {-700 + 600.0 * k, 700, -4900}, 30, 10);
  const auto upright = room.found();
  ASSERT_TRUE(upright);
  EXPECT_LT(angle_deg(upright->up, room.up), test::kUprightDeg);
}

TEST(UprightEdges, ThePersonIsNotOfTheRoom) {
  Room room(6, 0);
  room.posts(12);
  // Someone in stripes who leans, and more edges than the room has.
  ImageGray person{room.camera.width, room.camera.height,
                   std::vector<uint8_t>(size_t(room.camera.width) * room.camera.height, 0)};
  for (int k = 0; k < 18; ++k) {
    const double x = -450 + 50.0 * k;
    room.bar({x, -700, -3500}, {x + 110, 700, -3500}, 20, k % 2 ? 20 : 230);
  }
  for (int y = 0; y < person.height; ++y)
    for (int x = 143; x < 420; ++x) person.pixels[size_t(y) * person.width + x] = 255;
  const auto with = room.found(person);
  ASSERT_TRUE(with);
  EXPECT_LT(angle_deg(with->up, room.up), test::kUprightDeg);
  const auto without = room.found();
  EXPECT_TRUE(!without || angle_deg(without->up, room.up) > 2) << "the stripes were not worth masking";
}

TEST(UprightEdges, WhereNothingStandsNothingIsTold) {
  Room empty(5, 0);
  EXPECT_FALSE(empty.found());
  Room floor_boards(5, 0);
  for (int k = 0; k < 10; ++k)
    floor_boards.bar({-1000, -700 + 120.0 * k, -5000}, {1000, -700 + 120.0 * k, -5000}, 0, 30);
  EXPECT_FALSE(floor_boards.found());
  Room scattered(5, 0);
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> x(-1200, 1200), y(-800, 800), turn(-0.65, 0.65);
  for (int k = 0; k < 40; ++k) {
    const Eigen::Vector3d at(x(rng), y(rng), -5000);
    const double angle = turn(rng);
    scattered.bar(at, at + 220 * Eigen::Vector3d(std::sin(angle), std::cos(angle), 0), 25, k % 2 ? 30 : 220);
  }
  EXPECT_FALSE(scattered.found());
}

TEST(UprightEdges, SizesMustMatch) {
  Room room(0, 0);
  EXPECT_THROW(upright_by_edges({3, 3, std::vector<uint8_t>(27)}, {}, room.camera), LogicError);
  EXPECT_THROW(room.found({2, 2, {0, 0, 0, 0}}), LogicError);
}

}  // namespace
}  // namespace livecap
