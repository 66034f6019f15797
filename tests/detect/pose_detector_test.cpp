// The detector on the recorded picture of a person, whose landmarks an independent runner gave.
#include "detect/pose_detector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "detect/find_model.h"
#include "livecap/error.h"
#include "nn/models.h"
#include "nn/npy.h"
#include "support/data_dir.h"
#include "support/test_device.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

ImageRgb from_mat(const cv::Mat& bgr) {
  cv::Mat rgb;
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  return {rgb.cols, rgb.rows, std::vector<uint8_t>(rgb.datastart, rgb.dataend)};
}

detect::PoseDetectorOptions lite() {
  detect::PoseDetectorOptions options;
  options.model = test::model_path("lite").string();
  return options;
}

TEST(PoseDetector, UnknownModelSaysWhatToDo) {
  EXPECT_THROW(detect::find_model("gigantic"), IoError);
  setenv("LIVECAP_MODEL_DIR_SAVED", std::getenv("LIVECAP_MODEL_DIR") ? std::getenv("LIVECAP_MODEL_DIR") : "", 1);
  setenv("LIVECAP_MODEL_DIR", "/no/such/folder", 1);
  try {
    detect::find_model("full");
    ADD_FAILURE() << "expected IoError";
  } catch (const IoError& e) {
    EXPECT_NE(std::string(e.what()).find("/no/such/folder"), std::string::npos) << e.what();
    EXPECT_NE(std::string(e.what()).find("tools/setup.sh"), std::string::npos) << e.what();
  }
  const std::string saved = std::getenv("LIVECAP_MODEL_DIR_SAVED");
  if (saved.empty()) {
    unsetenv("LIVECAP_MODEL_DIR");
  } else {
    setenv("LIVECAP_MODEL_DIR", saved.c_str(), 1);
  }
}

// The adapter on the recorded crop itself: landmarks before refinement are the recorded ones.
TEST(PoseDetector, LandmarksAreTheNetworksOwn) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  LIVECAP_DATA_OR_SKIP(data, "network");
  const ImageRgb image = from_mat(cv::imread((data / "crop.png").string()));
  const auto landmarks = test::load_npy(data / "lite_landmarks.npy");
  const auto world = test::load_npy(data / "lite_world.npy");
  test::on_every_device([&](ocl::DeviceContext& device) {
    detect::BlazePose network(device, model, false);
    detect::PoseEstimate estimate;
    network.estimate(image, detect::whole_image_crop(256, 256), 2.0f, false, estimate);
    EXPECT_GT(estimate.score, 0.5f);
    for (int i = 0; i < 33; ++i) {
      EXPECT_NEAR(estimate.landmarks[i].x_px, landmarks[5 * i] - 0.5, test::kLandmarkPx) << i;
      EXPECT_NEAR(estimate.landmarks[i].y_px, landmarks[5 * i + 1] - 0.5, test::kLandmarkPx) << i;
      EXPECT_NEAR(estimate.landmarks[i].z_mm, 1000 * world[3 * i + 2], test::kLandmarkMm) << i;
    }
  });
}

// The same person in a larger picture: found, followed, and the same answer again after a reset.
TEST(PoseDetector, FindsThePersonAndRepeatsExactly) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  LIVECAP_DATA_OR_SKIP(data, "network");
  const cv::Mat crop = cv::imread((data / "crop.png").string());
  cv::Mat scene(480, 400, CV_8UC3, cv::Scalar(90, 100, 110));
  cv::Mat large;
  cv::resize(crop, large, cv::Size(384, 384), 0, 0, cv::INTER_CUBIC);
  large.copyTo(scene(cv::Rect(8, 60, 384, 384)));
  const ImageRgb image = from_mat(scene);
  const Camera camera = camera_from_fov(400, 480, 50);
  test::on_every_device([&](ocl::DeviceContext& device) {
    detect::PoseDetector detector(device, lite());
    const auto run = [&] {
      std::vector<Detections> frames;
      for (int i = 0; i < 3; ++i) frames.push_back(detector.detect(image, camera, i));
      return frames;
    };
    const auto first = run();
    detector.reset();
    const auto second = run();
    for (int i = 0; i < 3; ++i) {
      ASSERT_TRUE(first[i].person);
      EXPECT_EQ(first[i].score, second[i].score);
      EXPECT_EQ(first[i].mask.probability, second[i].mask.probability);
      for (int k = 0; k < kKeypointCount; ++k) {
        EXPECT_EQ(first[i].keypoints[k].x_px, second[i].keypoints[k].x_px);
        EXPECT_EQ(first[i].keypoints[k].z_mm, second[i].keypoints[k].z_mm);
      }
    }
    const auto& k = first[2].keypoints;
    EXPECT_EQ(k[kHeadTop].confidence, 0.0f);
    EXPECT_LT(k[kNose].y_px, k[kPelvis].y_px);
    EXPECT_LT(k[kNeck].y_mm, 0);  // y down, origin at the hips
    EXPECT_NEAR(k[kPelvis].x_mm, 0, test::kLandmarkMm);
    EXPECT_NEAR(k[kNeck].x_px, (k[kLeftShoulder].x_px + k[kRightShoulder].x_px) / 2, test::kByteRounding);
    // The mask covers the chest and not the picture's corner.
    const auto mask_at = [&](double x, double y) {
      return first[2].mask.probability[size_t(std::lround(y)) * 400 + size_t(std::lround(x))];
    };
    EXPECT_GT(mask_at((k[kNeck].x_px + k[kPelvis].x_px) / 2, (k[kNeck].y_px + k[kPelvis].y_px) / 2), 200);
    EXPECT_LT(mask_at(2, 2), 50);
  });
}

TEST(PoseDetector, NobodyIsNoError) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ImageRgb empty{320, 200, std::vector<uint8_t>(3 * 320 * 200, 128)};
  const Camera camera = camera_from_fov(320, 200, 60);
  test::on_every_device([&](ocl::DeviceContext& device) {
    detect::PoseDetector detector(device, lite());
    for (int i = 0; i < 4; ++i) {
      const Detections d = detector.detect(empty, camera, i);
      EXPECT_FALSE(d.person);
      EXPECT_LT(d.score, 0.5f);
      EXPECT_TRUE(d.mask.empty());
      EXPECT_TRUE(detector.raw_landmarks().empty());
    }
    EXPECT_THROW(detector.detect(empty, camera_from_fov(321, 200, 60), 9), ConfigError);
  });
}

}  // namespace
}  // namespace livecap
