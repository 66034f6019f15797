#include "detect/crop.h"

#include <algorithm>
#include <cmath>

#include "livecap/error.h"

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

CropRegion whole_image_crop(int width, int height) {
  return {0.5 * (width - 1), 0.5 * (height - 1), static_cast<double>(std::max(width, height)), 0};
}

// Averages factor x factor pixels; blocks that stick out of the image count black pixels. Block (0,0) starts at
// (x_begin, y_begin).
void CropSampler::shrink(const ImageRgb& image, int factor, int x_begin, int y_begin, int x_end, int y_end) {
  block_width_ = (x_end - x_begin + factor - 1) / factor;
  block_height_ = (y_end - y_begin + factor - 1) / factor;
  blocks_.assign(size_t(3) * block_width_ * block_height_, 0.0f);
  const float scale = 1.0f / (255.0f * factor * factor);
  for (int y = y_begin; y < y_end; ++y) {
    float* row = &blocks_[size_t(3) * block_width_ * ((y - y_begin) / factor)];
    const uint8_t* pixel = &image.pixels[size_t(3) * (size_t(y) * image.width + x_begin)];
    for (int x = x_begin; x < x_end; row += 3) {
      int r = 0, g = 0, b = 0;
      for (const int end = std::min(x + factor, x_end); x < end; ++x, pixel += 3) {
        r += pixel[0];
        g += pixel[1];
        b += pixel[2];
      }
      row[0] += scale * static_cast<float>(r);
      row[1] += scale * static_cast<float>(g);
      row[2] += scale * static_cast<float>(b);
    }
  }
}

void CropSampler::sample(const ImageRgb& image, const CropRegion& crop, int size, std::span<float> out) {
  if (out.size() != size_t(3) * size * size) throw LogicError("detect::CropSampler: output size does not match");
  // The part of the image that the crop covers, a pixel wider.
  double x_min = 1e30, x_max = -1e30, y_min = 1e30, y_max = -1e30;
  for (int corner = 0; corner < 4; ++corner) {
    const Point2 p = crop.image_from_crop({double(corner & 1), double(corner >> 1)});
    x_min = std::min(x_min, p.x);
    x_max = std::max(x_max, p.x);
    y_min = std::min(y_min, p.y);
    y_max = std::max(y_max, p.y);
  }
  const int factor = std::max(1, static_cast<int>(std::lround(crop.side_px / size)));
  const int x_begin = std::clamp(static_cast<int>(std::floor(x_min)) - factor, 0, image.width);
  const int y_begin = std::clamp(static_cast<int>(std::floor(y_min)) - factor, 0, image.height);
  const int x_end = std::clamp(static_cast<int>(std::ceil(x_max)) + factor + 1, x_begin, image.width);
  const int y_end = std::clamp(static_cast<int>(std::ceil(y_max)) + factor + 1, y_begin, image.height);
  shrink(image, factor, x_begin, y_begin, x_end, y_end);

  // Block coordinates of the crop's pixels: affine, centres at integers in both.
  const auto block_from_image = [&](Point2 p) {
    return Point2{(p.x - x_begin - 0.5 * (factor - 1)) / factor, (p.y - y_begin - 0.5 * (factor - 1)) / factor};
  };
  const double half = 0.5 / size, step = 1.0 / size;
  const Point2 origin = block_from_image(crop.image_from_crop({half, half}));
  const Point2 right = block_from_image(crop.image_from_crop({half + step, half}));
  const Point2 down = block_from_image(crop.image_from_crop({half, half + step}));
  const int w = block_width_, h = block_height_;
  float* pixel = out.data();
  for (int v = 0; v < size; ++v) {
    for (int u = 0; u < size; ++u, pixel += 3) {
      const double x = origin.x + u * (right.x - origin.x) + v * (down.x - origin.x);
      const double y = origin.y + u * (right.y - origin.y) + v * (down.y - origin.y);
      pixel[0] = pixel[1] = pixel[2] = 0;
      if (!(x > -1 && y > -1 && x < w && y < h)) continue;
      const int x0 = static_cast<int>(std::floor(x)), y0 = static_cast<int>(std::floor(y));
      const float fx = static_cast<float>(x - x0), fy = static_cast<float>(y - y0);
      const float weights[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
      for (int corner = 0; corner < 4; ++corner) {
        const int bx = x0 + (corner & 1), by = y0 + (corner >> 1);
        if (bx < 0 || by < 0 || bx >= w || by >= h) continue;
        const float* block = &blocks_[size_t(3) * (size_t(by) * w + bx)];
        for (int c = 0; c < 3; ++c) pixel[c] += weights[corner] * block[c];
      }
    }
  }
}

void warp_mask(std::span<const float> probability, int size, const CropRegion& crop, int width, int height,
               PersonMask& mask) {
  if (probability.size() != size_t(size) * size) throw LogicError("detect::warp_mask: mask size does not match");
  mask.width = width;
  mask.height = height;
  mask.probability.assign(size_t(width) * height, 0);
  // Mask coordinates (centres at integers) of an image pixel: affine.
  const auto mask_from_image = [&](double x, double y) {
    const Point2 p = crop.crop_from_image({x, y});
    return Point2{p.x * size - 0.5, p.y * size - 0.5};
  };
  const Point2 origin = mask_from_image(0, 0);
  const Point2 px = mask_from_image(1, 0), py = mask_from_image(0, 1);
  const double dx_u = px.x - origin.x, dx_v = px.y - origin.y;
  const double dy_u = py.x - origin.x, dy_v = py.y - origin.y;
  const double low = -0.5, high = size - 0.5;  // the crop's borders
  for (int y = 0; y < height; ++y) {
    const double u_row = origin.x + y * dy_u, v_row = origin.y + y * dy_v;
    // The columns whose mask coordinates are inside the crop.
    double first = 0, last = width - 1;
    const auto limit = [&](double start, double slope) {
      if (std::abs(slope) < 1e-12) {
        if (start < low || start > high) last = -1;
        return;
      }
      const double a = (low - start) / slope, b = (high - start) / slope;
      first = std::max(first, std::ceil(std::min(a, b)));
      last = std::min(last, std::floor(std::max(a, b)));
    };
    limit(u_row, dx_u);
    limit(v_row, dx_v);
    uint8_t* row = &mask.probability[size_t(y) * width];
    for (int x = static_cast<int>(first); x <= last; ++x) {
      // The outer half pixel repeats the border.
      const float u = std::clamp(static_cast<float>(u_row + x * dx_u), 0.0f, static_cast<float>(size - 1));
      const float v = std::clamp(static_cast<float>(v_row + x * dx_v), 0.0f, static_cast<float>(size - 1));
      const int u0 = std::min(static_cast<int>(u), size - 2), v0 = std::min(static_cast<int>(v), size - 2);
      const float fu = u - static_cast<float>(u0), fv = v - static_cast<float>(v0);
      const float* m = &probability[size_t(v0) * size + u0];
      const float top = m[0] + fu * (m[1] - m[0]);
      const float bottom = m[size] + fu * (m[size + 1] - m[size]);
      row[x] = static_cast<uint8_t>(255.0f * (top + fv * (bottom - top)) + 0.5f);
    }
  }
}

}  // namespace livecap::detect
