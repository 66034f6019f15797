#include "acquire/hull.h"

#include <algorithm>
#include <cmath>

#include "acquire/layout.h"
#include "base/text.h"
#include "geometry/pinhole_arg.h"
#include "image/silhouette.h"
#include "livecap/error.h"
#include "ocl/buffer.h"
#include "ocl/kernel.h"

namespace livecap::acquire {

namespace {

struct CarveView {
  float rotation[9];
  float translation[3];
  PinholeArg pinhole;
};
static_assert(sizeof(CarveView) == 64);

struct CarveGrid {
  int nx, ny, nz;
  float low[3];
  float step;
};
static_assert(sizeof(CarveGrid) == 28);
static_assert(HullOptions::kMostIgnored + 1 == LC_CARVE_KEPT);

CarveView carve_view(const View& view) {
  CarveView arg;
  for (int i = 0; i < 9; ++i) arg.rotation[i] = static_cast<float>(view.camera_from_world.linear()(i / 3, i % 3));
  for (int i = 0; i < 3; ++i) arg.translation[i] = static_cast<float>(view.camera_from_world.translation()[i]);
  arg.pinhole = pinhole_arg(view.camera);
  return arg;
}

}  // namespace

void HullOptions::validate() const {
  for (const int n : {n_ignored, n_ignored_low})
    if (n < 0 || n > kMostIgnored)
      throw ConfigError(format("hull: %d views ignored; must be 0 to %d", n, kMostIgnored));
  if (!(limit_mm > 0) || !(min_seen >= 0 && min_seen <= 1))
    throw ConfigError("hull: limit or min_seen is not a length or share");
}

void carve_hull(ocl::DeviceContext& device, const std::vector<View>& views, const HullOptions& options,
                Volume& volume) {
  options.validate();
  const size_t n = volume.size();
  ocl::Kernel carve(device, "acquire/carve.cl", "carve_view"), result(device, "acquire/carve.cl", "carve_result");
  ocl::Buffer<float> largest(device, LC_CARVE_KEPT * n), distance(device, n);
  ocl::Buffer<int32_t> seen(device, n);
  largest.fill(-static_cast<float>(options.limit_mm));
  seen.fill(0);
  const CarveGrid grid{
      volume.nx,
      volume.ny,
      volume.nz,
      {static_cast<float>(volume.low.x()), static_cast<float>(volume.low.y()), static_cast<float>(volume.low.z())},
      static_cast<float>(volume.step)};
  int used = 0;
  for (const View& view : views) {
    if (view.mask.empty()) continue;
    const Silhouette silhouette = make_silhouette(view.mask);
    if (silhouette.empty()) continue;
    const ocl::Buffer<float> picture(device, silhouette.signed_distance);
    carve.launch(n, 64, static_cast<int>(n), grid, carve_view(view), view.camera.width, view.camera.height,
                 static_cast<int>(view.exact_mask), picture, largest, seen);
    device.finish();  // the picture's buffer ends here
    ++used;
  }
  if (used == 0) throw ConfigError("hull: no view has a silhouette");
  const double n_low = std::clamp(std::ceil((options.low_mm - volume.low.y()) / volume.step), 0.0, double(volume.ny));
  result.launch(n, 64, static_cast<int>(n), grid, options.n_ignored, static_cast<int>(n_low), options.n_ignored_low,
                std::max(1, static_cast<int>(std::ceil(options.min_seen * used))), static_cast<float>(options.limit_mm),
                largest, seen, distance);
  volume.distance.resize(n);
  distance.read(std::span<float>(volume.distance));
}

// Four cameras around a box-shaped silhouette each: the hull of 40 px squares at 1000 mm with f = 100 px is a prism
// whose faces are 200 mm from the axis.
std::vector<ocl::SelfTestResult> acquire_self_test(ocl::DeviceContext& device) {
  std::vector<View> views;
  for (int i = 0; i < 4; ++i) {
    View view;
    view.camera = {101, 101, 100, 100, 50, 50, {}};
    view.camera_from_world.linear() = Eigen::AngleAxisd(i * M_PI / 2, Eigen::Vector3d::UnitY()).toRotationMatrix();
    view.camera_from_world.translation() = Eigen::Vector3d(0, 0, 1000);
    view.mask = {101, 101, std::vector<uint8_t>(101 * 101, 0)};
    for (int y = 30; y <= 70; ++y)
      for (int x = 30; x <= 70; ++x) view.mask.pixels[y * 101 + x] = 255;
    views.push_back(view);
  }
  Volume volume = make_volume(Eigen::Vector3d::Constant(-300), Eigen::Vector3d::Constant(300), 50);
  carve_hull(device, views, {0, 500, 0.5}, volume);
  const double expected[3] = {-205, -5 * 1.05, 95};  // centre; 200 mm right: 20.5 px, half a pixel inside, and 50 mm on
  const double at[3] = {volume.at({0, 0, 0}), volume.at({200, 0, 0}), volume.at({300, 0, 0})};
  std::vector<ocl::SelfTestResult> results;
  const bool centre = std::abs(at[0] - expected[0]) < 1, face = std::abs(at[1] - expected[1]) < 10;
  results.push_back(
      {"acquire/carve_view", centre && face,
       centre && face ? "" : format("expected %g and %g mm, found %g and %g", expected[0], expected[1], at[0], at[1])});
  carve_hull(device, views, {0, 30, 1}, volume);
  const double cut = volume.at({0, 0, 0});
  const bool passed = std::abs(at[2] - expected[2]) < 40 && cut == -30;
  results.push_back({"acquire/carve_result", passed,
                     passed ? "" : format("expected about %g and -30 mm, found %g and %g", expected[2], at[2], cut)});
  return results;
}

}  // namespace livecap::acquire
