#include "detect/self_test.h"

#include <cmath>
#include <cstdint>
#include <numeric>

#include "base/text.h"
#include "detect/kernel_args.h"
#include "detect/layout.h"
#include "image/affine_warp.h"
#include "ocl/buffer.h"
#include "ocl/kernel.h"

namespace livecap::detect {
namespace {

constexpr size_t kGroup = 64;

// The first of `found` that is not what it should be.
template <typename T>
ocl::SelfTestResult compared(const char* kernel, const std::vector<T>& found, const std::vector<T>& expected,
                             double tolerance) {
  for (size_t i = 0; i < expected.size(); ++i) {
    if (std::abs(double(found[i]) - double(expected[i])) <= tolerance) continue;
    return {kernel, false, format("value %zu: expected %g, found %g", i, double(expected[i]), double(found[i]))};
  }
  return {kernel, true, ""};
}

// A picture that rises by 8 per column, 16 per row and 1 per channel, in blocks of factor x factor pixels from (2, 1)
// on. Each pixel of the crop lies in the middle between two of a row's 4 blocks, in the last column at the border to
// what is black; its last row is below all blocks.
ocl::SelfTestResult crop_picture(ocl::DeviceContext& device, int factor, bool mirrored) {
  constexpr int kWidth = 12, kHeight = 8, kX0 = 2, kY0 = 1, kSize = 4, kBlockRows = 3, kAt = 2;
  std::vector<uint8_t> picture;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      for (int c = 0; c < 3; ++c) picture.push_back(static_cast<uint8_t>(8 * x + 16 * y + c));
    }
  }
  ocl::Buffer<float> input(device, std::vector<float>(kAt + 3 * kSize * kSize, -1));
  ocl::Kernel(device, kCropProgram, "crop_picture")
      .launch(ocl::Range{32, kSize, 32, 1}, kSize, mirrored ? 1 : 0,
              BlocksArg{kWidth, kX0, kY0, kSize, kBlockRows, factor, 1.0f / static_cast<float>(factor * factor)}, kAt,
              ocl::Buffer<uint8_t>(device, picture),
              ocl::Buffer<int32_t>(device, fixed_steps({1, 0, 0.5, 0, 1, 0}, kSize, kSize)), input);
  std::vector<float> expected(kAt + 3 * kSize * kSize, -1);
  for (int y = 0; y < kSize; ++y) {
    for (int x = 0; x < kSize; ++x) {
      for (int c = 0; c < 3; ++c) {
        const int block = 8 * (kX0 + factor * x) + 16 * (kY0 + factor * y) + 12 * (factor - 1) + c;
        const int value = y >= kBlockRows ? 0 : x + 1 < kSize ? block + 4 * factor : (block + 1) / 2;
        expected[kAt + 3 * (y * kSize + (mirrored ? kSize - 1 - x : x)) + c] = static_cast<float>(value) / 255;
      }
    }
  }
  return compared(mirrored ? "crop_picture (mirrored)" : "crop_picture", input.read_all(), expected, 1e-6);
}

// Each value of the arena is its own place, so landmark l lies at (5 l, 5 l + 1) px of the crop; the last one is
// outside.
ocl::SelfTestResult pose_outputs(ocl::DeviceContext& device) {
  constexpr int kScore = 5 * LC_LANDMARKS, kHeat = kScore + 1, kWorld = kHeat + LC_HEATMAP * LC_HEATMAP * LC_LANDMARKS;
  constexpr int kWindows = LC_LANDMARKS * LC_WINDOW * LC_WINDOW;
  std::vector<float> arena(kWorld + 3 * LC_LANDMARKS);
  std::iota(arena.begin(), arena.end(), 0.0f);
  arena[5 * (LC_LANDMARKS - 1)] = -1;
  ocl::Buffer<float> out(device, kScore + 1 + 3 * LC_LANDMARKS + kWindows);
  ocl::Kernel(device, kCropProgram, "pose_outputs")
      .launch(kWindows, kGroup, OutputsArg{0, kScore, kHeat, kWorld}, ocl::Buffer<float>(device, arena), out);
  std::vector<float> expected(arena.begin(), arena.begin() + kScore + 1);
  expected.insert(expected.end(), arena.begin() + kWorld, arena.end());
  for (int l = 0; l < LC_LANDMARKS; ++l) {
    const bool outside = l == LC_LANDMARKS - 1;
    const int column = outside ? 0 : 5 * l * LC_HEATMAP / LC_CROP,
              row = outside ? 0 : (5 * l + 1) * LC_HEATMAP / LC_CROP;
    for (int y = row - LC_WINDOW / 2; y <= row + LC_WINDOW / 2; ++y) {
      for (int x = column - LC_WINDOW / 2; x <= column + LC_WINDOW / 2; ++x) {
        const bool inside = x >= 0 && y >= 0 && x < LC_HEATMAP && y < LC_HEATMAP;
        expected.push_back(inside ? arena[kHeat + (y * LC_HEATMAP + x) * LC_LANDMARKS + l] : 0.0f);
      }
    }
  }
  return compared("pose_outputs", out.read_all(), expected, 0);
}

// Odds of 0, 1/3, 3 and infinity by turns along each row.
ocl::SelfTestResult mask_bytes(ocl::DeviceContext& device, bool mirrored) {
  constexpr int kAt = 5, kPixels = LC_CROP * LC_CROP;
  const float logit[] = {-20, std::log(1 / 3.0f), std::log(3.0f), 20};
  const uint8_t byte[] = {0, 64, 191, 255};
  std::vector<float> arena(kAt, 0);
  std::vector<uint8_t> expected;
  for (int i = 0; i < kPixels; ++i) {
    arena.push_back(logit[i % 4]);
    expected.push_back(byte[mirrored ? 3 - i % 4 : i % 4]);
  }
  ocl::Buffer<uint8_t> mask(device, kPixels);
  ocl::Kernel(device, kCropProgram, "mask_bytes")
      .launch(kPixels, kGroup, kAt, mirrored ? 1 : 0, ocl::Buffer<float>(device, arena), mask);
  return compared(mirrored ? "mask_bytes (mirrored)" : "mask_bytes", mask.read_all(), expected, 0);
}

}  // namespace

std::vector<ocl::SelfTestResult> detect_self_test(ocl::DeviceContext& device) {
  return {crop_picture(device, 2, false), crop_picture(device, 1, true), pose_outputs(device),
          mask_bytes(device, false), mask_bytes(device, true)};
}

}  // namespace livecap::detect
