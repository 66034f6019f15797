#include "detect/blazepose.h"

#include <algorithm>
#include <cmath>

#include "detect/kernel_args.h"
#include "detect/layout.h"
#include "livecap/error.h"
#include "nn/tflite_import.h"

namespace livecap::detect {
namespace {

constexpr int kHeatmapSize = LC_HEATMAP;
constexpr int kWindow = LC_WINDOW, kRefineReach = kWindow / 2;

static_assert(BlazePose::kLandmarkCount == LC_LANDMARKS && BlazePose::kCropSize == LC_CROP);

// Outputs in the file's order.
enum Output { kLandmarks, kScore, kMask, kHeatmap, kWorld };

float sigmoid(float x) {
  return 1.0f / (1.0f + std::exp(-x));
}

// A logit's probability, 255 = 1. Most pixels of a mask are certain.
uint8_t probability_byte(float logit) {
  if (logit < -6.5f) return 0;
  if (logit > 6.5f) return 255;
  return static_cast<uint8_t>(255 * sigmoid(logit) + 0.5f);
}

nn::Graph load_checked(const std::filesystem::path& model) {
  nn::Graph graph = nn::load_tflite(model);
  const nn::Shape expected[] = {{1, 195}, {1, 1}, {1, 256, 256, 1}, {1, 64, 64, 39}, {1, 117}};
  bool right = graph.inputs.size() == 1 && graph.tensors[graph.inputs[0]].shape == nn::Shape{1, 256, 256, 3} &&
               graph.outputs.size() == std::size(expected);
  for (size_t i = 0; right && i < std::size(expected); ++i)
    right = graph.tensors[graph.outputs[i]].shape == expected[i];
  if (!right) {
    throw IoError(model.string() +
                  ": not a MediaPipe pose landmark network (expected input [1,256,256,3] and outputs [1,195], [1,1], "
                  "[1,256,256,1], "
                  "[1,64,64,39], [1,117])");
  }
  return graph;
}

std::vector<int> requested(bool with_mask) {
  return with_mask ? std::vector<int>{kLandmarks, kScore, kHeatmap, kWorld, kMask}
                   : std::vector<int>{kLandmarks, kScore, kHeatmap, kWorld};
}

struct KeypointSource {
  Keypoint keypoint;
  int count;
  int landmarks[4];
};

// 0 nose, 2/5 eyes, 7/8 ears, 9/10 mouth, 11/12 shoulders, 13/14 elbows, 15/16 wrists, 17-22 fingers, 23/24 hips, 25/26
// knees, 27/28 ankles, 31/32 foot index; odd = left.
constexpr KeypointSource kSources[] = {
    {kHeadTop, 2, {7, 8}},
    {kNeck, 2, {11, 12}},
    {kPelvis, 2, {23, 24}},
    {kLeftHip, 1, {23}},
    {kRightHip, 1, {24}},
    {kLeftShoulder, 1, {11}},
    {kRightShoulder, 1, {12}},
    {kLeftElbow, 1, {13}},
    {kRightElbow, 1, {14}},
    {kLeftWrist, 1, {15}},
    {kRightWrist, 1, {16}},
    {kLeftHand, 4, {15, 17, 19, 21}},
    {kRightHand, 4, {16, 18, 20, 22}},
    {kLeftKnee, 1, {25}},
    {kRightKnee, 1, {26}},
    {kLeftAnkle, 1, {27}},
    {kRightAnkle, 1, {28}},
    {kLeftToe, 1, {31}},
    {kRightToe, 1, {32}},
    {kLeftEye, 1, {2}},
    {kRightEye, 1, {5}},
    {kNose, 1, {0}},
    {kChin, 2, {9, 10}},
};
static_assert(std::size(kSources) == kKeypointCount);

// The landmark whose place this one takes in a mirror: left and right exchanged (1-3 against 4-6, then odd against
// even), nose and crop points stay.
int mirror_partner(int landmark) {
  if (landmark == 0 || landmark >= 33) return landmark;
  if (landmark <= 6) return landmark <= 3 ? landmark + 3 : landmark - 3;
  return landmark % 2 ? landmark + 1 : landmark - 1;
}

// Left to right; image: [width*height*channels].
void mirror(std::span<uint8_t> image, int width, int channels) {
  for (size_t row = 0; row < image.size(); row += size_t(width) * channels) {
    for (int a = 0, b = width - 1; a < b; ++a, --b)
      std::swap_ranges(&image[row + a * channels], &image[row + a * channels] + channels, &image[row + b * channels]);
  }
}

}  // namespace

BlazePose::BlazePose(ocl::DeviceContext& device, const std::filesystem::path& model, bool with_mask)
    : device_(device),
      net_(device, load_checked(model), requested(with_mask)),
      landmarks_(kLandmarkCount * 5),
      score_(1),
      heatmap_(kHeatmapSize * kHeatmapSize * kLandmarkCount),
      world_(kLandmarkCount * 3),
      mask_(with_mask ? kCropSize * kCropSize : 0),
      mask_probability_{kCropSize, kCropSize, std::vector<uint8_t>(mask_.size())} {
  if (device.is_cpu()) return;
  heatmap_.resize(kLandmarkCount * kWindow * kWindow);
  outputs_.resize(landmarks_.size() + score_.size() + world_.size() + heatmap_.size());
  outputs_on_device_ = ocl::Buffer<float>(device, outputs_.size());
  mask_on_device_ = ocl::Buffer<uint8_t>(device, mask_.size());
  steps_ = ocl::Buffer<int32_t>(device, size_t(4) * kCropSize);
  crop_picture_ = {device, kCropProgram, "crop_picture"};
  pose_outputs_ = {device, kCropProgram, "pose_outputs"};
  mask_bytes_ = {device, kCropProgram, "mask_bytes"};
}

void BlazePose::set_picture(const ImageRgb& image, ocl::Buffer<uint8_t>* on_device) {
  image_ = &image;
  if (device_.is_cpu()) return;
  if (!on_device && own_picture_.size() != image.pixels.size())
    own_picture_ = ocl::Buffer<uint8_t>(device_, image.pixels.size());
  ocl::Buffer<uint8_t>& picture = on_device ? *on_device : own_picture_;
  picture.hand_over(device_, image.pixels);
  picture_on_device_ = &picture;
}

// From the picture to landmarks_, score_, world_ and the heat maps' windows, with one read.
void BlazePose::run_on_gpu(const CropRegion& crop) {
  const CropBlocks b = crop_blocks(image_->width, image_->height, crop, kCropSize);
  const BlocksArg blocks{image_->width,
                         b.x_begin,
                         b.y_begin,
                         (b.x_end - b.x_begin) / b.factor,
                         (b.y_end - b.y_begin) / b.factor,
                         b.factor,
                         1.0f / static_cast<float>(b.factor * b.factor)};
  steps_.write_later(fixed_steps(b.from_crop, kCropSize, kCropSize));
  crop_picture_.launch(ocl::Range{kCropSize, kCropSize, 32, 2}, kCropSize, mirrored_ ? 1 : 0, blocks, net_.input_at(),
                       *picture_on_device_, steps_, net_.arena());
  do {
    net_.run();
    pose_outputs_.launch(heatmap_.size(), 64,
                         OutputsArg{net_.output_at(0), net_.output_at(1), net_.output_at(2), net_.output_at(3)},
                         net_.arena(), outputs_on_device_);
    if (!mask_.empty())
      mask_bytes_.launch(mask_.size(), 64, net_.output_at(4), mirrored_ ? 1 : 0, net_.arena(), mask_on_device_);
    outputs_on_device_.read(outputs_);
  } while (net_.gave_up());
  auto from = outputs_.begin();
  for (auto* values : {&landmarks_, &score_, &world_, &heatmap_}) {
    std::copy_n(from, values->size(), values->begin());
    from += static_cast<std::ptrdiff_t>(values->size());
  }
}

// The logit at (x, y) of a landmark's heat map; the landmark lies in (column, row).
float BlazePose::heat(int landmark, int x, int y, int column, int row) const {
  if (device_.is_cpu()) return heatmap_[(size_t(y) * kHeatmapSize + x) * kLandmarkCount + landmark];
  return heatmap_[(size_t(landmark) * kWindow + y - row + kRefineReach) * kWindow + x - column + kRefineReach];
}

// As MediaPipe's "refine landmarks from heatmap": the centre of mass of the probabilities in a window around the
// landmark. positions: fractions of the crop.
void BlazePose::refine(float threshold, std::array<Point2, kLandmarkCount>& positions) const {
  for (int i = 0; i < kLandmarkCount; ++i) {
    Point2& p = positions[i];
    if (!(p.x >= 0 && p.y >= 0 && p.x < 1 && p.y < 1)) continue;
    const int column = static_cast<int>(p.x * kHeatmapSize), row = static_cast<int>(p.y * kHeatmapSize);
    double sum = 0, sum_x = 0, sum_y = 0;
    float best = 0;
    for (int y = std::max(row - kRefineReach, 0); y <= std::min(row + kRefineReach, kHeatmapSize - 1); ++y) {
      for (int x = std::max(column - kRefineReach, 0); x <= std::min(column + kRefineReach, kHeatmapSize - 1); ++x) {
        const float probability = sigmoid(heat(i, x, y, column, row));
        best = std::max(best, probability);
        sum += probability;
        sum_x += probability * x;
        sum_y += probability * y;
      }
    }
    if (best < threshold || !(sum > 0)) continue;
    p = {sum_x / sum / kHeatmapSize, sum_y / sum / kHeatmapSize};
  }
}

void BlazePose::estimate(const CropRegion& crop, float refine_threshold, bool mirrored, PoseEstimate& result) {
  if (!image_) throw LogicError("detect::BlazePose: estimate() before set_picture()");
  mirrored_ = mirrored;
  if (device_.is_cpu()) {
    sampler_.sample(*image_, crop, kCropSize, input_);
    if (mirrored) mirror(input_.pixels, kCropSize, 3);
    net_.set_input_u8(input_.pixels, 1.0f / 255, 0);
    net_.run();
    net_.read_output(0, landmarks_);
    net_.read_output(1, score_);
    net_.read_output(2, heatmap_);
    net_.read_output(3, world_);
  } else {
    run_on_gpu(crop);
  }

  std::array<Point2, kLandmarkCount> positions;
  for (int i = 0; i < kLandmarkCount; ++i)
    positions[i] = {landmarks_[5 * i] / double(kCropSize), landmarks_[5 * i + 1] / double(kCropSize)};
  refine(refine_threshold, positions);

  result.score = std::isfinite(score_[0]) ? score_[0] : 0.0f;
  result.crop = crop;
  result.finite = true;
  result.landmarks.resize(kLandmarkCount);
  for (int i = 0; i < kLandmarkCount; ++i) {
    RawLandmark& landmark = result.landmarks[mirrored ? mirror_partner(i) : i];
    if (mirrored) positions[i].x = 1 - positions[i].x;
    const Point2 p = crop.image_from_crop(positions[i]);
    landmark.x_px = static_cast<float>(p.x);
    landmark.y_px = static_cast<float>(p.y);
    landmark.x_mm = (mirrored ? -1000 : 1000) * world_[3 * i];
    landmark.y_mm = 1000 * world_[3 * i + 1];
    landmark.z_mm = 1000 * world_[3 * i + 2];
    landmark.visibility = sigmoid(landmarks_[5 * i + 3]);
    landmark.presence = sigmoid(landmarks_[5 * i + 4]);
    for (float v : {landmark.x_px, landmark.y_px, landmark.x_mm, landmark.y_mm, landmark.z_mm, landmark.visibility,
                    landmark.presence})
      result.finite = result.finite && std::isfinite(v);
  }
}

const ImageGray& BlazePose::mask_probability() {
  if (mask_.empty()) throw LogicError("detect::BlazePose: made without the mask");
  if (!device_.is_cpu()) {
    mask_on_device_.read(mask_probability_.pixels);
    return mask_probability_;
  }
  net_.read_output(4, mask_);
  std::transform(mask_.begin(), mask_.end(), mask_probability_.pixels.begin(), probability_byte);
  if (mirrored_) mirror(mask_probability_.pixels, kCropSize, 1);
  return mask_probability_;
}

CropRegion BlazePose::next_crop(const PoseEstimate& estimate) {
  const RawLandmark& center = estimate.landmarks[33];
  const RawLandmark& top = estimate.landmarks[34];
  const double dx = double(top.x_px) - center.x_px, dy = double(top.y_px) - center.y_px;
  return {center.x_px, center.y_px, 2.5 * std::hypot(dx, dy), std::atan2(dx, -dy)};
}

std::array<KeypointDetection, kKeypointCount> keypoints_from_landmarks(const std::vector<RawLandmark>& landmarks) {
  std::array<KeypointDetection, kKeypointCount> keypoints{};
  for (const KeypointSource& source : kSources) {
    KeypointDetection& k = keypoints[source.keypoint];
    k.confidence = 1;
    for (int i = 0; i < source.count; ++i) {
      const RawLandmark& l = landmarks.at(source.landmarks[i]);
      k.x_px += l.x_px / source.count;
      k.y_px += l.y_px / source.count;
      k.x_mm += l.x_mm / source.count;
      k.y_mm += l.y_mm / source.count;
      k.z_mm += l.z_mm / source.count;
      k.confidence = std::min({k.confidence, l.visibility, l.presence});
    }
  }
  keypoints[kHeadTop].confidence = 0;
  return keypoints;
}

}  // namespace livecap::detect
