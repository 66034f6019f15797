// Lens blur, exposure, noise and encoding; see renderer.h.
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "synth/random.h"
#include "synth/renderer.h"

namespace livecap::synth {

namespace {

constexpr int kEncodeSteps = 4096;

const std::array<float, kEncodeSteps + 1>& encode_table() {
  static const auto table = [] {
    std::array<float, kEncodeSteps + 1> t;
    for (int i = 0; i <= kEncodeSteps; ++i) {
      const double linear = std::pow(static_cast<double>(i) / kEncodeSteps, 2);  // finer steps in the dark
      t[i] =
          static_cast<float>(255 * (linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055));
    }
    return t;
  }();
  return table;
}

// Nearly Gaussian, standard deviation 1: the sum of four bytes.
float unit_noise(uint32_t bits) {
  const int sum = (bits & 255) + ((bits >> 8) & 255) + ((bits >> 16) & 255) + (bits >> 24);
  return static_cast<float>(sum - 510) / 147.8f;
}

}  // namespace

float linear_from_srgb(float encoded) {
  return encoded <= 0.04045f ? encoded / 12.92f : std::pow((encoded + 0.055f) / 1.055f, 2.4f);
}

ImageRgb expose(const std::vector<Color>& linear, int width, int height, const Sensor& sensor) {
  cv::Mat blurred(height, width, CV_32FC3, const_cast<Color*>(linear.data()));
  if (sensor.blur_px > 0) {
    cv::Mat sharp = blurred;
    blurred = cv::Mat();
    cv::GaussianBlur(sharp, blurred, {0, 0}, sensor.blur_px);
  }
  const auto& table = encode_table();
  ImageRgb image{width, height, std::vector<uint8_t>(static_cast<size_t>(3) * width * height)};
  const float* values = blurred.ptr<float>();
  uint64_t state = hash64(sensor.seed) | 1;
  const float gain = static_cast<float>(sensor.gain), noise = static_cast<float>(sensor.noise);
  for (size_t i = 0; i < image.pixels.size(); ++i) {
    const float level = std::sqrt(std::clamp(gain * values[i], 0.0f, 1.0f)) * kEncodeSteps;
    const int step = std::min(static_cast<int>(level), kEncodeSteps - 1);
    float encoded = table[step] + (level - step) * (table[step + 1] - table[step]);
    if (noise > 0) {
      state ^= state << 13;  // xorshift64
      state ^= state >> 7;
      state ^= state << 17;
      encoded += noise * unit_noise(static_cast<uint32_t>(state >> 32));
    }
    image.pixels[i] = static_cast<uint8_t>(std::lround(std::clamp(encoded, 0.0f, 255.0f)));
  }
  return image;
}

}  // namespace livecap::synth
