// The person's mask in one frame (paper, "Input Stream Processing"): background subtraction against the empty scene,
// gated and steadied by the network's person mask; without an empty scene the network's mask alone. What every pixel
// needs runs on the device (kernels/image/foreground.cl); gate and core, which are coarse, and connected pieces are
// made on the host.
#pragma once

#include <array>
#include <optional>

#include "base/detections.h"
#include "base/image_rgb.h"
#include "image/background_model.h"
#include "image/crop_mask.h"
#include "image/device_frame.h"
#include "image/person_gate.h"
#include "ocl/kernel.h"

namespace livecap {

inline constexpr int kHalfProbability = 128;  // of 255: whose a pixel or cell more likely is

struct ForegroundOptions {
  float gate_margin = 0.08f;   // the network mask grows by this share of the person's height before it gates
  float core_margin = 0.012f;  // and shrinks by this share to the core that is always foreground
  float core_probability = 0.9f;
  float seam = 0.006f;  // what differs so near to the network's mask, share of the height, is never a stranger's
  float stranger_reach = 0.08f;  // how far beyond the gate strangers are looked for, share of the height
  float least_stranger = 0.04f;  // a stranger is at least this share of the person in the picture
  float trust = 2.0f;            // at network probability 1 a difference counts 1 + trust times as much
  float edge_share = 0.45f;      // border pixels with less than this share of the contrast beside them are background
  float smooth_px = 1.0f;        // standard deviation of the smoothing before the decision
  float min_part = 0.02f;        // pieces below this share of the largest one are dropped
  float max_hole = 0.0015f;      // holes below this share of the person's area are closed, and doubt ignored

  void validate() const;  // throws ConfigError
};

// What was found in a picture.
struct ForegroundResult {
  int area_px = 0;
  PixelBox box;  // around all of it; empty when there is nobody
};

// Where in a picture somebody may be, and how it differs from the empty one.
struct ForegroundGate {
  bool has_network = false;  // the network gave a mask
  PersonGate person;
  FrameChange change;
  ImageGray coarse_mask;  // of the network, in cells of kGateCell px
};

// In two halves, which may run beside each other for different frames: find_gate() belongs to the thread of
// gate_device, segment() to that of device, and so does each half's part of a frame (DeviceFrame).
class ForegroundSegmenter {
 public:
  // background: not trained, or of this size (ConfigError); copied to the device. gate_device: the same, perhaps with a
  // queue of its own.
  ForegroundSegmenter(ocl::DeviceContext& device, ocl::DeviceContext& gate_device, const BackgroundModel& background,
                      int width, int height, const ForegroundOptions& options = {});
  ForegroundSegmenter(ocl::DeviceContext& device, const BackgroundModel& background, int width, int height,
                      const ForegroundOptions& options = {})
      : ForegroundSegmenter(device, device, background, width, height, options) {}

  bool has_background() const { return has_background_; }

  // Writes frame.rgb, unless it has the picture, and, where somebody is, frame.mask and `mask` (the same on the host;
  // 255 = person). network_mask: of the frame's size, or empty where the network gave none (then the whole picture is
  // looked at). A mask without anybody, or neither mask nor plate, gives an empty (all zero) result, not an error.
  // Throws ConfigError when sizes differ. Blocking.
  ForegroundResult segment(const ImageRgb& image, const PersonMask& network_mask, DeviceFrame& frame, ImageGray& mask) {
    return segment(image, network_mask, nullptr, frame, mask);
  }
  // So that no frame needs to: memory for masks of crops of size x size.
  void prepare_crop_masks(int size);
  // The network's mask is laid over the picture on the device.
  ForegroundResult segment(const ImageRgb& image, const CropMask& network_mask, DeviceFrame& frame, ImageGray& mask) {
    return segment(image, {}, &network_mask, frame, mask);
  }
  // The same in two halves. crop_mask: nullptr, or instead of network_mask. The first writes frame.rgb and
  // frame.network_mask.
  ForegroundGate find_gate(const ImageRgb& image, const PersonMask& network_mask, const CropMask* crop_mask,
                           DeviceFrame& frame);
  ForegroundResult segment(const ForegroundGate& gate, const PersonMask& network_mask, bool is_crop_mask,
                           DeviceFrame& frame, ImageGray& mask);

  // Of `mask`, which the last segment() gave, what is no dark shadow in any case (BackgroundOptions::doubt_darkest).
  // Nothing where less of the picture is in doubt than a hole that would be closed, or all of the mask is. As in the
  // mask, small pieces are dropped and small holes closed. Blocking.
  std::optional<ForegroundResult> find_sure(const ImageGray& mask);
  // [w*h] 255 = what find_sure() found, if it did.
  const ocl::Buffer<uint8_t>& sure_mask() const { return sure_mask_; }

 private:
  struct KernelArg;
  ocl::DeviceContext& device_;
  ocl::DeviceContext& gate_device_;
  void require_sizes(const ImageRgb& image, const PersonMask& network_mask, const DeviceFrame& frame) const;
  ForegroundResult segment(const ImageRgb& image, const PersonMask& network_mask, const CropMask* crop_mask,
                           DeviceFrame& frame, ImageGray& mask) {
    return segment(find_gate(image, network_mask, crop_mask, frame), network_mask, crop_mask != nullptr, frame, mask);
  }
  void lay_on_device(const CropMask& crop_mask, DeviceFrame& frame);
  void find_person(const DeviceFrame& frame, ForegroundGate& gate);
  void decide(const ForegroundGate& gate, DeviceFrame& frame);

  BackgroundModel background_;
  ForegroundOptions options_;
  bool has_background_;
  int width_, height_;
  int coarse_width_, coarse_height_;
  int reach_;   // of the smoothing, px
  int stride_;  // of the padded planes
  int n_layers_ = 1;

  ocl::Buffer<float> layers_, edge_variance_;
  ocl::Buffer<uint8_t> coarse_, gate_, core_;
  ocl::Buffer<uint8_t> score_, contrast_, beyond_, decided_;  // padded
  ocl::Buffer<uint16_t> smoothed_;                            // padded
  ocl::Buffer<uint16_t> weights_;                             // [reach+1]
  ocl::Buffer<uint8_t> doubtful_, sure_mask_;                 // [w*h]
  ocl::Buffer<int32_t> counts_;                               // of pixels beyond the gate and in doubt
  std::array<int32_t, 2> counts_host_{};
  PixelBox searched_;  // by the last segment()
  int found_px_ = 0;   // likewise, the mask's area
  ocl::Buffer<uint8_t> crop_mask_;
  ocl::Buffer<int32_t> crop_steps_;
  ocl::Kernel lay_mask_;
  ocl::Kernel coarse_means_, foreground_score_, network_score_, score_border_, smooth_rows_, decide_, trim_border_;
  std::vector<uint8_t> beyond_rows_, doubtful_rows_;
  ImageGray sure_;
};

}  // namespace livecap
