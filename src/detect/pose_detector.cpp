#include "detect/pose_detector.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/text.h"
#include "detect/find_model.h"
#include "livecap/error.h"

namespace livecap::detect {
namespace {

constexpr int kSearchWindows = 3;  // along the longer side of the image

constexpr double kUsualPeriodS = 1.0 / 30;  // from frame to frame where times do not say

constexpr double kCropMm = 2000;  // roughly what the side of a person's crop measures

// A square of the image's shorter side, at one of kSearchWindows places along the longer one: the middle first.
CropRegion search_window(int width, int height, int step) {
  const int order[kSearchWindows] = {1, 0, 2};
  const double side = std::min(width, height);
  const double slack = std::max(width, height) - side;
  const double start = 0.5 * (side - 1) + slack * order[step % kSearchWindows] / (kSearchWindows - 1);
  return width > height ? CropRegion{start, 0.5 * (height - 1), side, 0}
                        : CropRegion{0.5 * (width - 1), start, side, 0};
}

// The whole picture shows a person small, and in a crop that is too large the network may take front for back. Looks at
// things in a room were not seen to agree (docs/experiments.md).
constexpr int kMostLooks = 6;
constexpr double kSettledCrop = 0.08;        // of its side
constexpr double kSettledLandmarks = 0.015;  // of the crop's side; people 0.003 to 0.012, things 0.02 to 0.1
constexpr float kSeen = 0.5f;                // presence
constexpr int kLeastSeen = 4;

// Mean distance of those shoulders, elbows, wrists, hips, knees and ankles that are in both pictures; infinite where
// too few are.
double distance_px(const std::vector<RawLandmark>& a, const std::vector<RawLandmark>& b) {
  constexpr int kJoints[] = {11, 12, 13, 14, 15, 16, 23, 24, 25, 26, 27, 28};
  double sum = 0;
  int n_seen = 0;
  for (const int i : kJoints) {
    if (!(a[i].presence >= kSeen && b[i].presence >= kSeen)) continue;
    sum += std::hypot(a[i].x_px - b[i].x_px, a[i].y_px - b[i].y_px);
    ++n_seen;
  }
  return n_seen < kLeastSeen ? std::numeric_limits<double>::infinity() : sum / n_seen;
}

using Matrix3 = std::array<std::array<double, 3>, 3>;

// The smallest rotation that takes the optical axis (0,0,1) to the unit vector d (d.z > 0): R = I + [v] + [v]^2 / (1 +
// d.z) with v = z x d.
Matrix3 rotation_from_axis_to(double dx, double dy, double dz) {
  const double k = 1.0 / (1.0 + dz);
  return {{{1 - k * dx * dx, -k * dx * dy, dx}, {-k * dx * dy, 1 - k * dy * dy, dy}, {-dx, -dy, dz}}};
}

}  // namespace

void PoseDetectorOptions::validate() const {
  if (!(score_threshold >= 0 && score_threshold <= 1))
    throw ConfigError(format("score threshold %g must be in 0..1", double(score_threshold)));
  if (!std::isfinite(first_crop_aside_px))
    throw ConfigError(format("first crop aside by %g px: must be finite", first_crop_aside_px));
  if (!(refine_threshold >= 0))
    throw ConfigError(format("heatmap threshold %g must not be negative", double(refine_threshold)));
  if (max_missed_frames < 0) throw ConfigError(format("max_missed_frames %d must not be negative", max_missed_frames));
  if (max_unsettled_frames < 0)
    throw ConfigError(format("max_unsettled_frames %d must not be negative", max_unsettled_frames));
  sides.validate();
  jumps.validate();
  posture.validate();
  filter_2d.validate();
  filter_3d.validate();
}

PoseDetector::PoseDetector(ocl::DeviceContext& device, const PoseDetectorOptions& options)
    : options_((options.validate(), options)), network_(device, find_model(options.model), options.mask) {}

void PoseDetector::reset() {
  forget_person();
  search_step_ = 0;
  unsettled_ = 0;
  last_time_s_.reset();
  posture_.reset();
}

// What is known of the picture stays: where was searched, how the camera is tilted.
void PoseDetector::forget_person() {
  tracking_ = false;
  missed_ = 0;
  mirror_next_ = false;
  raw_.clear();
  mirrored_ = false;
  mirror_bias_.reset();
  sides_.reset();
  jumps_.reset();
  for (auto& keypoint : filters_) {
    for (OneEuroFilter& filter : keypoint) filter.reset();
  }
}

bool PoseDetector::plausible(const CropRegion& crop, const ImageRgb& image) const {
  const double longest = std::max(image.width, image.height);
  return std::isfinite(crop.center_x_px) && std::isfinite(crop.center_y_px) && std::isfinite(crop.side_px) &&
         std::isfinite(crop.angle_rad) && crop.side_px >= 16 && crop.side_px <= 8 * longest &&
         crop.center_x_px > -0.5 * crop.side_px && crop.center_y_px > -0.5 * crop.side_px &&
         crop.center_x_px < image.width + 0.5 * crop.side_px && crop.center_y_px < image.height + 0.5 * crop.side_px;
}

// True when the estimate holds a person that can be followed; then also says where to look next.
bool PoseDetector::accept(const ImageRgb& image) {
  if (!(estimate_.score >= options_.score_threshold) || !estimate_.finite) return false;
  next_crop_ = BlazePose::next_crop(estimate_);
  return plausible(next_crop_, image);
}

// Somebody who was found just now, seen with the crop of the look before until looks agree. A later look that sees
// nobody is taken back.
bool PoseDetector::look_closer(const ImageRgb& image) {
  settled_ = false;
  CropRegion last;
  for (int look = 0; look < kMostLooks && !settled_; ++look) {
    const CropRegion crop = next_crop_;
    const std::vector<RawLandmark> before = estimate_.landmarks;
    network_.estimate(crop, options_.refine_threshold, false, estimate_);
    if (!accept(image)) {
      if (look == 0) return false;
      network_.estimate(last, options_.refine_threshold, false, estimate_);
      return accept(image);
    }
    last = crop;
    const double moved = distance_px(before, estimate_.landmarks) / crop.side_px;
    const double grown = std::abs(std::log(next_crop_.side_px / crop.side_px));
    settled_ = moved < kSettledLandmarks && grown < kSettledCrop;
  }
  return true;
}

bool PoseDetector::find_person(const ImageRgb& image) {
  if (tracking_) {
    mirrored_ = mirror_next_;
    network_.estimate(followed_, options_.refine_threshold, mirrored_, estimate_);
    mirror_next_ = options_.alternate_mirror && !mirror_next_;
    if (accept(image)) return true;
    if (missed_ == 0) return false;  // one frame is often just missed
  }
  // The whole image; if nobody is there a closer look at a part of it, another one each frame.
  network_.estimate(whole_image_crop(image.width, image.height), options_.refine_threshold, false, estimate_);
  bool found = accept(image);
  if (!found && !tracking_ && image.width != image.height) {
    network_.estimate(search_window(image.width, image.height, search_step_++), options_.refine_threshold, false,
                      estimate_);
    found = accept(image);
  }
  if (!found) return false;
  if (!look_closer(image) || (tracking_ && !settled_)) return false;
  forget_person();  // found elsewhere: the filters' past is of no use
  return true;
}

// 3D points from the crop's camera to the image's: by the crop's roll, then, because the network takes every crop for
// the picture of a camera that looks straight at it, from the optical axis to the viewing ray of its centre. Origin
// mid-hip.
void PoseDetector::turn_to_camera_axes(const Camera& camera) {
  const CropRegion& crop = estimate_.crop;
  const double x = (crop.center_x_px - camera.cx) / camera.fx;
  const double y = (crop.center_y_px - camera.cy) / camera.fy;
  const double n = std::sqrt(x * x + y * y + 1);
  const Matrix3 ray = rotation_from_axis_to(x / n, y / n, 1 / n);
  const double c = std::cos(crop.angle_rad), s = std::sin(crop.angle_rad);
  for (RawLandmark& l : raw_) {
    const double p[3] = {c * l.x_mm - s * l.y_mm, s * l.x_mm + c * l.y_mm, l.z_mm};
    l.x_mm = static_cast<float>(ray[0][0] * p[0] + ray[0][1] * p[1] + ray[0][2] * p[2]);
    l.y_mm = static_cast<float>(ray[1][0] * p[0] + ray[1][1] * p[1] + ray[1][2] * p[2]);
    l.z_mm = static_cast<float>(ray[2][0] * p[0] + ray[2][1] * p[1] + ray[2][2] * p[2]);
  }
  const float origin[3] = {(raw_[23].x_mm + raw_[24].x_mm) / 2, (raw_[23].y_mm + raw_[24].y_mm) / 2,
                           (raw_[23].z_mm + raw_[24].z_mm) / 2};
  for (RawLandmark& l : raw_) {
    l.x_mm -= origin[0];
    l.y_mm -= origin[1];
    l.z_mm -= origin[2];
  }
}

void PoseDetector::drop_jumps(double dt_s, double mm_per_px, Detections& detections) {
  if (sides_.changed_sides()) jumps_.reset();
  jumps_.update(options_.jumps, dt_s, mm_per_px, detections.keypoints);
}

void PoseDetector::filter_keypoints(double dt_s, Detections& detections) {
  const double crop_px = BlazePose::kCropSize / estimate_.crop.side_px;
  const double cm = 0.1;
  for (int i = 0; i < kKeypointCount; ++i) {
    KeypointDetection& k = detections.keypoints[i];
    auto& filter = filters_[i];
    k.x_px = static_cast<float>(filter[0].filter(options_.filter_2d, k.x_px, dt_s, crop_px));
    k.y_px = static_cast<float>(filter[1].filter(options_.filter_2d, k.y_px, dt_s, crop_px));
    k.x_mm = static_cast<float>(filter[2].filter(options_.filter_3d, k.x_mm, dt_s, cm));
    k.y_mm = static_cast<float>(filter[3].filter(options_.filter_3d, k.y_mm, dt_s, cm));
    k.z_mm = static_cast<float>(filter[4].filter(options_.filter_3d, k.z_mm, dt_s, cm));
  }
}

Detections PoseDetector::detect(const ImageRgb& undistorted, const Camera& camera, int64_t frame_index, double time_s,
                                ocl::Buffer<uint8_t>* on_device) {
  if (undistorted.empty() || undistorted.width != camera.width || undistorted.height != camera.height)
    throw ConfigError(format("frame %lld is %dx%d, the camera's pictures are %dx%d",
                             static_cast<long long>(frame_index), undistorted.width, undistorted.height, camera.width,
                             camera.height));
  Detections detections;
  detections.frame_index = frame_index;
  network_.set_picture(undistorted, on_device);
  const bool found = find_person(undistorted);
  detections.score = estimate_.score;
  if (!found) {
    raw_.clear();
    mirror_bias_.interrupt();
    if (!tracking_ || ++missed_ > options_.max_missed_frames) forget_person();
    if (!tracking_) last_time_s_ = time_s, unsettled_ = 0;
    return detections;
  }
  detections.person = true;
  search_step_ = 0;
  raw_ = estimate_.landmarks;
  turn_to_camera_axes(camera);
  detections.keypoints = keypoints_from_landmarks(raw_);
  if (options_.alternate_mirror) mirror_bias_.update(mirrored_, detections.keypoints);
  const double dt_s = last_time_s_ && time_s > *last_time_s_ ? time_s - *last_time_s_ : kUsualPeriodS;
  const double mm_per_px = kCropMm / estimate_.crop.side_px;
  if (options_.keep_sides) sides_.update(options_.sides, dt_s, mm_per_px, detections.keypoints);
  if (options_.drop_jumps) drop_jumps(dt_s, mm_per_px, detections);
  if (options_.correct_posture) posture_.update(options_.posture, dt_s, detections.keypoints);
  if (options_.filter) filter_keypoints(dt_s, detections);
  if (options_.mask && options_.lay_mask) {
    warp_mask(network_.mask_probability(), estimate_.crop, undistorted.width, undistorted.height, detections.mask);
  } else if (options_.mask) {
    detections.crop_mask = std::make_shared<const CropMask>(
        place_mask(network_.mask_probability(), estimate_.crop, undistorted.width, undistorted.height));
  }
  followed_ = next_crop_;
  if (!tracking_) {
    followed_.center_x_px += options_.first_crop_aside_px;
    tracking_ = settled_ || unsettled_ >= options_.max_unsettled_frames;
    unsettled_ = tracking_ ? 0 : unsettled_ + 1;
  }
  missed_ = 0;
  last_time_s_ = time_s;
  return detections;
}

}  // namespace livecap::detect
