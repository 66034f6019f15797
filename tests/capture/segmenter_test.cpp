// Nothing of the segmentation is left to the first frame that somebody is seen in.
#include "capture/segmenter.h"

#include <gtest/gtest.h>

#include <algorithm>

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

// A person's keypoints where the picture is as the empty one, and where a quarter of their box differs from it.
TEST(Segmenter, NobodyIsWhereNothingDiffersFromThePlate) {
  constexpr int kWidth = 160, kHeight = 120, kLeft = 50, kTop = 20, kSide = 60;
  test::on_every_device([](ocl::DeviceContext& device) {
    const Camera camera = camera_from_fov(kWidth, kHeight, 60);
    Segmenter segmenter(device, device, background(camera, Plate::kGrey), camera, false, 1);
    for (const bool there : {false, true, false}) {
      WorkItem item;
      item.image = {kWidth, kHeight, std::vector<uint8_t>(size_t(3) * kWidth * kHeight, 128)};
      for (int y = kTop; there && y < kTop + kSide; ++y)
        std::fill_n(&item.image.pixels[size_t(3) * (y * kWidth + kLeft + kSide / 4)], 3 * kSide / 4, uint8_t{20});
      item.detections.person = true;
      for (int k = 0; k < kKeypointCount; ++k) {
        KeypointDetection& keypoint = item.detections.keypoints[k];
        keypoint.confidence = 1;
        keypoint.x_px = float(k % 2 == 0 ? kLeft : kLeft + kSide);
        keypoint.y_px = float(k % 4 < 2 ? kTop : kTop + kSide);
      }
      segmenter.find_gate(item);
      segmenter.segment(item);
      EXPECT_EQ(item.nobody, !there);
      EXPECT_EQ(item.silhouette.empty(), !there);
      EXPECT_TRUE(item.detections.person) << "what the network saw";
    }
  });
}

// A person of the network beside a shadow that keeps 0.43 of the light.
TEST(Segmenter, TheContourIsLeftOpenWhereAShadowIsDark) {
  constexpr int kWidth = 160, kHeight = 120, kLeft = 40, kRight = 80, kShadow = 88, kTop = 20, kBottom = 100;
  test::on_every_device([](ocl::DeviceContext& device) {
    const Camera camera = camera_from_fov(kWidth, kHeight, 60);
    Segmenter segmenter(device, device, background(camera, Plate::kGrey), camera, true, 1);
    WorkItem item;
    item.image = {kWidth, kHeight, std::vector<uint8_t>(size_t(3) * kWidth * kHeight, 128)};
    item.detections.person = true;
    item.detections.mask = {kWidth, kHeight, std::vector<uint8_t>(size_t(kWidth) * kHeight, 0)};
    for (int y = kTop; y < kBottom; ++y) {
      const size_t row = size_t(y) * kWidth;
      std::fill_n(&item.image.pixels[3 * (row + kLeft)], 3 * (kRight - kLeft), uint8_t{10});
      std::fill_n(&item.image.pixels[3 * (row + kRight)], 3 * (kShadow - kRight), uint8_t{55});
      std::fill_n(&item.detections.mask.probability[row + kLeft], kRight - kLeft, uint8_t{250});
    }
    segmenter.find_gate(item);
    segmenter.segment(item);
    const std::vector<float> distance = item.frame->signed_distance.read_all();
    const auto at = [&](int x) { return distance[size_t(60) * kWidth + x]; };
    EXPECT_EQ(at(kRight - 3), -2.5f);
    EXPECT_EQ(at(kRight + 2), 0);
    EXPECT_EQ(at(kShadow - 2), 0);
    EXPECT_EQ(at(kShadow + 2), 2.5f);
    EXPECT_EQ(at(kLeft + 2), -2.5f);
    EXPECT_EQ(item.mask.pixels[size_t(60) * kWidth + kRight + 4], 255) << "it may be the person";
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
