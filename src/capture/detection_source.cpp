#include "capture/detection_source.h"

#include "capture/warm_up.h"
#include "detect/detections_io.h"

namespace livecap {
namespace {

// Between the first crops of two draws of the network's detections, px.
constexpr double kBetweenDraws = 0.01;

ImageRgb black_picture(const Camera& camera) {
  return {camera.width, camera.height, std::vector<uint8_t>(size_t(3) * camera.width * camera.height, 0)};
}

}  // namespace

DetectionSource::DetectionSource(const DetectionOptions& options, ocl::DeviceContext& device)
    : missed_share_(options.missed_share) {
  if (!options.recorded.empty()) {
    recorded_ = detect::load_detections(options.recorded);
    return;
  }
  detect::PoseDetectorOptions detector;
  detector.model = options.model;
  detector.lay_mask = false;
  detector.first_crop_aside_px = kBetweenDraws * options.draw;
  network_.emplace(device, detector);
}

void DetectionSource::warm_up(const Camera& camera) {
  if (network_) warm_up_detector(*network_, camera);
}

void DetectionSource::start_over() {
  if (network_) network_->reset();
  next_ = 0;
}

Detections DetectionSource::detect(const ImageRgb& image, const Camera& camera, int64_t frame_index, double time_s,
                                   ocl::Buffer<uint8_t>* on_device) {
  const bool missed = is_missed(frame_index);
  if (network_ && missed) return network_->detect(black_picture(camera), camera, frame_index, time_s);
  if (network_) return network_->detect(image, camera, frame_index, time_s, on_device);
  for (; next_ < recorded_.size() && recorded_[next_].frame_index <= frame_index; ++next_) {
    if (recorded_[next_].frame_index == frame_index && !missed) return recorded_[next_];
  }
  Detections nobody;
  nobody.frame_index = frame_index;
  return nobody;
}

// One in 1 / share of the frames, the same in every run: the hash of SplitMix64 (Steele et al. 2014).
bool DetectionSource::is_missed(int64_t frame_index) const {
  uint64_t x = (static_cast<uint64_t>(frame_index) + 1) * 0x9e3779b97f4a7c15ull;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
  return static_cast<double>((x ^ (x >> 31)) >> 11) * 0x1p-53 < missed_share_;
}

}  // namespace livecap
