// The light in pictures of a person who stands still, on bodies whose light is known.
#include "texture/shading.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "base/srgb.h"
#include "meshing/surface_parts.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using Eigen::Vector3d;

class Shading : public ::testing::Test {
 protected:
  Shading() {
    const meshing::DistanceField field = [](const Vector3d& p) {
      return (p - Vector3d(0, std::clamp(p.y(), -200.0, 200.0), 0)).norm() - 120;
    };
    surface_ = meshing::extract_surface(field, {-170, -370, -170}, {170, 370, 170}, 17);
    normals_ = meshing::vertex_normals(surface_);
    known_.assign(normals_.size(), 1);
  }

  // sRGB of what reflects this much of each channel where so much light falls.
  static Vector3d lit(const Vector3d& light, const Vector3d& albedo) {
    return light.cwiseProduct(albedo).unaryExpr([](double linear) { return srgb_from_linear(linear); });
  }
  static Vector3d lit(double light, const Vector3d& albedo) { return lit(Vector3d::Constant(light), albedo); }

  // Stripes of 90 mm, dark below one half.
  double stripe(size_t i) const { return std::sin(surface_.vertices[i].y() / 90 * M_PI) > 0 ? 0.5 : 0.2; }

  // The largest relative difference between find_shading's red and `light` up to a common factor, over all vertices.
  template <typename Light>
  double worst(const std::vector<Vector3d>& colors, const Light& light) const {
    const livecap::Shading found = find_shading(surface_, shading_normals(surface_), colors, known_);
    double low = 1e9, high = 0;
    for (const Vector3d& n : normals_) {
      const double ratio = found.at(n).x() / light(n);
      low = std::min(low, ratio);
      high = std::max(high, ratio);
    }
    return std::sqrt(high / low) - 1;
  }

  meshing::Surface surface_;
  std::vector<Vector3d> normals_;
  std::vector<char> known_;
};

TEST_F(Shading, IsToldFromThePattern) {
  // A lamp at the upper left in front and a bright room.
  const Vector3d lamp = Vector3d(1, 1, 2).normalized();
  const auto light = [&](const Vector3d& n) { return 1 + 0.45 * n.dot(lamp); };
  std::vector<Vector3d> plain, striped;
  for (size_t i = 0; i < normals_.size(); ++i) {
    plain.push_back(lit(light(normals_[i]), {0.5, 0.35, 0.3}));
    striped.push_back(lit(light(normals_[i]), stripe(i) * Vector3d(0.9, 1, 1.1)));
  }
  std::printf("plain %.3f, striped %.3f; the light itself %.3f\n", worst(plain, light), worst(striped, light),
              worst(std::vector<Vector3d>(normals_.size(), Vector3d(0.5, 0.5, 0.5)), light));
  EXPECT_LT(worst(plain, light), test::kShadingLeft);
  EXPECT_LT(worst(striped, light), test::kShadingLeft);
}

// A lamp that sets on one side, beside what a room returns: where it does the light bends at once.
TEST_F(Shading, IsThatOfALampThatSets) {
  const Vector3d lamp = Vector3d(1, 1, 2).normalized();
  const auto light = [&](const Vector3d& n) { return 0.4 + std::max(0.0, n.dot(lamp)); };
  std::vector<Vector3d> colors;
  for (const Vector3d& n : normals_) colors.push_back(lit(light(n), {0.5, 0.35, 0.3}));
  const livecap::Shading found = find_shading(surface_, shading_normals(surface_), colors, known_);
  const double n = static_cast<double>(normals_.size());
  double sum = 0, squares = 0;
  for (const Vector3d& normal : normals_) {
    const double left = std::log(found.at(normal).x() / light(normal));
    sum += left / n;
    squares += left * left / n;
  }
  const double deviation = std::sqrt(squares - sum * sum);
  std::printf("a lamp that sets: light left %.4f\n", deviation);
  EXPECT_LT(deviation, test::kLampLeft);
}

// Evening light from one side, the sky from the other: their colours go as well.
TEST_F(Shading, HasItsOwnColour) {
  const Vector3d lamp = Vector3d(1, 0.3, 1).normalized(), albedo(0.5, 0.35, 0.3);
  std::vector<Vector3d> colors;
  for (const Vector3d& n : normals_)
    colors.push_back(lit(Vector3d(0.4, 0.45, 0.5) + std::max(0.0, n.dot(lamp)) * Vector3d(0.6, 0.5, 0.4), albedo));
  const livecap::Shading found = find_shading(surface_, shading_normals(surface_), colors, known_);
  const Vector3d first = without_light(colors[0], found.at(normals_[0]));
  for (size_t i = 0; i < colors.size(); ++i) {
    const Vector3d color = without_light(colors[i], found.at(normals_[i]));
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(color[c] / first[c], 1, test::kShadingLeft);
  }
}

// A carved surface is rough: its normals lie 7 degrees off, the light falls on what it stands for.
TEST_F(Shading, IsWholeOnARoughSurface) {
  const Vector3d lamp = Vector3d(1, 1, 2).normalized();
  const auto light = [&](const Vector3d& n) { return 1 + 0.45 * n.dot(lamp); };
  std::vector<Vector3d> colors;
  for (const Vector3d& n : normals_) colors.push_back(lit(light(n), {0.5, 0.35, 0.3}));
  std::mt19937 random(7);
  std::uniform_real_distribution<double> up_and_down(-2.0, 2.0);  // mm; edges are 17 mm
  for (size_t i = 0; i < normals_.size(); ++i) surface_.vertices[i] += up_and_down(random) * normals_[i];
  const auto off_by = [&](const std::vector<Vector3d>& rough) {
    double off = 0;
    for (size_t i = 0; i < rough.size(); ++i) off += std::acos(std::min(1.0, rough[i].dot(normals_[i]))) / rough.size();
    return off;
  };
  const double off = off_by(meshing::vertex_normals(surface_));
  EXPECT_LT(off_by(shading_normals(surface_)), test::kSmoothedNormals * off);
  std::printf("rough normals %.1f degrees off; light left %.3f\n", off * 180 / M_PI, worst(colors, light));
  EXPECT_LT(worst(colors, light), test::kShadingLeft);
}

// Dark trousers and a bright shirt of another colour, which the light falls on from above and in front: what differs by
// its material is not taken for light.
TEST_F(Shading, IsToldFromTwoMaterials) {
  const Vector3d lamp = Vector3d(0, 1, 1).normalized();
  const auto light = [&](const Vector3d& n) { return 1 + 0.45 * n.dot(lamp); };
  std::vector<Vector3d> colors;
  for (size_t i = 0; i < normals_.size(); ++i)
    colors.push_back(
        lit(light(normals_[i]), surface_.vertices[i].y() > 0 ? Vector3d(0.6, 0.4, 0.3) : Vector3d(0.15, 0.2, 0.35)));
  std::printf("two materials: light left %.3f\n", worst(colors, light));
  EXPECT_LT(worst(colors, light), test::kShadingLeft);
}

TEST_F(Shading, NoneWhereLightIsEven) {
  std::vector<Vector3d> striped;
  for (size_t i = 0; i < normals_.size(); ++i) striped.push_back(Vector3d::Constant(stripe(i)));
  EXPECT_LT(worst(striped, [](const Vector3d&) { return 1.0; }), test::kShadingLeft);
}

TEST_F(Shading, NoneWhereNothingWasSeen) {
  std::vector<Vector3d> colors;
  for (const Vector3d& n : normals_) colors.push_back(Vector3d::Constant(0.5 + 0.3 * n.x()));
  known_.assign(known_.size(), 0);
  const livecap::Shading found = find_shading(surface_, shading_normals(surface_), colors, known_);
  EXPECT_TRUE((found.at(Vector3d::UnitX()) == 1).all());
  EXPECT_TRUE((found.at(-Vector3d::UnitX()) == 1).all());
}

// Wild colours must not blow the texture up.
TEST_F(Shading, StaysWithinAFactorOfFive) {
  std::vector<Vector3d> colors;
  for (const Vector3d& n : normals_) colors.push_back(Vector3d::Constant(n.x() > 0.3 ? 1 : n.x() < -0.3 ? 0 : 0.4));
  const livecap::Shading found = find_shading(surface_, shading_normals(surface_), colors, known_);
  for (const Vector3d& n : normals_) {
    EXPECT_GE(found.at(n).minCoeff(), 0.2);
    EXPECT_LE(found.at(n).maxCoeff(), 5);
  }
}

}  // namespace
}  // namespace livecap
