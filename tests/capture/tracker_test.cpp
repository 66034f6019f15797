// One frame after another without pictures: what the tracker makes of the detections alone.
#include "capture/tracker.h"

#include <gtest/gtest.h>

#include <utility>

#include "support/pose_scene.h"
#include "support/test_device.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

// Walking on the spot, facing the camera; the legs of the standing figure swing a little.
Pose step_of(const Actor& actor, int frame) {
  Pose pose = test::standing_pose(actor, 0.3);
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
    const std::string& name = actor.skeleton.dofs[k].name;
    if (name == "left_hip_x") pose.angles_rad[k] = -0.03 * frame;
    if (name == "right_hip_x") pose.angles_rad[k] = 0.02 * frame;
    if (name == "left_knee_x" || name == "right_knee_x") pose.angles_rad[k] = 0.2 + 0.03 * frame;
  }
  return pose;
}

Detections with_exchanged_feet(Detections detections) {
  for (int left : {kLeftAnkle, kLeftToe}) std::swap(detections.keypoints[left], detections.keypoints[left + 1]);
  return detections;
}

class TrackerScene {
 public:
  TrackerScene(ocl::DeviceContext& device, int max_exchanged_frames)
      : tracker_(device, actor_, camera_, [&] {
          TrackerOptions options;
          options.enable_surface = false;
          options.pose.rebone = false;
          options.pose.weights.floor = 0;       // these feet rise though the body does not
          options.pose.weights.silhouette = 0;  // a spot would pull the pose until it is not believed
          options.starts.max_exchanged_frames = max_exchanged_frames;
          return options;
        }()) {}

  // How far the feet are from those of the true pose, mm; the frame must be tracked.
  double track(int frame, bool feet_exchanged) {
    const Pose truth = step_of(actor_, frame);
    Detections detections = test::exact_detections(actor_, camera_, truth);
    if (feet_exchanged) detections = with_exchanged_feet(detections);
    const TrackResult result = tracker_.track({picture_, detections, nobody_segmented_, empty_mask_});
    EXPECT_EQ(result.status, frame == 0 ? TrackStatus::kInitialized : TrackStatus::kOk) << frame;
    if (!is_tracked(result.status)) return -1;
    const auto seen = keypoint_positions(actor_, forward_kinematics(actor_.skeleton, result.pose));
    const auto wanted = keypoint_positions(actor_, forward_kinematics(actor_.skeleton, truth));
    double largest = 0;
    for (int k : {kLeftAnkle, kRightAnkle, kLeftToe, kRightToe})
      largest = std::max(largest, (seen[k] - wanted[k]).norm());
    return largest;
  }

  // Every keypoint 250 px beside where it is, to the left or to the right in turns.
  TrackStatus track_scattered(int frame) {
    Detections detections = test::exact_detections(actor_, camera_, step_of(actor_, frame));
    for (int k = 0; k < kKeypointCount; ++k) detections.keypoints[k].x_px += k % 2 ? 250 : -250;
    return tracker_.track({picture_, detections, nobody_segmented_, empty_mask_}).status;
  }

  // The network sees nobody.
  TrackStatus track_nobody() { return tracker_.track({picture_, Detections{}, nobody_segmented_, empty_mask_}).status; }

  TrackStatus track_again(int frame) {
    const Detections detections = test::exact_detections(actor_, camera_, step_of(actor_, frame));
    return tracker_.track({picture_, detections, nobody_segmented_, empty_mask_}).status;
  }

  // All that differs from the empty room is a spot at the neck.
  TrackStatus track_before_spot(int frame) {
    const Detections detections = test::exact_detections(actor_, camera_, step_of(actor_, frame));
    ImageGray mask = empty_mask_;
    const int x = int(detections.keypoints[kNeck].x_px), y = int(detections.keypoints[kNeck].y_px);
    for (int i = -8; i < 8; ++i)
      for (int j = -8; j < 8; ++j) mask.pixels[size_t(y + i) * mask.width + x + j] = 255;
    return tracker_.track({grey_, detections, make_silhouette(mask), mask}).status;
  }

  // Which way is up with a frame's pose.
  Eigen::Vector3d up_at(int frame) {
    const Detections detections = test::exact_detections(actor_, camera_, step_of(actor_, frame));
    return tracker_.track({picture_, detections, nobody_segmented_, empty_mask_}).up;
  }
  void set_upright(const Upright& upright) { tracker_.set_upright(upright); }

  void reset() { tracker_.reset(); }

 private:
  Actor actor_ = test::make_test_actor(0.7);
  Camera camera_ = test::portrait_camera();
  ImageRgb picture_;
  ImageRgb grey_{camera_.width, camera_.height, std::vector<uint8_t>(3 * size_t(camera_.width) * camera_.height, 128)};
  Silhouette nobody_segmented_;
  ImageGray empty_mask_{camera_.width, camera_.height, std::vector<uint8_t>(size_t(camera_.width) * camera_.height, 0)};
  Tracker tracker_;
};

TEST(Tracker, ExchangedFeetStayOnTheirLegs) {
  test::on_every_device([](ocl::DeviceContext& device) {
    constexpr int kMost = 3;
    TrackerScene scene(device, kMost);
    int frame = 0;
    for (; frame < 3; ++frame) EXPECT_LT(scene.track(frame, false), test::kTrackedFeetMm) << frame;
    // As many frames as are allowed on end, then right ones, and the count begins anew.
    for (int round = 0; round < 2; ++round) {
      for (int i = 0; i < kMost; ++i, ++frame) EXPECT_LT(scene.track(frame, true), test::kTrackedFeetMm) << frame;
      EXPECT_LT(scene.track(frame, false), test::kTrackedFeetMm) << frame;
      ++frame;
    }
  });
}

TEST(Tracker, ANetworkThatInsistsIsBelievedWithoutAPicture) {
  test::on_every_device([](ocl::DeviceContext& device) {
    constexpr int kMost = 3;
    TrackerScene scene(device, kMost);
    int frame = 0;
    for (; frame < 3; ++frame) scene.track(frame, false);
    for (int i = 0; i < kMost; ++i, ++frame) EXPECT_LT(scene.track(frame, true), test::kTrackedFeetMm) << frame;
    EXPECT_GT(scene.track(frame++, true), test::kExchangedFeetMm);
    EXPECT_GT(scene.track(frame++, true), test::kExchangedFeetMm);
  });
}

TEST(Tracker, ScatteredKeypointsAreDoubtedForAFewFrames) {
  test::on_every_device([](ocl::DeviceContext& device) {
    TrackerScene scene(device, 0);
    const int most = TrackerOptions().max_doubtful_frames;
    int frame = 0;
    for (; frame < 3; ++frame) scene.track(frame, false);
    for (int i = 0; i < most; ++i, ++frame) EXPECT_EQ(scene.track_scattered(frame), TrackStatus::kOk) << i;
    EXPECT_NE(scene.track_scattered(frame), TrackStatus::kOk);
  });
}

TEST(Tracker, AMissedPersonIsTakenUpAgain) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const int most = TrackerOptions().max_missed_frames;
    TrackerScene scene(device, 0);
    int frame = 0;
    for (; frame < 3; ++frame) scene.track_again(frame);
    for (int missed : {1, 2, most}) {
      for (int i = 0; i < missed; ++i, ++frame) EXPECT_EQ(scene.track_nobody(), TrackStatus::kNobody) << missed;
      EXPECT_EQ(scene.track_again(frame), TrackStatus::kOk) << missed;
      ++frame;
    }
    for (int i = 0; i < most + 1; ++i, ++frame) EXPECT_EQ(scene.track_nobody(), TrackStatus::kNobody);
    EXPECT_EQ(scene.track_again(frame), TrackStatus::kInitialized);
  });
}

// Networks see people in empty rooms.
TEST(Tracker, WhoIsFoundCoversTheSilhouette) {
  test::on_every_device([](ocl::DeviceContext& device) {
    TrackerScene scene(device, 0);
    EXPECT_EQ(scene.track_before_spot(0), TrackStatus::kLost);
    EXPECT_EQ(scene.track_again(1), TrackStatus::kInitialized) << "without a silhouette the network is believed";
    EXPECT_EQ(scene.track_before_spot(2), TrackStatus::kOk) << "who is followed may be hidden";
  });
}

TEST(Tracker, TheRoomsUprightGoesWithEachPose) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const Eigen::Vector3d up = Eigen::Vector3d(0.02, -1, -0.15).normalized();
    TrackerScene scene(device, 0);
    EXPECT_GT((scene.up_at(0) - up).norm(), 0.05);
    scene.set_upright({up, 1e5 * Eigen::Matrix3d::Identity(), 20});
    for (int frame = 1; frame < 4; ++frame) EXPECT_LT((scene.up_at(frame) - up).norm(), 0.01);
    scene.reset();
    EXPECT_LT((scene.up_at(4) - up).norm(), 0.01) << "the camera stands where it stood";
  });
}

TEST(Tracker, WhatIsNotBelievedAfterAMissedFrameIsNobody) {
  test::on_every_device([](ocl::DeviceContext& device) {
    TrackerScene scene(device, 0);
    for (int frame = 0; frame < 3; ++frame) scene.track(frame, false);
    EXPECT_EQ(scene.track_nobody(), TrackStatus::kNobody);
    EXPECT_EQ(scene.track_scattered(4), TrackStatus::kNobody);
    scene.track(5, true);  // ok
    EXPECT_EQ(scene.track_scattered(6), TrackStatus::kOk) << "otherwise it is only doubted";
  });
}

TEST(Tracker, WithoutItTheNetworkIsBelievedAtOnce) {
  test::on_every_device([](ocl::DeviceContext& device) {
    TrackerScene scene(device, 0);
    int frame = 0;
    for (; frame < 3; ++frame) scene.track(frame, false);
    EXPECT_GT(scene.track(frame, true), test::kExchangedFeetMm);
  });
}

}  // namespace
}  // namespace livecap
