#include "image/device_distance.h"

#include "base/round_up.h"
#include "base/text.h"
#include "image/layout.h"
#include "image/picture_size.h"
#include "image/silhouette.h"
#include "livecap/error.h"

namespace livecap {
namespace {

constexpr char kDistanceFile[] = "image/image.cl";
constexpr int32_t kBand = 64;    // rows of a work-item
constexpr int32_t kStrip = 512;  // columns of a work-item
constexpr size_t kTile = 16;
constexpr size_t kOpenGroup = 64;  // work-items of leave_open

// Words that a work-item of row_distances needs at most, for planes of this stride: LC_ROW_SCRATCH.
size_t row_scratch(int stride) {
  return size_t(stride) + LC_LANES + stride / LC_LANES + 2;
}

int blocks_of(int pixels) {
  return (pixels + LC_BLOCK - 1) / LC_BLOCK;
}

// DistanceArg of the kernels.
struct DistanceArg {
  int32_t width, height, x0, n_columns, y0, n_rows, box_x0, box_x1, stride;
};

}  // namespace

DeviceDistanceField::DeviceDistanceField(ocl::DeviceContext& device, int width, int height)
    : width_(width), height_(height), is_cpu_(device.is_cpu()) {
  if (width < 1 || height < 1 || width > kPictureSidePx.most || height > kPictureSidePx.most)
    throw ConfigError(format("distance field: picture of %dx%d, must be 1..%g", width, height, kPictureSidePx.most));
  stride_ = (blocks_of(width) + 2) * LC_BLOCK;  // a beginning between two blocks costs one; a column before and behind
  const size_t n = size_t(stride_) * height;
  if (is_cpu_) {
    steps_ = ocl::Buffer<uint16_t>(device, n);
    row_scratch_ = ocl::Buffer<int32_t>(device, row_scratch(stride_) * ((height + kBand - 1) / kBand));
  } else {
    far_to_inside_ = ocl::Buffer<int32_t>(device, n);
    far_to_outside_ = ocl::Buffer<int32_t>(device, n);
    bits_ = ocl::Buffer<uint32_t>(device, size_t(stride_) * ((height + LC_BLOCK - 1) / LC_BLOCK));
    bits_kernel_ = ocl::Kernel(device, kDistanceFile, "column_bits");
  }
  columns_ = ocl::Kernel(device, kDistanceFile, is_cpu_ ? "column_steps" : "column_squares");
  rows_ = ocl::Kernel(device, kDistanceFile, "row_distances");
  extend_ = ocl::Kernel(device, kDistanceFile, "extend_distances");
  leave_open_ = ocl::Kernel(device, kDistanceFile, "leave_open");
}

void DeviceDistanceField::compute(const ocl::Buffer<uint8_t>& mask, const PixelBox& person, int area_px,
                                  ocl::Buffer<float>& distance) {
  const size_t n = size_t(width_) * height_;
  if (mask.size() != n || distance.size() != n || person.empty())
    throw LogicError("distance field: buffers of another size, or nobody");
  if (static_cast<size_t>(area_px) == n) {  // a picture full of person has no contour
    distance.fill(-static_cast<float>(width_ + height_));
    return;
  }
  const PixelBox exact = grown(person, silhouette_margin_px(person.width(), person.height()), width_, height_);
  DistanceArg arg{width_,   height_, exact.x0 / LC_BLOCK * LC_BLOCK, 0, exact.y0, exact.height(), exact.x0,
                  exact.x1, stride_};
  arg.n_columns = blocks_of(exact.x1 - arg.x0) * LC_BLOCK;
  const auto rows = static_cast<size_t>(arg.n_rows);
  const auto rounded = [](int items) { return (static_cast<size_t>(items) + kTile - 1) / kTile * kTile; };
  if (is_cpu_) {
    columns_.launch((arg.n_columns + kStrip - 1) / kStrip, 1, arg, kStrip, mask, steps_);
    rows_.launch((rows + kBand - 1) / kBand, 1, arg, kBand, steps_, row_scratch_, distance);
  } else {
    bits_kernel_.launch(ocl::Range{rounded(arg.n_columns), (rows + LC_BLOCK - 1) / LC_BLOCK, kTile, 1}, arg, mask,
                        bits_);
    columns_.launch(ocl::Range{rounded(arg.n_columns + 2), rows, kTile, 1}, arg, bits_, far_to_inside_,
                    far_to_outside_);
    rows_.launch(ocl::Range{rounded(arg.n_columns), rows, kTile, 1}, arg, far_to_inside_, far_to_outside_, distance);
  }
  const int n_groups = (width_ + LC_LANES - 1) / LC_LANES;
  extend_.launch(ocl::Range{rounded(n_groups), static_cast<size_t>(height_), kTile, 1}, arg, n_groups, distance);
}

void DeviceDistanceField::leave_open(const ocl::Buffer<float>& sure, ocl::Buffer<float>& distance) {
  const size_t n = size_t(width_) * height_;
  if (sure.size() != n || distance.size() != n) throw LogicError("distance field: buffers of another size");
  const size_t n_groups = (n + LC_LANES - 1) / LC_LANES;
  leave_open_.launch(round_up(n_groups, kOpenGroup), kOpenGroup, static_cast<int32_t>(n), sure, distance);
}

}  // namespace livecap
