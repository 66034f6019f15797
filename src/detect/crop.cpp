#include "detect/crop.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "image/affine_warp.h"
#include "image/person_gate.h"

namespace livecap::detect {

Point2 CropRegion::image_from_crop(Point2 p) const {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  const double x = (p.x - 0.5) * side_px, y = (p.y - 0.5) * side_px;
  return {center_x_px + c * x - s * y, center_y_px + s * x + c * y};
}

Point2 CropRegion::crop_from_image(Point2 p) const {
  const double c = std::cos(angle_rad), s = std::sin(angle_rad);
  const double x = p.x - center_x_px, y = p.y - center_y_px;
  return {(c * x + s * y) / side_px + 0.5, (-s * x + c * y) / side_px + 0.5};
}

namespace {

// The affine map that `position` is, from three of its values.
template <typename Position>
AffineMap affine(Position&& position) {
  const Point2 origin = position(0, 0), right = position(1, 0), down = position(0, 1);
  return {right.x - origin.x, down.x - origin.x, origin.x, right.y - origin.y, down.y - origin.y, origin.y};
}

}  // namespace

CropRegion whole_image_crop(int width, int height) {
  return {0.5 * (width - 1), 0.5 * (height - 1), static_cast<double>(std::max(width, height)), 0};
}

CropBlocks crop_blocks(int width, int height, const CropRegion& crop, int size) {
  // The part of the image that the crop covers, a pixel wider.
  double x_min = 1e30, x_max = -1e30, y_min = 1e30, y_max = -1e30;
  for (int corner = 0; corner < 4; ++corner) {
    const Point2 p = crop.image_from_crop({double(corner & 1), double(corner >> 1)});
    x_min = std::min(x_min, p.x);
    x_max = std::max(x_max, p.x);
    y_min = std::min(y_min, p.y);
    y_max = std::max(y_max, p.y);
  }
  CropBlocks blocks;
  const int factor = blocks.factor = std::max(1, static_cast<int>(std::lround(crop.side_px / size)));
  blocks.x_begin = std::clamp(static_cast<int>(std::floor(x_min)) - factor, 0, width);
  blocks.y_begin = std::clamp(static_cast<int>(std::floor(y_min)) - factor, 0, height);
  blocks.x_end = std::clamp(static_cast<int>(std::ceil(x_max)) + factor + 1, blocks.x_begin, width);
  blocks.y_end = std::clamp(static_cast<int>(std::ceil(y_max)) + factor + 1, blocks.y_begin, height);
  // Block coordinates of the crop's pixels: affine, centres at integers in both.
  blocks.from_crop = affine([&](double u, double v) {
    const Point2 p = crop.image_from_crop({(u + 0.5) / size, (v + 0.5) / size});
    return Point2{(p.x - blocks.x_begin - 0.5 * (factor - 1)) / factor,
                  (p.y - blocks.y_begin - 0.5 * (factor - 1)) / factor};
  });
  return blocks;
}

void CropSampler::sample(const ImageRgb& image, const CropRegion& crop, int size, ImageRgb& out) {
  const CropBlocks blocks = crop_blocks(image.width, image.height, crop, size);
  shrink(image, blocks.x_begin, blocks.y_begin, blocks.x_end, blocks.y_end, blocks.factor, blocks_);
  out.width = out.height = size;
  out.pixels.resize(size_t(3) * size * size);
  warp_affine(blocks_, blocks.from_crop, out);
}

CropMask place_mask(const ImageGray& probability, const CropRegion& crop, int width, int height) {
  // Most of the crop is nobody: only where something is seen pixels are computed.
  const PixelBox seen = grown(bounding_box(probability), 1, probability.width + 1, probability.height + 1);
  double x_min = 1e30, x_max = -1e30, y_min = 1e30, y_max = -1e30;
  for (int corner = 0; corner < 4; ++corner) {
    const Point2 p = crop.image_from_crop({double(corner & 1 ? seen.x1 : seen.x0 - 1) / probability.width,
                                           double(corner & 2 ? seen.y1 : seen.y0 - 1) / probability.height});
    x_min = std::min(x_min, p.x);
    x_max = std::max(x_max, p.x);
    y_min = std::min(y_min, p.y);
    y_max = std::max(y_max, p.y);
  }
  const auto pixel = [](double position, int size) {
    return static_cast<int>(std::clamp(std::floor(position), 0.0, double(size)));
  };
  return {probability,
          affine([&](double x, double y) {
            const Point2 p = crop.crop_from_image({x, y});
            return Point2{p.x * probability.width - 0.5, p.y * probability.height - 0.5};
          }),
          {pixel(x_min, width), pixel(y_min, height), pixel(x_max + 2, width), pixel(y_max + 2, height)}};
}

void warp_mask(const ImageGray& probability, const CropRegion& crop, int width, int height, PersonMask& mask) {
  const CropMask placed = place_mask(probability, crop, width, height);
  ImageGray out{width, height, std::move(mask.probability)};
  out.pixels.assign(size_t(width) * height, 0);
  const PixelBox& box = placed.box;
  warp_affine(probability, placed.mask_from_image, box.x0, box.y0, box.x1, box.y1, out);
  mask.width = width;
  mask.height = height;
  mask.probability = std::move(out.pixels);
}

}  // namespace livecap::detect
