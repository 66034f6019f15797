// A limb of few triangles is as thick as the limb, in known places: a capsule, and a hollow.
#include "acquire/facet_offsets.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "meshing/isosurface.h"
#include "meshing/remesh.h"
#include "support/tolerances.h"

namespace livecap::acquire {
namespace {

using Eigen::Vector3d;

constexpr double kRadius = 35, kHalf = 200;

double capsule(const Vector3d& p) {
  return (p - Vector3d(0, std::clamp(p.y(), -kHalf, kHalf), 0)).norm() - kRadius;
}

Volume volume_of_field(const meshing::DistanceField& field) {
  Volume volume = make_volume({-80, -280, -80}, {80, 280, 80}, 5);
  for (int z = 0; z < volume.nz; ++z)
    for (int y = 0; y < volume.ny; ++y)
      for (int x = 0; x < volume.nx; ++x)
        volume.distance[volume.index(x, y, z)] =
            static_cast<float>(field(volume.low + volume.step * Vector3d(x, y, z)));
  return volume;
}

// By the divergence theorem.
double solid_volume(const meshing::Surface& surface) {
  double sum = 0;
  for (const auto& t : surface.triangles)
    sum += surface.vertices[t[0]].dot(surface.vertices[t[1]].cross(surface.vertices[t[2]])) / 6;
  return sum;
}

TEST(FacetOffsets, ALimbOfFewTrianglesIsAsThickAsTheLimb) {
  const meshing::Surface fine = meshing::extract_surface(capsule, {-80, -280, -80}, {80, 280, 80}, 6);
  meshing::Surface coarse = meshing::remesh(fine, 90);
  const double truth = M_PI * kRadius * kRadius * (2 * kHalf + 4.0 / 3 * kRadius);
  const double before = solid_volume(coarse) / truth;
  EXPECT_LT(before, 0.93);  // the vertices are on the surface
  const auto offsets = facet_offsets(coarse, volume_of_field(capsule));
  move_along_normals(offsets, coarse);
  const double after = solid_volume(coarse) / truth;
  std::printf("solid of a limb: %.3f of it, %.3f with triangles on its surface\n", before, after);
  EXPECT_NEAR(after, 1, test::kFacetVolume);
  // Round everywhere: outwards, but for a few between larger neighbours.
  const auto n_inwards =
      std::count_if(offsets.begin(), offsets.end(), [](double o) { return o < -test::kFacetOffsetMm; });
  EXPECT_LT(n_inwards, static_cast<long>(offsets.size() / 10));
}

// The same capsule as a hole in a block: there the vertices move into the hole's wall, and flat sides stay.
TEST(FacetOffsets, AHollowGrowsAndAPlaneStays) {
  const auto block = [](const Vector3d& p) {
    const double box = std::max({std::abs(p.x()) - 70, std::abs(p.y()) - 270, std::abs(p.z()) - 70});
    return std::max(box, -capsule(p));
  };
  meshing::Surface coarse = meshing::extract_surface(block, {-80, -280, -80}, {80, 280, 80}, 24);
  for (Vector3d& p : coarse.vertices)  // exactly on the hole
    if (std::abs(capsule(p)) < 15)
      p = Vector3d(0, std::clamp(p.y(), -kHalf, kHalf), 0) +
          kRadius * (p - Vector3d(0, std::clamp(p.y(), -kHalf, kHalf), 0)).normalized();
  const auto offsets = facet_offsets(coarse, volume_of_field(block));
  double hole = 0;
  int n_hole = 0, n_flat = 0;
  for (size_t i = 0; i < offsets.size(); ++i) {
    const Vector3d& p = coarse.vertices[i];
    if (std::abs(capsule(p)) < 1) hole += offsets[i], ++n_hole;
    if (p.x() > 69 && std::abs(p.y()) < 200 && std::abs(p.z()) < 30) {
      EXPECT_NEAR(offsets[i], 0, test::kFacetOffsetMm);
      ++n_flat;
    }
  }
  ASSERT_GT(n_hole, 20);
  EXPECT_GT(n_flat, 3);
  EXPECT_LT(hole / n_hole,
            -test::kFacetOffsetMm / 2);  // outwards of the block is into the hole: the triangles were there already
}

TEST(FacetOffsets, NothingToMove) {
  EXPECT_TRUE(facet_offsets({}, volume_of_field(capsule)).empty());
}

}  // namespace
}  // namespace livecap::acquire
