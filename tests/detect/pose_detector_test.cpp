// The detector on the recorded picture of a person, whose landmarks an independent runner gave.
#include "detect/pose_detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

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
    network.set_picture(image);
    network.estimate(detect::whole_image_crop(256, 256), 2.0f, false, estimate);
    EXPECT_GT(estimate.score, 0.5f);
    for (int i = 0; i < 33; ++i) {
      EXPECT_NEAR(estimate.landmarks[i].x_px, landmarks[5 * i] - 0.5, test::kLandmarkPx) << i;
      EXPECT_NEAR(estimate.landmarks[i].y_px, landmarks[5 * i + 1] - 0.5, test::kLandmarkPx) << i;
      EXPECT_NEAR(estimate.landmarks[i].z_mm, 1000 * world[3 * i + 2], test::kLandmarkMm) << i;
    }
  });
}

// The person of crop.png in a larger picture.
ImageRgb person_in_scene(const std::filesystem::path& data) {
  const cv::Mat crop = cv::imread((data / "crop.png").string());
  cv::Mat scene(480, 400, CV_8UC3, cv::Scalar(90, 100, 110));
  cv::Mat large;
  cv::resize(crop, large, cv::Size(384, 384), 0, 0, cv::INTER_CUBIC);
  large.copyTo(scene(cv::Rect(8, 60, 384, 384)));
  return from_mat(scene);
}

// The same person in a larger picture: found, followed, and the same answer again after a reset.
TEST(PoseDetector, FindsThePersonAndRepeatsExactly) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  LIVECAP_DATA_OR_SKIP(data, "network");
  const ImageRgb image = person_in_scene(data);
  const Camera camera = camera_from_fov(400, 480, 50);
  test::on_every_device([&](ocl::DeviceContext& device) {
    detect::PoseDetectorOptions options = lite();
    options.max_unsettled_frames = 0;
    detect::PoseDetector detector(device, options);
    const auto run = [&] {
      std::vector<Detections> frames;
      for (int i = 0; i < 3; ++i) frames.push_back(detector.detect(image, camera, i, i / 30.0));
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

// Who is small in the picture is seen through a crop that is as large in the first frame as in those that follow.
TEST(PoseDetector, LooksAtWhoIsFoundUntilTheCropSettles) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  LIVECAP_DATA_OR_SKIP(data, "network");
  cv::Mat scene(960, 540, CV_8UC3, cv::Scalar(120, 110, 100)), person;
  cv::resize(cv::imread((data / "crop.png").string()), person, cv::Size(420, 420), 0, 0, cv::INTER_CUBIC);
  person.copyTo(scene(cv::Rect(60, 420, person.cols, person.rows)));
  const ImageRgb image = from_mat(scene);
  const Camera camera = camera_from_fov(540, 960, 50);
  test::on_every_device([&](ocl::DeviceContext& device) {
    detect::PoseDetectorOptions options = lite();
    options.max_unsettled_frames = 0;
    options.alternate_mirror = false;
    detect::PoseDetector detector(device, options);
    ASSERT_TRUE(detector.detect(image, camera, 0, 0).person);
    const double first = detector.crop().side_px;
    for (int frame = 1; frame < 4; ++frame) {
      ASSERT_TRUE(detector.detect(image, camera, frame, frame / 30.0).person);
      EXPECT_NEAR(detector.crop().side_px / first, 1, test::kCropAtRest) << frame;
    }
  });
}

// A picture with no symmetry in which the network sees something; which does not matter here.
cv::Mat blobs(int width, int height) {
  cv::Mat bgr(height, width, CV_8UC3, cv::Scalar(90, 100, 110));
  cv::ellipse(bgr, {140, 120}, {22, 60}, 8, 0, 360, {40, 60, 170}, cv::FILLED, cv::LINE_AA);
  cv::circle(bgr, {146, 40}, 17, {120, 150, 210}, cv::FILLED, cv::LINE_AA);
  cv::line(bgr, {155, 85}, {215, 60}, {120, 150, 210}, 14, cv::LINE_AA);
  cv::line(bgr, {125, 85}, {95, 150}, {40, 60, 170}, 14, cv::LINE_AA);
  cv::line(bgr, {132, 170}, {110, 235}, {90, 50, 30}, 20, cv::LINE_AA);
  cv::line(bgr, {148, 170}, {160, 235}, {90, 50, 30}, 20, cv::LINE_AA);
  return bgr;
}

// Another draw of the detections: the same in the frame that the person is found in, then through a crop aside by what
// was asked.
TEST(PoseDetector, FirstCropIsAsideByWhatWasAsked) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  LIVECAP_DATA_OR_SKIP(data, "network");
  const ImageRgb image = from_mat(cv::imread((data / "crop.png").string()));
  const Camera camera = camera_from_fov(image.width, image.height, 50);
  test::on_every_device([&](ocl::DeviceContext& device) {
    detect::PoseDetectorOptions options = lite();
    detect::PoseDetector usual(device, options);
    options.first_crop_aside_px = 0.25;
    detect::PoseDetector aside(device, options);
    for (int i = 0; i < 2; ++i) {
      const Detections expected = usual.detect(image, camera, i, i / 30.0);
      const Detections seen = aside.detect(image, camera, i, i / 30.0);
      ASSERT_TRUE(expected.person && seen.person);
      EXPECT_NEAR(aside.crop().center_x_px - usual.crop().center_x_px, i == 0 ? 0 : 0.25, test::kDoubleExact);
      EXPECT_EQ(aside.crop().center_y_px, usual.crop().center_y_px);
      EXPECT_EQ(aside.raw_landmarks()[0].x_px != usual.raw_landmarks()[0].x_px, i > 0);
      EXPECT_NEAR(seen.keypoints[kNose].x_px, expected.keypoints[kNose].x_px, 3);
    }
  });
}

// GPUs crop the picture, look at the outputs and make the mask's bytes on the device: the same as the host's.
TEST(PoseDetector, BothBodiesSeeTheSame) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ImageRgb image = from_mat(blobs(700, 900));
  ocl::DeviceInfo info = ocl::select_device(test::device_selectors().front());
  ocl::DeviceContext own(info);
  info.is_cpu = false;
  ocl::DeviceContext as_gpu(info);
  detect::BlazePose host(own, model, true), device(as_gpu, model, true);
  host.set_picture(image);
  // Where another queue to the same memory finds it, too.
  ocl::DeviceContext sibling(as_gpu, ocl::SharedMemory{});
  ocl::Buffer<uint8_t> picture(sibling, image.pixels.size());
  device.set_picture(image, &picture);
  detect::PoseEstimate a, b;
  // Shrunk by 1, 2 and 4; turned; partly and wholly outside.
  for (const detect::CropRegion& crop : {detect::CropRegion{300, 400, 230, 0.4},
                                         {350, 450, 520, -2},
                                         {340, 470, 1010, 0.1},
                                         {20, 880, 300, 1},
                                         {-900, 0, 300, 0}}) {
    for (const bool mirrored : {false, true}) {
      host.estimate(crop, 0.0f, mirrored, a);
      device.estimate(crop, 0.0f, mirrored, b);
      EXPECT_NEAR(a.score, b.score, test::kNetworkRelative);
      for (int i = 0; i < detect::BlazePose::kLandmarkCount; ++i) {
        EXPECT_NEAR(a.landmarks[i].x_px, b.landmarks[i].x_px, test::kLandmarkPx) << i;
        EXPECT_NEAR(a.landmarks[i].y_px, b.landmarks[i].y_px, test::kLandmarkPx) << i;
        EXPECT_NEAR(a.landmarks[i].z_mm, b.landmarks[i].z_mm, test::kLandmarkMm) << i;
      }
      const ImageGray of_host = host.mask_probability(), &of_device = device.mask_probability();
      int most = 0;
      for (size_t p = 0; p < of_host.pixels.size(); ++p)
        most = std::max(most, std::abs(of_host.pixels[p] - of_device.pixels[p]));
      EXPECT_LE(most, test::kMaskBytes) << crop.side_px << " px, " << mirrored;
    }
  }
  EXPECT_EQ(picture.read_all(), image.pixels);
}

// Two pictures of which the second shows five keypoints further from where they were than a limb may go: they stay, the
// rest is what the network says, and a reset forgets where they were.
TEST(PoseDetector, WhatJumpsStaysUntilItIsForgotten) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  constexpr int kJumps = 5, kWidth = 320, kHeight = 240;
  cv::Mat other = blobs(kWidth, kHeight);
  cv::line(other, {125, 85}, {60, 60}, {120, 150, 210}, 14, cv::LINE_AA);
  const ImageRgb first = from_mat(blobs(kWidth, kHeight)), second = from_mat(other);
  const Camera camera = camera_from_fov(kWidth, kHeight, 50);
  test::on_every_device([&](ocl::DeviceContext& device) {
    detect::PoseDetectorOptions options = lite();
    options.score_threshold = 0;
    options.max_unsettled_frames = 0;  // nobody is in these pictures
    options.mask = options.filter = options.keep_sides = options.correct_posture = options.alternate_mirror = false;
    options.drop_jumps = false;
    detect::PoseDetector plain(device, options);
    const Detections before = plain.detect(first, camera, 0, 0), after = plain.detect(second, camera, 1, 1.0 / 30);
    ASSERT_TRUE(before.person && after.person);
    std::array<double, kKeypointCount> moves_px;
    for (int k = 0; k < kKeypointCount; ++k)
      moves_px[k] = std::hypot(after.keypoints[k].x_px - before.keypoints[k].x_px,
                               after.keypoints[k].y_px - before.keypoints[k].y_px);
    std::array<double, kKeypointCount> sorted = moves_px;
    std::sort(sorted.rbegin(), sorted.rend());
    const double most_px = (sorted[kJumps - 1] + sorted[kJumps]) / 2;
    constexpr double kCropMm = 2000;
    options.drop_jumps = true;
    options.jumps = {.jump_mm = most_px * kCropMm / plain.crop().side_px, .turn_mm_s = 0, .believed_after_s = 1};
    detect::PoseDetector gated(device, options);
    const auto expect_same = [](const KeypointDetection& got, const KeypointDetection& expected) {
      for (const auto& [a, b] :
           {std::pair(got.x_px, expected.x_px), std::pair(got.y_px, expected.y_px), std::pair(got.x_mm, expected.x_mm),
            std::pair(got.z_mm, expected.z_mm), std::pair(got.confidence, expected.confidence)})
        EXPECT_EQ(a, b);
    };
    const auto expect_held = [&](const Detections& got, bool held) {
      ASSERT_TRUE(got.person);
      for (int k = 0; k < kKeypointCount; ++k) {
        SCOPED_TRACE(k);
        const bool jumps = held && moves_px[k] > most_px;
        expect_same(got.keypoints[k], (jumps ? before : after).keypoints[k]);
      }
    };
    gated.detect(first, camera, 0, 0);
    expect_held(gated.detect(second, camera, 1, 1.0 / 30), true);
    EXPECT_EQ(gated.raw_landmarks()[0].x_px, plain.raw_landmarks()[0].x_px) << "the network's own";
    // The same picture after a reset, as whoever has never seen another.
    gated.reset();
    plain.reset();
    const Detections got = gated.detect(second, camera, 0, 0), expected = plain.detect(second, camera, 0, 0);
    for (int k = 0; k < kKeypointCount; ++k) expect_same(got.keypoints[k], expected.keypoints[k]);
  });
}

// Landmark i in a mirror: left and right exchanged, by the network's list (0 nose, 33 and on: the crop).
int partner(int i) {
  constexpr std::pair<int, int> kSides[] = {{1, 4},   {2, 5},   {3, 6},   {7, 8},   {9, 10},  {11, 12},
                                            {13, 14}, {15, 16}, {17, 18}, {19, 20}, {21, 22}, {23, 24},
                                            {25, 26}, {27, 28}, {29, 30}, {31, 32}};
  for (const auto& [left, right] : kSides) {
    if (i == left) return right;
    if (i == right) return left;
  }
  return i;
}

// What the network says of the mirrored crop is what it says of the mirrored picture, turned back.
TEST(PoseDetector, MirroredEstimateIsThatOfTheMirroredPicture) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  constexpr int kWidth = 320, kHeight = 240;
  const cv::Mat picture = blobs(kWidth, kHeight);
  cv::Mat flipped;
  cv::flip(picture, flipped, 1);
  test::on_every_device([&](ocl::DeviceContext& device) {
    detect::BlazePose network(device, model, true);
    // Crops whose pixels are the picture's, upright and lying: sampling rounds nothing.
    for (const detect::CropRegion& crop : {detect::CropRegion{141.5, 118.5, detect::BlazePose::kCropSize, 0},
                                           detect::CropRegion{139.5, 120.5, detect::BlazePose::kCropSize, M_PI / 2}}) {
      detect::CropRegion flipped_crop = crop;
      flipped_crop.center_x_px = kWidth - 1 - crop.center_x_px;
      flipped_crop.angle_rad = -crop.angle_rad;
      for (float refine : {0.0f, 2.0f}) {  // every landmark, none
        detect::PoseEstimate mirrored, expected;
        const ImageRgb seen = from_mat(picture), seen_flipped = from_mat(flipped);
        network.set_picture(seen);
        network.estimate(crop, refine, true, mirrored);
        const std::vector<uint8_t> mirrored_mask = network.mask_probability().pixels;
        network.set_picture(seen_flipped);
        network.estimate(flipped_crop, refine, false, expected);
        const std::vector<uint8_t>& expected_mask = network.mask_probability().pixels;

        EXPECT_TRUE(mirrored.finite);
        EXPECT_NEAR(mirrored.score, expected.score, test::kNetworkRelative);
        EXPECT_EQ(mirrored.crop.center_x_px, crop.center_x_px);
        for (int i = 0; i < detect::BlazePose::kLandmarkCount; ++i) {
          const detect::RawLandmark &a = mirrored.landmarks[i], &b = expected.landmarks[partner(i)];
          EXPECT_NEAR(a.x_px, kWidth - 1 - b.x_px, test::kLandmarkPx) << i;
          EXPECT_NEAR(a.y_px, b.y_px, test::kLandmarkPx) << i;
          EXPECT_NEAR(a.x_mm, -b.x_mm, test::kLandmarkMm) << i;
          EXPECT_NEAR(a.y_mm, b.y_mm, test::kLandmarkMm) << i;
          EXPECT_NEAR(a.z_mm, b.z_mm, test::kLandmarkMm) << i;
          EXPECT_NEAR(a.visibility, b.visibility, test::kNetworkRelative) << i;
          EXPECT_NEAR(a.presence, b.presence, test::kNetworkRelative) << i;
        }
        constexpr int kSize = detect::BlazePose::kCropSize;
        for (int y = 0; y < kSize; ++y) {
          for (int x = 0; x < kSize; ++x)
            ASSERT_NEAR(mirrored_mask[y * kSize + x], expected_mask[y * kSize + kSize - 1 - x], test::kByteRounding)
                << x << "," << y;
        }
      }
    }
  });
}

// The first tracked picture is shown as it is, the second in the mirror; a new person begins with the former.
TEST(PoseDetector, EverySecondTrackedPictureIsMirrored) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  LIVECAP_DATA_OR_SKIP(data, "network");
  const ImageRgb image = from_mat(cv::imread((data / "crop.png").string()));
  const Camera camera = camera_from_fov(image.width, image.height, 50);
  test::on_every_device([&](ocl::DeviceContext& device) {
    detect::PoseDetectorOptions options = lite();
    detect::PoseDetector alternating(device, options);
    options.alternate_mirror = false;
    detect::PoseDetector plain(device, options);
    detect::BlazePose network(device, model, false);
    for (int round = 0; round < 2; ++round) {
      for (int frame = 0; frame < 4; ++frame) {  // frame 0 is found, then tracked
        ASSERT_TRUE(alternating.detect(image, camera, frame, frame / 30.0).person);
        ASSERT_TRUE(plain.detect(image, camera, frame, frame / 30.0).person);
        detect::PoseEstimate estimate;
        network.set_picture(image);
        network.estimate(alternating.crop(), options.refine_threshold, frame == 2, estimate);
        bool as_plain = true;
        for (int i = 0; i < detect::BlazePose::kLandmarkCount; ++i) {
          EXPECT_EQ(alternating.raw_landmarks()[i].x_px, estimate.landmarks[i].x_px) << frame << " " << i;
          as_plain = as_plain && alternating.raw_landmarks()[i].x_px == plain.raw_landmarks()[i].x_px;
        }
        EXPECT_EQ(as_plain, frame < 2) << frame;
      }
      alternating.reset();
      plain.reset();
    }
  });
}

// A picture in which the network sees nobody changes nothing but the time; after too many of them all is forgotten.
TEST(PoseDetector, MissedFramesAreBridged) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  LIVECAP_DATA_OR_SKIP(data, "network");
  const ImageRgb image = from_mat(cv::imread((data / "crop.png").string()));
  const ImageRgb black{image.width, image.height, std::vector<uint8_t>(image.pixels.size(), 0)};
  const Camera camera = camera_from_fov(image.width, image.height, 50);
  test::on_every_device([&](ocl::DeviceContext& device) {
    detect::PoseDetectorOptions options = lite();
    options.alternate_mirror = false;
    const int most = options.max_missed_frames;
    detect::PoseDetector interrupted(device, options), whole(device, options);
    const auto see = [&](detect::PoseDetector& detector, int frame) {
      return detector.detect(image, camera, frame, frame / 30.0);
    };
    see(interrupted, 0);
    const detect::CropRegion first = interrupted.crop();
    see(whole, 0);
    int frame = 1;
    for (int missed : {1, most}) {
      see(interrupted, frame);
      see(whole, frame++);
      for (int i = 0; i < missed; ++i, ++frame) {
        EXPECT_FALSE(interrupted.detect(black, camera, frame, frame / 30.0).person);
        EXPECT_TRUE(interrupted.raw_landmarks().empty());
      }
      const Detections after = see(interrupted, frame), expected = see(whole, frame);
      ++frame;
      ASSERT_TRUE(after.person);
      for (int k = 0; k < kKeypointCount; ++k) {
        EXPECT_EQ(after.keypoints[k].x_px, expected.keypoints[k].x_px) << missed << " " << k;
        EXPECT_EQ(after.keypoints[k].z_mm, expected.keypoints[k].z_mm) << missed << " " << k;
      }
    }
    EXPECT_NE(interrupted.crop().side_px, first.side_px);
    for (int i = 0; i <= most; ++i, ++frame) interrupted.detect(black, camera, frame, frame / 30.0);
    ASSERT_TRUE(see(interrupted, frame).person);
    EXPECT_EQ(interrupted.crop().side_px, first.side_px) << "searched as in the first frame";
  });
}

// `lite` sees this person in two ways, turn about. So they are looked for anew, with the same result, for as many
// frames as asked and after none without it.
TEST(PoseDetector, WhatDoesNotSettleIsNotFollowedAtOnce) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  LIVECAP_DATA_OR_SKIP(data, "network");
  const ImageRgb image = person_in_scene(data);
  const Camera camera = camera_from_fov(400, 480, 50);
  test::on_every_device([&](ocl::DeviceContext& device) {
    detect::PoseDetectorOptions options = lite();
    options.max_unsettled_frames = -1;
    EXPECT_THROW(detect::PoseDetector(device, options), ConfigError);
    options.max_unsettled_frames = 2;
    detect::PoseDetector detector(device, options);
    for (int round = 0; round < 2; ++round) {
      double found_px = 0;
      for (int frame = 0; frame < 5; ++frame) {
        ASSERT_TRUE(detector.detect(image, camera, frame, frame / 30.0).person);
        if (frame == 0) found_px = detector.crop().side_px;
        EXPECT_EQ(detector.crop().side_px == found_px, frame < 3) << round << " " << frame;
      }
      detector.reset();
    }
  });
}

TEST(PoseDetector, NobodyIsNoError) {
  LIVECAP_MODEL_OR_SKIP(model, "lite");
  const ImageRgb empty{320, 200, std::vector<uint8_t>(3 * 320 * 200, 128)};
  const Camera camera = camera_from_fov(320, 200, 60);
  test::on_every_device([&](ocl::DeviceContext& device) {
    detect::PoseDetector detector(device, lite());
    for (int i = 0; i < 4; ++i) {
      const Detections d = detector.detect(empty, camera, i, i / 30.0);
      EXPECT_FALSE(d.person);
      EXPECT_LT(d.score, 0.5f);
      EXPECT_TRUE(d.mask.empty());
      EXPECT_TRUE(detector.raw_landmarks().empty());
    }
    EXPECT_THROW(detector.detect(empty, camera_from_fov(321, 200, 60), 9, 1), ConfigError);
  });
}

}  // namespace
}  // namespace livecap
