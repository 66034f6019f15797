#include "scan/mesh_volume.h"

#include <gtest/gtest.h>

#include <limits>

#include "livecap/error.h"
#include "scan/orient.h"
#include "scan/scan.h"
#include "support/refusal.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using Eigen::Vector3d;

meshing::Surface sphere(double radius, const Vector3d& center) {
  const meshing::DistanceField field = [&](const Vector3d& p) { return (p - center).norm() - radius; };
  const Vector3d reach = Vector3d::Constant(radius + 40);
  return meshing::extract_surface(field, center - reach, center + reach, 15);
}

void append(meshing::Surface& surface, const meshing::Surface& other) {
  const int base = static_cast<int>(surface.vertices.size());
  surface.vertices.insert(surface.vertices.end(), other.vertices.begin(), other.vertices.end());
  for (const auto& t : other.triangles) surface.triangles.push_back(t + Eigen::Vector3i::Constant(base));
}

// Metres of floor around the person: refused before gigabytes are asked for, whatever the size as an integer would be.
TEST(MeshVolume, RefusesAGridThatIsTooLarge) {
  for (const double side : {8000.0, 1e9, 1e300, std::numeric_limits<double>::quiet_NaN()}) {
    test::expect_refused<ConfigError>([&] { make_volume(Vector3d::Zero(), Vector3d::Constant(side), 7); },
                                      {" m on a grid of 7 mm", "--unit", "--grid"});
  }
  EXPECT_EQ(make_volume(Vector3d::Zero(), {0, 70, 71}, 7).size(), 2u * 11 * 12);
}

TEST(MeshVolume, HasTheSpheresDistance) {
  const auto volume = volume_of(sphere(200, {0, 0, 0}), 10);
  for (const Vector3d& p : {Vector3d(0, 0, 0), Vector3d(205, 0, 0), Vector3d(0, -193, 0), Vector3d(120, 120, 120)}) {
    const double expected = std::clamp(p.norm() - 200, -20.0, 20.0);
    EXPECT_NEAR(volume.at(p), expected, test::kMeshVolumeMm) << p.transpose();
  }
}

// Holes, a part inside out, an overlapping second body, a cavity: still one solid with the right inside.
TEST(MeshVolume, MakesASolidOfABrokenMesh) {
  meshing::Surface mesh = sphere(200, {0, 0, 0});
  EXPECT_TRUE(is_closed_manifold(mesh));
  const size_t n_ball = mesh.triangles.size();
  append(mesh, sphere(120, {180, 0, 0}));             // overlaps
  for (size_t i = 0; i < mesh.triangles.size(); ++i)  // the overlapping one and a third of the other
    if (Eigen::Vector3i& t = mesh.triangles[i]; i >= n_ball || mesh.vertices[t[0]].x() < -70) std::swap(t[1], t[2]);
  std::erase_if(mesh.triangles, [&](const Eigen::Vector3i& t) {  // a hole of 120 mm at the top
    return mesh.vertices[t[0]].y() > 185;
  });
  EXPECT_FALSE(is_closed_manifold(mesh));
  std::vector<Eigen::Vector2d> no_uvs;
  EXPECT_GT(orient(mesh, no_uvs), mesh.triangles.size() / 4);
  auto volume = volume_of(mesh, 10);
  EXPECT_EQ(keep_largest_solid(volume), 0);
  for (const Vector3d& p : {Vector3d(0, 0, 0), Vector3d(150, 0, 0), Vector3d(270, 0, 0), Vector3d(0, 150, 0),
                            Vector3d(0, -180, 0), Vector3d(-150, 0, 0)})
    EXPECT_LT(volume.at(p), 0) << p.transpose();
  for (const Vector3d& p : {Vector3d(-230, 0, 0), Vector3d(0, 230, 0), Vector3d(150, 190, 0)})
    EXPECT_GT(volume.at(p), 0) << p.transpose();
  EXPECT_TRUE(is_closed_manifold(surface_of(volume)));
}

TEST(MeshVolume, KeepsTheLargestSolidAndFillsIt) {
  auto volume = make_volume(Vector3d::Constant(-300), Vector3d::Constant(300), 10);
  for (int z = 0; z < volume.nz; ++z)
    for (int y = 0; y < volume.ny; ++y)
      for (int x = 0; x < volume.nx; ++x) {
        const Vector3d p = volume.low + 10 * Vector3d(x, y, z);
        // A hollow ball and a smaller one beside it.
        const double shell = std::abs(p.norm() - 130) - 30, other = (p - Vector3d(230, 0, 0)).norm() - 65;
        volume.distance[volume.index(x, y, z)] = static_cast<float>(std::min(shell, other));
      }
  EXPECT_EQ(keep_largest_solid(volume), 1);
  EXPECT_LT(volume.at({0, 0, 0}), 0);
  EXPECT_GT(volume.at({230, 0, 0}), 0);
  Scan scan;
  scan.surface = surface_of(volume);
  EXPECT_TRUE(is_closed_manifold(scan.surface));
  EXPECT_NEAR(keep_largest_piece(scan), 0, test::kWeightSum);
}

TEST(MeshVolume, TellsWhatIsNoManifold) {
  meshing::Surface two = sphere(100, {0, 0, 0});
  append(two, sphere(50, {300, 0, 0}));
  EXPECT_TRUE(is_closed_manifold(two));
  meshing::Surface touching = two;  // two balls that share one vertex
  const int last = static_cast<int>(touching.vertices.size()) - 1;
  for (auto& t : touching.triangles)
    for (int k = 0; k < 3; ++k)
      if (t[k] == last) t[k] = 0;
  EXPECT_FALSE(is_closed_manifold(touching));
  meshing::Surface doubled = two;
  doubled.triangles.push_back(doubled.triangles.front());
  EXPECT_FALSE(is_closed_manifold(doubled));
  // 50 of 100 mm radius: a fifth of the area.
  Scan scan;
  scan.surface = two;
  EXPECT_NEAR(keep_largest_piece(scan), 0.2, test::kPieceShare);
}

// What is dropped leaves no colour behind: neither by vertex nor by corner.
TEST(MeshVolume, TheLargestPieceKeepsItsColours) {
  Scan scan;
  scan.surface = sphere(50, {300, 0, 0});
  const size_t n_vertices = scan.surface.vertices.size(), n_triangles = scan.surface.triangles.size();
  append(scan.surface, sphere(100, {0, 0, 0}));
  for (size_t i = 0; i < scan.surface.vertices.size(); ++i)
    scan.colors.push_back(Vector3d::Constant(i < n_vertices ? 0.1 : 0.9));
  for (size_t i = 0; i < 3 * scan.surface.triangles.size(); ++i)
    scan.uvs.push_back(Eigen::Vector2d::Constant(i < 3 * n_triangles ? 0.1 : 0.9));
  scan.texture = {1, 1, {1, 2, 3}};
  keep_largest_piece(scan);
  EXPECT_EQ(scan.colors, std::vector<Vector3d>(scan.surface.vertices.size(), Vector3d::Constant(0.9)));
  EXPECT_EQ(scan.uvs, std::vector<Eigen::Vector2d>(3 * scan.surface.triangles.size(), Eigen::Vector2d::Constant(0.9)));
  EXPECT_EQ(scan.texture.pixels.size(), 3u);
}

}  // namespace
}  // namespace livecap
