// Nothing of the segmentation is left to the first frame that somebody is seen in.
#include "capture/segmenter.h"

#include <gtest/gtest.h>

#include "capture/engine.h"
#include "nn/models.h"
#include "support/kernel_bodies.h"
#include "support/launched_kernels.h"

namespace livecap {
namespace {

enum class Plate { kNone, kGrey, kBlack };

BackgroundModel background(const Camera& camera, Plate plate) {
  BackgroundModel model;
  const uint8_t value = plate == Plate::kGrey ? 128 : 0;
  if (plate != Plate::kNone)
    model.train({camera.width, camera.height, std::vector<uint8_t>(size_t(3) * camera.width * camera.height, value)});
  return model;
}

TEST(Segmenter, WarmUpLaunchesEveryKernel) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    for (const auto& [width, height] : {std::pair{160, 120}, {70, 261}, {16, 12}}) {
      const Camera camera = camera_from_fov(width, height, 60);
      for (const Plate plate : {Plate::kNone, Plate::kGrey, Plate::kBlack}) {
        for (const bool gated : {true, false}) {
          SCOPED_TRACE(format("%dx%d, plate %d, gated %d", width, height, int(plate), gated));
          const auto warm_up = [&](ocl::DeviceContext& own) {
            Segmenter(own, own, background(camera, plate), camera, gated, 1).warm_up();
          };
          std::set<std::string> unused = {plate == Plate::kNone ? "foreground_score" : "network_score"};
          if (plate != Plate::kNone && !gated) unused.insert({"coarse_means", "lay_mask"});
          test::expect_every_kernel_launched(device.info(), "image/image.cl", warm_up, unused);
        }
      }
    }
  });
}

// Until somebody was seen no frame without anybody is segmented.
TEST(Segmenter, WarmUpIsForgotten) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const Camera camera = camera_from_fov(160, 120, 60);
    Segmenter segmenter(device, device, background(camera, Plate::kGrey), camera, true, 1);
    segmenter.warm_up();
    WorkItem item;
    item.image = {160, 120, std::vector<uint8_t>(size_t(3) * 160 * 120, 0)};
    segmenter.find_gate(item);
    EXPECT_EQ(item.frame, nullptr);
  });
}

TEST(Segmenter, AnEngineIsWarmBeforeItsFirstFrame) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const Camera camera = camera_from_fov(160, 120, 60);
  MethodOptions options;
  options.actor = "builtin:trousers";
  const CapturedActor who = load_captured_actor(options);
  const std::string selector = test::device_selectors().front();
  const std::string launched = test::launched_by([&] {
    CaptureEngine(options, {model, {}, 0}, ocl::select_device_pair(selector, selector), who.actor, camera,
                  background(camera, Plate::kGrey));
  });
  for (const char* kernel : {"lay_mask", "foreground_score", "trim_border", "extend_distances"})
    EXPECT_NE(launched.find('"' + std::string(kernel) + '"'), std::string::npos) << kernel;
}

}  // namespace
}  // namespace livecap
