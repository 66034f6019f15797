#include "acquire/material_labels.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/tolerances.h"

namespace livecap::acquire {
namespace {

meshing::Surface tetrahedron() {
  meshing::Surface surface;
  surface.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  surface.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {0, 3, 2}};
  return surface;
}

// Three vertices of a tetrahedron's four are looked at, one label is none of LIP's.
TEST(MaterialLabels, VotesCountWhatTheyCannotUse) {
  const meshing::Surface surface = tetrahedron();
  View view;
  view.labels = {96, 64, std::vector<uint8_t>(96 * 64, 5)};
  view.labels.pixels[0] = 200;
  const std::vector<ViewCoverage> coverage = {
      {{1, 1, 1, 0}, {Eigen::Vector2f(0, 0), Eigen::Vector2f(5, 5), Eigen::Vector2f(6, 5), Eigen::Vector2f(0, 0)}}};
  const MaterialLabels labels = vote_labels(surface, {view}, coverage);
  EXPECT_EQ(labels.n_unseen, 2);
  EXPECT_NEAR(labels.foreign, 1.0 / 3, test::kDoubleExact);
  for (uint8_t label : labels.labels) EXPECT_EQ(label, 5);
}

// A leg in the middle of a short skirt, as a surface of revolution: up the leg, out along the roof between leg and
// cloth, down the lining. Seen are the lowest rows of the leg, and the lining. hidden_mm: of the leg.
void expect_leg_and_skirt(int hidden_mm) {
  constexpr int kAround = 24, kLeg = 16, kSkirt = 12;
  constexpr size_t kSeenRows = 3;
  std::vector<Eigen::Vector2d> profile;  // radius, height
  const int top = 20 * static_cast<int>(kSeenRows - 1) + hidden_mm;
  for (int y = 0; y <= top; y += 20) profile.emplace_back(50, y);
  const size_t n_leg = profile.size();
  for (int r = 70; r <= 250; r += 20) profile.emplace_back(r, top + 5);
  const size_t n_roof = profile.size();
  for (int y = top - 10; y >= top - 70; y -= 20) profile.emplace_back(260, y);
  meshing::Surface surface;
  for (const auto& p : profile)
    for (int k = 0; k < kAround; ++k) {
      const double turn = 2 * M_PI * k / kAround;
      surface.vertices.emplace_back(p.x() * std::cos(turn), p.y(), p.x() * std::sin(turn));
    }
  for (int row = 0; row + 1 < static_cast<int>(profile.size()); ++row)
    for (int k = 0; k < kAround; ++k) {
      const int a = row * kAround + k, b = row * kAround + (k + 1) % kAround;
      surface.triangles.emplace_back(a, a + kAround, b);
      surface.triangles.emplace_back(b, a + kAround, b + kAround);
    }
  ViewCoverage coverage{std::vector<float>(surface.vertices.size(), 0),
                        std::vector<Eigen::Vector2f>(surface.vertices.size(), Eigen::Vector2f(5, 5))};
  for (size_t i = 0; i < surface.vertices.size(); ++i) {
    const size_t row = i / kAround;
    coverage.facing[i] = row < kSeenRows || row >= n_roof;
    if (row >= n_roof) coverage.pixels[i].x() = 60;
  }
  View view;
  view.labels = {96, 64, std::vector<uint8_t>(96 * 64, kLeg)};
  for (int y = 0; y < 64; ++y)
    for (int x = 48; x < 96; ++x) view.labels.pixels[y * 96 + x] = kSkirt;
  const MaterialLabels labels = vote_labels(surface, {view}, {coverage});
  int n_wrong = 0;
  for (size_t i = 0; i < surface.vertices.size(); ++i) {
    const size_t row = i / kAround;
    if (row + 1 < n_leg) n_wrong += labels.labels[i] != kLeg;
    if (row > n_leg) n_wrong += labels.labels[i] != kSkirt;
  }
  EXPECT_EQ(n_wrong, 0) << hidden_mm << " mm of the leg are hidden";
}

TEST(MaterialLabels, LegsGoOnWhereASkirtHidesThem) {
  expect_leg_and_skirt(60);   // the leg's end is near, the skirt's far
  expect_leg_and_skirt(300);  // the other way round
}

// A pixel at the border of two labels is of either by chance.
TEST(MaterialLabels, PixelsWithinALabelOutvoteThoseAtItsBorder) {
  const meshing::Surface surface = tetrahedron();
  View view;
  view.labels = {96, 64, std::vector<uint8_t>(96 * 64, 5)};
  for (int y = 0; y < 64; ++y)
    for (int x = 48; x < 96; ++x) view.labels.pixels[y * 96 + x] = 12;
  const auto seen_at = [](float x) {
    return ViewCoverage{{1, 1, 1, 1}, std::vector<Eigen::Vector2f>(4, Eigen::Vector2f(x, 20))};
  };
  const MaterialLabels labels = vote_labels(surface, {view, view, view}, {seen_at(48), seen_at(48), seen_at(30)});
  for (uint8_t label : labels.labels) EXPECT_EQ(label, 5);
}

}  // namespace
}  // namespace livecap::acquire
