#include "raster/part_mask.h"

#include <gtest/gtest.h>

#include "livecap/error.h"
#include "scenes.h"
#include "support/kernel_bodies.h"

namespace livecap {
namespace {

// The definition, pixel by pixel: torso if it reaches, else what is drawn, else the lowest part within reach.
std::vector<uint8_t> grown(const std::vector<int>& drawn, int width, int height, int radius) {
  std::vector<uint8_t> out(drawn.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      int lowest = kNoPart;
      for (int v = std::max(0, y - radius); v <= std::min(height - 1, y + radius); ++v) {
        for (int u = std::max(0, x - radius); u <= std::min(width - 1, x + radius); ++u) {
          const int part = drawn[v * width + u];
          if (part != kNoPart && (lowest == kNoPart || part < lowest)) lowest = part;
        }
      }
      const int own = drawn[y * width + x];
      out[y * width + x] = static_cast<uint8_t>(lowest == kTorso || own == kNoPart ? lowest : own);
    }
  }
  return out;
}

TEST(PartMask, GrowsPartsAndPrefersTheTorso) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    for (int width : {9, 16, 63, 64, 65}) {
      for (int radius : {0, 3, 10}) {
        const int height = 47;
        const Mesh mesh = test::random_triangles(24, 100 + width);
        std::vector<int32_t> vertex_part(mesh.n_vertices());
        for (int i = 0; i < mesh.n_vertices(); ++i) vertex_part[i] = 1 + i / 3 % (kBodyPartCount - 1);
        DepthRasterizer raster(device, mesh, width, height);
        raster.render(ocl::Buffer<float>(device, mesh.positions), test::small_camera(width, height));
        PartMask mask(device, mesh, vertex_part, width, height, radius);
        mask.update(raster);
        mask.update(raster);
        std::vector<int> drawn;
        for (int32_t id : raster.triangle_ids().read_all())
          drawn.push_back(id < 0 ? kNoPart : 1 + id % (kBodyPartCount - 1));
        EXPECT_EQ(mask.part_image().read_all(), grown(drawn, width, height, radius))
            << width << " px, radius " << radius;
      }
    }
  });
}

TEST(PartMask, BonesAndVerticesHaveParts) {
  Skeleton skeleton;
  auto add = [&](const char* name, int parent) { skeleton.bones.push_back({name, parent, Eigen::Vector3d::Zero()}); };
  add("root", -1);
  add("neck", 0);
  add("left_clavicle", 0);
  add("left_shoulder", 2);
  add("left_elbow", 3);
  add("right_hip", 0);
  add("thing", 5);
  add("chest", 3);
  EXPECT_EQ(body_parts_of_bones(skeleton),
            (std::vector<int32_t>{kTorso, kHead, kTorso, kLeftArm, kLeftArm, kRightLeg, kRightLeg, kTorso}));
  SkinWeights skin{{0, 4, 0, 0, 6, 1, 0, 0}, {0.4f, 0.6f, 0, 0, 0.9f, 0.1f, 0, 0}};
  EXPECT_EQ(body_parts_of_vertices(skeleton, skin), (std::vector<int32_t>{kLeftArm, kRightLeg}));
}

TEST(PartMask, EmptyMeshAndBadParts) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    DepthRasterizer raster(device, Mesh{}, 20, 10);
    raster.render(ocl::Buffer<float>(device, size_t(0)), test::small_camera(20, 10));
    PartMask mask(device, Mesh{}, {}, 20, 10);
    mask.update(raster);
    EXPECT_EQ(mask.part_image().read_all(), std::vector<uint8_t>(200, kNoPart));
    EXPECT_THROW(PartMask(device, test::random_triangles(1, 1), {1, 2, 9}, 20, 10), LogicError);
    EXPECT_THROW(PartMask(device, Mesh{}, {}, 20, 10, 16), ConfigError);
    PartMask other(device, Mesh{}, {}, 21, 10);
    EXPECT_THROW(other.update(raster), LogicError);
  });
}

}  // namespace
}  // namespace livecap
