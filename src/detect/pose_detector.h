// One person's pose in every frame of a video: crop tracking, the network, 1 euro filters (paper, "Joint Detection"
// after VNect). The result is a deterministic function of the frames since construction or reset().
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "base/detections.h"
#include "base/image_rgb.h"
#include "detect/blazepose.h"
#include "detect/jump_gate.h"
#include "detect/mirror_bias.h"
#include "detect/one_euro.h"
#include "detect/posture.h"
#include "detect/side_tracker.h"
#include "livecap/camera.h"

namespace livecap::detect {

struct PoseDetectorOptions {
  std::string model = "full";     // lite, full, heavy, or the path of a .tflite file
  bool mask = true;               // also the person mask
  bool lay_mask = true;           // over the whole image; else Detections::crop_mask
  float score_threshold = 0.5f;   // below: nobody
  float refine_threshold = 0.5f;  // heatmap probability from which landmarks are refined; > 1 switches it off
  // Every second picture of a followed person is shown to the network in the mirror. Its errors on a picture and on the
  // mirror image differ, and the filters average over the two at no cost.
  bool alternate_mirror = true;
  // So many frames after a person was last seen they are first looked for where they were, and their filters' past is
  // kept: networks miss single frames.
  int max_missed_frames = 5;
  // A person just found is looked at with ever closer crops until two looks agree. If none do, the person is reported,
  // but looked for anew in the next frame, at most so many frames on end; then followed all the same.
  int max_unsettled_frames = 5;
  bool keep_sides = true;  // undo sudden exchanges of left and right
  SideTrackerOptions sides;
  bool drop_jumps = true;  // keypoints that cannot have got there in a frame stay where they were
  JumpGateOptions jumps;
  bool correct_posture = true;
  PostureOptions posture;
  // Moves the first crop of a person aside. A hundredth of a pixel changes what the network sees in it by next to
  // nothing and all that follows by as much as chance does (docs/evaluation.md#draws): a test.
  double first_crop_aside_px = 0;
  bool filter = true;  // 1 euro filters on the keypoints
  // Cut-off and beta as VNect has them. 2D speed is in px of the network's 256 px crop per second, so that the video's
  // size does not matter; 3D speed in cm per second. With the usual 1 Hz on the speed itself quick limbs lag by several
  // frames.
  OneEuroOptions filter_2d{1.7, 0.3, 10.0};
  OneEuroOptions filter_3d{0.8, 0.4, 10.0};

  // Throws ConfigError.
  void validate() const;
};

// Not thread-safe; uses the device's queue during detect().
class PoseDetector {
 public:
  // Throws IoError (model), ConfigError (options), OclError.
  PoseDetector(ocl::DeviceContext& device, const PoseDetectorOptions& options);

  // undistorted: the camera's size, else ConfigError. frame_index: only passed on. time_s: of the frame, rising (else a
  // thirtieth of a second is taken to have passed). Nobody in view gives person = false and the next frame is also
  // searched as a whole; it is never an error. on_device: see BlazePose::set_picture.
  Detections detect(const ImageRgb& undistorted, const Camera& camera, int64_t frame_index, double time_s,
                    ocl::Buffer<uint8_t>* on_device = nullptr);

  // Forgets the person and the filters' past.
  void reset();

  // The network's own landmarks of the last frame (before sides, jumps, posture and filters; 3D in camera axes, mm,
  // mid-hip origin). Empty when nobody was found.
  const std::vector<RawLandmark>& raw_landmarks() const { return raw_; }

  // The crop of the last frame's result.
  const CropRegion& crop() const { return estimate_.crop; }

 private:
  void forget_person();
  bool plausible(const CropRegion& crop, const ImageRgb& image) const;
  bool accept(const ImageRgb& image);
  bool find_person(const ImageRgb& image);
  bool look_closer(const ImageRgb& image);
  void turn_to_camera_axes(const Camera& camera);
  void drop_jumps(double dt_s, double mm_per_px, Detections& detections);
  void filter_keypoints(double dt_s, Detections& detections);

  PoseDetectorOptions options_;
  BlazePose network_;
  PoseEstimate estimate_;
  std::vector<RawLandmark> raw_;
  bool tracking_ = false;
  int missed_ = 0;        // frames on end without the person that is followed
  CropRegion next_crop_;  // of what accept() saw last
  CropRegion followed_;   // where the person that is followed is expected
  bool mirror_next_ = false;
  bool mirrored_ = false;  // the last picture
  MirrorBias mirror_bias_;
  bool settled_ = false;  // whether looks at who was found last agree; else they are looked for anew in the next frame
  int unsettled_ = 0;     // frames on end in which they did not
  int search_step_ = 0;   // which window is tried next while nobody is found
  std::optional<double> last_time_s_;  // of the last frame with the person that is followed; without one, of the last
  SideTracker sides_;
  JumpGate jumps_;
  Posture posture_;
  std::array<std::array<OneEuroFilter, 5>, kKeypointCount> filters_;
};

}  // namespace livecap::detect
