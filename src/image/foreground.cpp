#include "image/foreground.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "base/text.h"
#include "image/foreground_pieces.h"
#include "image/layout.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr char kForegroundFile[] = "image/image.cl";
constexpr int kPad = 48;  // rows and columns around the padded planes: the longest reach of the smoothing and a group
constexpr float kMaxSmoothPx = 10;
constexpr size_t kGroup = 16;

static_assert(kGateCell == LC_COARSE);

int groups_of(int pixels) {
  return (pixels + LC_LANES - 1) / LC_LANES;
}

// Half of a normal distribution's bell in 1/256, from the middle on; as far as OpenCV's for 8-bit pictures.
std::vector<uint16_t> smoothing_weights(float sigma) {
  if (!(sigma > 0)) return {256};
  const int reach = (static_cast<int>(std::lround(sigma * 6 + 1)) | 1) / 2;
  std::vector<double> bell(reach + 1);
  for (int i = 0; i <= reach; ++i) bell[i] = std::exp(-0.5 * i * i / (double(sigma) * sigma));
  const double sum = 2 * std::accumulate(bell.begin() + 1, bell.end(), 0.0) + bell[0];
  std::vector<uint16_t> weights(reach + 1);
  int rest = 256;
  for (int i = 1; i <= reach; ++i) {
    weights[i] = static_cast<uint16_t>(std::lround(256 * bell[i] / sum));
    rest -= 2 * weights[i];
  }
  weights[0] = static_cast<uint16_t>(rest);
  return weights;
}

}  // namespace

// ForegroundArg of the kernels.
struct ForegroundSegmenter::KernelArg {
  int32_t width, height, x0, n_groups, y0, n_rows, stride, pad, coarse_width, n_layers, has_network;
  float inverse_gain[3], least_variance, shadow_darkest, doubt_darkest, at_threshold, trust;
};

void ForegroundOptions::validate() const {
  if (!(gate_margin >= 0 && gate_margin <= 1) || !(core_margin >= 0 && core_margin <= 1))
    throw ConfigError("foreground: margins must be in 0..1");
  if (!(core_probability > 0 && core_probability <= 1))
    throw ConfigError("foreground: core_probability must be in (0, 1]");
  if (!(seam >= 0 && seam <= 1) || !(stranger_reach >= 0 && stranger_reach <= 1) ||
      !(least_stranger >= 0 && least_stranger <= 1))
    throw ConfigError("foreground: seam, stranger_reach and least_stranger must be in 0..1");
  if (!(min_part >= 0 && min_part <= 1) || !(max_hole >= 0 && max_hole <= 1))
    throw ConfigError("foreground: min_part and max_hole must be in 0..1");
  if (!(smooth_px >= 0 && smooth_px <= kMaxSmoothPx)) throw ConfigError("foreground: smooth_px must be in 0..10");
}

ForegroundSegmenter::ForegroundSegmenter(ocl::DeviceContext& device, ocl::DeviceContext& gate_device,
                                         const BackgroundModel& background, int width, int height,
                                         const ForegroundOptions& options)
    : device_(device),
      gate_device_(gate_device),
      background_(background),
      options_(options),
      has_background_(background.trained()),
      width_(width),
      height_(height),
      coarse_width_((width + kGateCell - 1) / kGateCell),
      coarse_height_((height + kGateCell - 1) / kGateCell) {
  options_.validate();
  if (width <= 0 || height <= 0) throw ConfigError(format("foreground: picture of %dx%d", width, height));
  if (has_background_ && (background.width() != width || background.height() != height))
    throw ConfigError(
        format("background plate is %dx%d, the video %dx%d", background.width(), background.height(), width, height));
  const size_t n_cells = size_t(coarse_width_) * coarse_height_;
  stride_ = groups_of(width) * LC_LANES + 2 * kPad;
  const size_t padded = size_t(stride_) * (height + 2 * kPad);
  const std::vector<uint16_t> weights =
      smoothing_weights(has_background_ ? options.smooth_px : std::max(0.5f, options.smooth_px));
  reach_ = static_cast<int>(weights.size()) - 1;
  weights_ = ocl::Buffer<uint16_t>(device, weights);
  std::vector<float> planes;
  for (const BackgroundModel::Layer& layer : background.layers()) {
    for (const auto* plane : {&layer.mean[0], &layer.mean[1], &layer.mean[2], &layer.variance})
      planes.insert(planes.end(), plane->begin(), plane->end());
  }
  n_layers_ = static_cast<int>(background.layers().size());
  layers_ = ocl::Buffer<float>(device, planes);
  edge_variance_ = ocl::Buffer<float>(device, background.edge_variance());
  coarse_ = ocl::Buffer<uint8_t>(gate_device, n_cells);
  for (auto* cells : {&gate_, &core_}) *cells = ocl::Buffer<uint8_t>(device, n_cells);
  const std::vector<uint8_t> zeros(padded, 0);
  for (auto* plane : {&score_, &contrast_, &beyond_, &decided_}) *plane = ocl::Buffer<uint8_t>(device, zeros);
  smoothed_ = ocl::Buffer<uint16_t>(device, padded);
  smoothed_.fill(0);
  for (auto* plane : {&doubtful_, &sure_mask_}) *plane = ocl::Buffer<uint8_t>(device, size_t(width) * height);
  sure_.pixels.reserve(size_t(width) * height);
  doubtful_rows_.reserve(size_t(width) * height);
  counts_ = ocl::Buffer<int32_t>(device, 2);
  crop_steps_ = ocl::Buffer<int32_t>(gate_device, size_t(2) * (width + height));
  lay_mask_ = ocl::Kernel(gate_device, kForegroundFile, "lay_mask");
  coarse_means_ = ocl::Kernel(gate_device, kForegroundFile, "coarse_means");
  foreground_score_ = ocl::Kernel(device, kForegroundFile, "foreground_score");
  network_score_ = ocl::Kernel(device, kForegroundFile, "network_score");
  score_border_ = ocl::Kernel(device, kForegroundFile, "score_border");
  smooth_rows_ = ocl::Kernel(device, kForegroundFile, "smooth_rows");
  decide_ = ocl::Kernel(device, kForegroundFile, "decide");
  trim_border_ = ocl::Kernel(device, kForegroundFile, "trim_border");
}

void ForegroundSegmenter::require_sizes(const ImageRgb& image, const PersonMask& network_mask,
                                        const DeviceFrame& frame) const {
  if (image.pixels.size() != size_t(3) * image.width * image.height) throw LogicError("foreground: malformed frame");
  if (image.width != width_ || image.height != height_)
    throw ConfigError(
        format("foreground is for pictures of %dx%d, the video has %dx%d", width_, height_, image.width, image.height));
  if (!network_mask.empty() && (network_mask.width != width_ || network_mask.height != height_))
    throw ConfigError(
        format("network mask is %dx%d, the video %dx%d", network_mask.width, network_mask.height, width_, height_));
  if (frame.width != width_ || frame.height != height_) throw LogicError("foreground: device frame of another size");
}

void ForegroundSegmenter::prepare_crop_masks(int size) {
  const size_t n = size_t(size) * size;
  if (crop_mask_.size() != n) crop_mask_ = ocl::Buffer<uint8_t>(gate_device_, n);
}

// Into frame.network_mask.
void ForegroundSegmenter::lay_on_device(const CropMask& crop_mask, DeviceFrame& frame) {
  const int size = crop_mask.probability.width;
  const PixelBox& box = crop_mask.box;
  if (box.empty() || size == 0) {
    frame.network_mask.fill(0);
    return;
  }
  if (box.x0 < 0 || box.y0 < 0 || box.x1 > width_ || box.y1 > height_ || crop_mask.probability.height != size)
    throw LogicError("foreground: the network's mask lies outside the picture");
  prepare_crop_masks(size);
  crop_mask_.hand_over(crop_mask.probability.pixels);
  AffineMap from_box = crop_mask.mask_from_image;
  from_box.x0 += from_box.xx * box.x0 + from_box.xy * box.y0;
  from_box.y0 += from_box.yx * box.x0 + from_box.yy * box.y0;
  crop_steps_.write_later(fixed_steps(from_box, box.width(), box.height()));
  struct MaskArg {  // of the kernel
    int32_t width, height, x0, y0, x1, y1, size;
  };
  const size_t items = gate_device_.is_cpu() ? groups_of(width_) : width_;
  const size_t columns = (items + kGroup - 1) / kGroup * kGroup;
  lay_mask_.launch(ocl::Range{columns, static_cast<size_t>(height_), kGroup, 1},
                   MaskArg{width_, height_, box.x0, box.y0, box.x1, box.y1, size}, crop_mask_, crop_steps_,
                   frame.network_mask);
}

// Of frame.network_mask.
void ForegroundSegmenter::find_person(const DeviceFrame& frame, ForegroundGate& gate) {
  const int n_groups = groups_of(width_);
  gate.coarse_mask = {coarse_width_, coarse_height_, std::vector<uint8_t>(coarse_.size())};
  coarse_means_.launch(ocl::Range{groups_of(n_groups) * kGroup, static_cast<size_t>(coarse_height_), kGroup, 1},
                       n_groups, width_, height_, coarse_width_, coarse_height_, frame.network_mask, coarse_);
  coarse_.read(gate.coarse_mask.pixels);
  gate.person = find_person_gate(gate.coarse_mask, width_, height_, options_);
}

ForegroundGate ForegroundSegmenter::find_gate(const ImageRgb& image, const PersonMask& network_mask,
                                              const CropMask* crop_mask, DeviceFrame& frame) {
  require_sizes(image, network_mask, frame);
  ForegroundGate gate;
  gate.has_network = crop_mask || !network_mask.empty();
  if (!frame.has_picture) frame.rgb.hand_over(image.pixels);
  if (gate.has_network) {
    if (crop_mask) {
      lay_on_device(*crop_mask, frame);
    } else {
      frame.network_mask.hand_over(network_mask.probability);
    }
    find_person(frame, gate);
  } else {
    gate_device_.finish();
    if (has_background_) gate.person.search = {0, 0, width_, height_};
  }
  if (has_background_ && !gate.person.search.empty())
    gate.change = background_.estimate_change(image, gate.person.gate, kGateCell);
  return gate;
}

// From the picture on the device to the mask on the device, within the gate's search.
void ForegroundSegmenter::decide(const ForegroundGate& gate, DeviceFrame& frame) {
  const PixelBox& box = gate.person.search;
  if (gate.has_network) {
    gate_.hand_over(gate.person.gate.pixels);
    core_.hand_over(gate.person.core.pixels);
  }
  KernelArg arg{};
  arg.width = width_;
  arg.height = height_;
  arg.x0 = box.x0 / LC_LANES * LC_LANES;
  arg.n_groups = groups_of(box.x1 - arg.x0);
  arg.y0 = box.y0;
  arg.n_rows = box.height();
  arg.stride = stride_;
  arg.pad = kPad;
  arg.coarse_width = coarse_width_;
  arg.n_layers = n_layers_;
  arg.has_network = gate.has_network;
  const auto range = [&](int rows) {
    return ocl::Range{groups_of(arg.n_groups) * kGroup, static_cast<size_t>(rows), kGroup, 1};
  };
  counts_.fill(0);
  if (has_background_) {
    for (int c = 0; c < 3; ++c) arg.inverse_gain[c] = 1 / gate.change.gain[c];
    arg.least_variance = background_.least_variance(gate.change);
    arg.shadow_darkest = background_.options().shadow_darkest;
    arg.doubt_darkest = background_.options().doubt_darkest;
    arg.at_threshold = 128 / (background_.options().match_sigmas * background_.options().match_sigmas);
    arg.trust = options_.trust;
    foreground_score_.launch(range(arg.n_rows), arg, frame.rgb, frame.network_mask, gate_, core_, layers_,
                             edge_variance_, score_, contrast_, beyond_, doubtful_, counts_);
  } else {
    network_score_.launch(range(arg.n_rows), arg, frame.network_mask, score_);
  }
  score_border_.launch(arg.n_rows + 2 * reach_, kGroup, arg, reach_, score_);
  smooth_rows_.launch(range(arg.n_rows + 2 * reach_), arg, reach_, weights_, score_, smoothed_);
  decide_.launch(range(arg.n_rows), arg, reach_, weights_, smoothed_, decided_);
  trim_border_.launch(range(arg.n_rows), arg, has_background_ ? options_.edge_share : 0.0f, decided_, contrast_,
                      frame.mask);
}

ForegroundResult ForegroundSegmenter::segment(const ForegroundGate& gate, const PersonMask& network_mask,
                                              bool is_crop_mask, DeviceFrame& frame, ImageGray& mask) {
  mask.width = width_;
  mask.height = height_;
  mask.pixels.assign(size_t(width_) * height_, 0);
  const PixelBox& search_box = gate.person.search;
  counts_host_ = {};
  searched_ = search_box;
  found_px_ = 0;
  if (search_box.empty()) return {};
  frame.mask.fill(0);
  decide(gate, frame);

  const PixelBox rows{0, search_box.y0, width_, search_box.y1};
  const size_t begin = size_t(width_) * rows.y0, size = size_t(width_) * rows.height();
  const std::span<uint8_t> decided(mask.pixels.data() + begin, size);
  if (gate.has_network && has_background_) counts_.read_later(counts_host_);
  frame.mask.read(decided, begin);
  const bool few =
      is_crop_mask ? few_beyond(gate.coarse_mask, options_.least_stranger, counts_host_[0]) : counts_host_[0] == 0;
  const int32_t n_beyond = few ? 0 : counts_host_[0];
  if (n_beyond > 0) {
    PersonMask laid;
    if (is_crop_mask) laid = {width_, height_, frame.network_mask.read_through(device_)};
    const StrangerSearch search{is_crop_mask ? laid : network_mask, search_box, gate.person.seam_px,
                                options_.least_stranger};
    if (may_be_strangers(search, n_beyond)) {
      beyond_rows_.resize(size_t(stride_) * rows.height());
      beyond_.read(beyond_rows_, size_t(stride_) * (rows.y0 + kPad));
      drop_strangers(search, beyond_rows_.data() + kPad, stride_, mask);
    }
  }
  const ForegroundResult result = clean_mask(search_box, options_.min_part, options_.max_hole, mask);
  frame.mask.hand_over(decided, begin);
  found_px_ = result.area_px;
  return result;
}

std::optional<ForegroundResult> ForegroundSegmenter::find_sure(const ImageGray& mask) {
  if (float(counts_host_[1]) <= options_.max_hole * float(found_px_)) return std::nullopt;
  const size_t begin = size_t(width_) * searched_.y0;
  doubtful_rows_.resize(size_t(width_) * searched_.height());
  doubtful_.read(doubtful_rows_, begin);
  sure_ = mask;
  bool in_doubt = false;
  for (int y = searched_.y0; y < searched_.y1; ++y) {
    const size_t row = size_t(width_) * y;
    for (size_t p = row + searched_.x0; p < row + searched_.x1; ++p) {
      if (!doubtful_rows_[p - begin] || !mask.pixels[p]) continue;
      sure_.pixels[p] = 0;
      in_doubt = true;
    }
  }
  if (!in_doubt) return std::nullopt;
  const ForegroundResult sure = clean_mask(searched_, options_.min_part, options_.max_hole, sure_);
  if (sure.area_px == 0) return std::nullopt;
  sure_mask_.hand_over(sure_.pixels);
  return sure;
}

}  // namespace livecap
