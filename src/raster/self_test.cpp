#include "raster/self_test.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "raster/part_mask.h"
#include "raster/visibility.h"

namespace livecap {
namespace {

// A square that covers 9x9 pixels at 1000 mm, and one of 5x5 behind its middle at 2000 mm, in a picture of 37x31.
constexpr int kWidth = 37, kHeight = 31, kGrow = 2;
constexpr int kFrontPixels = 9 * 9;
// A mask of all columns from the squares' middle on, which halves them.
constexpr int kMaskFrom = 18, kMaskPixels = (kWidth - kMaskFrom) * kHeight, kMaskedPixels = 5 * 9;
constexpr int kGrownPixels = (9 + 2 * kGrow) * (9 + 2 * kGrow);

Mesh two_squares() {
  Mesh mesh;
  for (const auto& [half, z] : {std::pair{45.f, 1000.f}, std::pair{50.f, 2000.f}}) {
    const int base = mesh.n_vertices();
    mesh.positions.insert(mesh.positions.end(), {-half, -half, z, half, -half, z, half, half, z, -half, half, z});
    mesh.triangles.insert(mesh.triangles.end(), {base, base + 2, base + 1, base, base + 3, base + 2});
  }
  return mesh;
}

ocl::SelfTestResult counted(const char* kernel, long expected, long found) {
  return {kernel, expected == found, expected == found ? "" : format("expected %ld, found %ld", expected, found)};
}

}  // namespace

std::vector<ocl::SelfTestResult> raster_self_test(ocl::DeviceContext& device) {
  Camera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  camera.fx = camera.fy = 100;
  camera.cx = 18;
  camera.cy = 15;
  const Mesh mesh = two_squares();
  const ocl::Buffer<float> positions(device, mesh.positions);
  std::vector<float> facing(mesh.positions.size(), 0);
  for (size_t i = 2; i < facing.size(); i += 3) facing[i] = -1;
  DepthRasterizer raster(device, mesh, kWidth, kHeight);
  SurfaceVisibility visibility(device, mesh);
  PartMask parts(device, mesh, std::vector<int32_t>(mesh.n_vertices(), kHead), kWidth, kHeight, kGrow);
  raster.render(positions, camera);
  visibility.find_visible(positions, ocl::Buffer<float>(device, facing), raster);
  visibility.find_contour(raster);
  parts.update(raster);

  std::vector<ocl::SelfTestResult> results;
  const std::vector<float> projected = raster.projected().read_all();
  results.push_back(counted(device.is_cpu() ? "project_vertices" : "raster_begin projected", 135,
                            std::lround(10 * projected[0])));  // u of the first corner: 13.5 px
  const std::vector<float> depth = raster.depth().read_all();
  const long at_front = std::count_if(depth.begin(), depth.end(), [](float z) { return std::lround(z) == 1000; });
  const long empty = std::count_if(depth.begin(), depth.end(), [](float z) { return std::isinf(z); });
  results.push_back(counted(device.is_cpu() ? "raster_bands depth" : "raster_nearest", kFrontPixels, at_front));
  results.push_back(
      counted(device.is_cpu() ? "raster_bands clear" : "raster_begin cleared", kWidth * kHeight - kFrontPixels, empty));
  const std::vector<int32_t> ids = raster.triangle_ids().read_all();
  const long front_ids = std::count_if(ids.begin(), ids.end(), [](int32_t id) { return id == 0 || id == 1; });
  results.push_back(counted(device.is_cpu() ? "raster_bands ids" : "raster_ids", kFrontPixels, front_ids));
  const std::vector<int32_t> visible = visibility.visible().read_all();
  results.push_back(counted("visible_vertices", 4, std::count(visible.begin(), visible.end(), 1)));
  results.push_back(counted("contour_vertices", 4, static_cast<long>(visibility.read_contour().size())));
  if (!device.is_cpu()) {
    SurfaceVisibility both(device, mesh);
    both.find_visible_and_contour(positions, ocl::Buffer<float>(device, facing), raster);
    const std::vector<int32_t> seen = both.visible().read_all();
    results.push_back(counted("visible_and_contour", 44,
                              10 * std::count(seen.begin(), seen.end(), 1) + long(both.read_contour().size())));
  }
  std::vector<uint8_t> mask(size_t(kWidth) * kHeight, 0);
  for (int p = 0; p < kWidth * kHeight; ++p) mask[p] = p % kWidth >= kMaskFrom ? 255 : 0;
  results.push_back(counted("row_overlaps",
                            std::lround(1e6 * kMaskedPixels / (kFrontPixels + kMaskPixels - kMaskedPixels)),
                            std::lround(1e6 * raster.intersection_over_union(ocl::Buffer<uint8_t>(device, mask)))));
  DepthRasterizer depth_alone(device, mesh, kWidth, kHeight);
  depth_alone.render_depth(positions, camera);
  const std::vector<float> alone = depth_alone.depth().read_all();
  results.push_back(counted(device.is_cpu() ? "raster_depths" : "raster_nearest alone", 0,
                            std::mismatch(alone.begin(), alone.end(), depth.begin()).first == alone.end() ? 0 : 1));
  const std::vector<uint8_t> part_image = parts.part_image().read_all();
  results.push_back(counted("part_bits, part_grow_rows, part_grow_columns", kGrownPixels,
                            std::count(part_image.begin(), part_image.end(), uint8_t(kHead))));
  return results;
}

}  // namespace livecap
