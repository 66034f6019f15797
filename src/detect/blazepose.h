// MediaPipe Pose (BlazePose GHUM, pose_landmark_{lite,full,heavy}.tflite): what its inputs and outputs mean. Another
// network (VNect's location maps, say) is another file that gives a PoseEstimate for a crop, and the next crop.
#pragma once

#include <array>
#include <filesystem>
#include <vector>

#include "base/image_rgb.h"
#include "detect/crop.h"
#include "nn/executor.h"

namespace livecap::detect {

// One landmark of the network, before it becomes an observation keypoint.
struct RawLandmark {
  float x_px = 0;  // image, pixel centres at integers
  float y_px = 0;
  float x_mm = 0;  // in the axes of the crop's own camera, origin near the mid-hip
  float y_mm = 0;
  float z_mm = 0;
  float visibility = 0;  // probability that it is in the picture and not hidden
  float presence = 0;    // probability that it is in the picture
};

// What the network saw in one crop.
struct PoseEstimate {
  float score = 0;  // probability that the crop holds a person
  CropRegion crop;
  bool finite = true;  // every landmark is a number
  std::vector<RawLandmark>
      landmarks;  // [39]: 33 of the body, two for the crop (33 centre, 34 scale and up), four unused
};

class BlazePose {
 public:
  static constexpr int kLandmarkCount = 39;
  static constexpr int kCropSize = 256;  // px

  // Throws IoError naming the file when it is not this network.
  BlazePose(ocl::DeviceContext& device, const std::filesystem::path& model, bool with_mask);

  // The picture of the estimates that follow, which must stay as it is until the last of them. on_device: of the
  // picture's size, in memory that this network's queue reaches; a GPU has the picture there after the first estimate.
  void set_picture(const ImageRgb& image, ocl::Buffer<uint8_t>* on_device = nullptr);

  // refine_threshold: heatmap probability from which a landmark is moved to its heatmap's centre of mass.
  // mirrored: the network is shown the crop's mirror image. The result is turned back: its errors differ, nothing else.
  void estimate(const CropRegion& crop, float refine_threshold, bool mirrored, PoseEstimate& result);

  // Person probability over the last estimated crop, kCropSize x kCropSize, 255 = 1. Only with_mask.
  const ImageGray& mask_probability();

  // Where to look next: centre = landmark 33, side = 2.5 |l34 - l33|, 33 to 34 points up.
  static CropRegion next_crop(const PoseEstimate& estimate);

 private:
  void run_on_gpu(const CropRegion& crop);
  float heat(int landmark, int x, int y, int column, int row) const;
  void refine(float threshold, std::array<Point2, kLandmarkCount>& positions) const;

  ocl::DeviceContext& device_;
  nn::Executor net_;
  const ImageRgb* image_ = nullptr;
  CropSampler sampler_;
  ImageRgb input_;
  std::vector<float> landmarks_;  // [39*5] x, y, z in crop px, visibility and presence logits
  std::vector<float> score_;      // [1]
  std::vector<float> heatmap_;    // [64*64*39] logits; GPUs: [39*7*7] around each landmark
  std::vector<float> world_;      // [39*3] m
  bool mirrored_ = false;         // the last estimate
  std::vector<float> mask_;       // [256*256] logits
  ImageGray mask_probability_;    // of the last estimate
  // GPUs crop the picture and look at the outputs on the device.
  std::vector<float> outputs_;
  ocl::Buffer<uint8_t> own_picture_;
  const ocl::Buffer<uint8_t>* picture_on_device_ = nullptr;
  ocl::Buffer<int32_t> steps_;
  ocl::Buffer<float> outputs_on_device_;
  ocl::Buffer<uint8_t> mask_on_device_;
  ocl::Kernel crop_picture_, pose_outputs_, mask_bytes_;
};

// The 23 observation keypoints from the network's landmarks: positions and confidences are means and minima of the
// landmarks a keypoint is made of. Confidence = min(visibility, presence): a landmark that is in the picture but
// hidden, and one that is outside it, both count little. The crown of the head is unknown (confidence 0, placed between
// the ears).
std::array<KeypointDetection, kKeypointCount> keypoints_from_landmarks(const std::vector<RawLandmark>& landmarks);

}  // namespace livecap::detect
