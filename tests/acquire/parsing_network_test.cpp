// Parsing networks that tell colours apart: what they see of a picture, and where their labels land.
#include "acquire/parsing_network.h"

#include <gtest/gtest.h>

#include "base/text.h"
#include "livecap/error.h"
#include "support/onnx_writer.h"
#include "support/test_device.h"

namespace livecap {
namespace {

using acquire::ParserOptions;

constexpr int kClasses = 20;

// Scores of a 1x1 convolution: upper clothes (5) = red, pants (9) = blue, face (13) = the given threshold.
class ParsingNetwork : public testing::Test {
 protected:
  ~ParsingNetwork() override { std::filesystem::remove(file_); }

  ParserOptions write(float threshold, bool argmax, int height, int width, int classes = kClasses) {
    std::vector<float> weights(size_t(3) * classes, 0.0f), bias(classes, -100.0f);
    if (classes == kClasses) {
      weights[3 * 5 + 0] = weights[3 * 9 + 2] = 1;
      bias[5] = bias[9] = 0;
      bias[13] = threshold;
    }
    test::OnnxWriter net;
    net.floats("w", {classes, 3, 1, 1}, weights);
    net.floats("b", {classes}, bias);
    net.node("Conv", {"x", "w", "b"}, "scores");
    if (argmax) net.node("ArgMax", {"scores"}, "labels", {test::onnx_int("axis", 1), test::onnx_int("keepdims", 0)});
    write_file_atomically(file_, net.model({1, 3, height, width}, {argmax ? "labels" : "scores"}));
    ParserOptions options;
    options.network = file_;
    return options;
  }
  ImageGray labels(const ParserOptions& options, const ImageRgb& image, const ImageGray& mask) {
    ocl::DeviceContext device(ocl::select_device(test::device_selectors().front()));
    return acquire::ParsingNetwork(device, options).labels(image, mask);
  }
  std::string failure(const ParserOptions& options) {
    try {
      labels(options, {8, 8, std::vector<uint8_t>(192)}, {});
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  }

  std::filesystem::path file_ = std::filesystem::path(testing::TempDir()) / "parsing_network_test.onnx";
};

// Red left of column `border`, blue right of it, with values below 255 so that no rounding saturates.
ImageRgb two_colors(int width, int height, int border) {
  ImageRgb image{width, height, std::vector<uint8_t>(size_t(3) * width * height, 20)};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) image.pixels[3 * (size_t(y) * width + x) + (x < border ? 0 : 2)] = 200;
  return image;
}

int at(const ImageGray& image, int x, int y) {
  return image.pixels[size_t(y) * image.width + x];
}

TEST_F(ParsingNetwork, LabelsLandWhereTheColorsAre) {
  const ImageRgb image = two_colors(90, 120, 41);
  for (bool argmax : {false, true}) {
    const ImageGray result = labels(write(-100, argmax, 64, 48), image, {});  // the picture's aspect
    ASSERT_EQ(result.width, 90);
    ASSERT_EQ(result.height, 120);
    for (int y = 0; y < 120; ++y)
      for (int x = 0; x < 90; ++x)
        if (x < 39 || x > 42) ASSERT_EQ(at(result, x, y), x < 41 ? 5 : 9) << x << " " << y;
  }
}

TEST_F(ParsingNetwork, SeesThePersonOfTheMaskAndALittleAround) {
  const ImageRgb image = two_colors(200, 100, 150);
  ImageGray mask{200, 100, std::vector<uint8_t>(200 * 100, 0)};
  for (int y = 20; y < 80; ++y)
    for (int x = 140; x < 160; ++x) mask.pixels[size_t(y) * 200 + x] = 255;
  // 60 tall and 6 around: rows 14 to 86; as wide as the input's aspect says: 72 columns around 150.
  const ImageGray result = labels(write(-100, false, 96, 96), image, mask);
  for (int y = 0; y < 100; ++y)
    for (int x = 0; x < 200; ++x) {
      if (std::abs(x - 150) < 2) continue;
      const bool seen = x >= 114 && x < 186 && y >= 14 && y < 86;
      ASSERT_EQ(at(result, x, y), !seen ? 0 : x < 150 ? 5 : 9) << x << " " << y;
    }
}

// (200 / 255 - 0.485) / 0.229 = 1.307 of red, 1.688 of blue, against a threshold between.
TEST_F(ParsingNetwork, ColorsAreNormalised) {
  const ImageRgb image = two_colors(64, 64, 32);
  const auto both = [&](const ParserOptions& options) {
    const ImageGray result = labels(options, image, {});
    return std::pair{at(result, 8, 30), at(result, 56, 30)};
  };
  EXPECT_EQ(both(write(1.25f, false, 64, 64)), (std::pair{5, 9}));
  EXPECT_EQ(both(write(1.35f, false, 64, 64)), (std::pair{13, 9}));
  EXPECT_EQ(both(write(1.75f, false, 64, 64)), (std::pair{13, 13}));
  ParserOptions plain = write(0.8f, false, 64, 64);  // above 200 / 255 = 0.784
  plain.mean = {0, 0, 0};
  plain.deviation = {1, 1, 1};
  EXPECT_EQ(both(plain), (std::pair{13, 13}));
  plain.deviation = {0.9, 1, 1};
  EXPECT_EQ(both(plain), (std::pair{5, 13}));
  plain.bgr = true;
  EXPECT_EQ(both(plain), (std::pair{9, 13}));
}

TEST_F(ParsingNetwork, OpenSizesAreFilledAndOthersRefused) {
  EXPECT_EQ(at(labels(write(-100, false, 0, 0), two_colors(30, 30, 15), {}), 3, 3), 5);
  EXPECT_NE(failure(write(0, false, 16, 16, 7)).find("[1,7,16,16]; one must be [1,20,h,w]"), std::string::npos);
  ParserOptions wrong = write(0, false, 16, 16);
  wrong.network = "none.onnx";
  EXPECT_NE(failure(wrong).find("none.onnx"), std::string::npos);
  wrong.deviation[1] = 0;
  EXPECT_THROW(wrong.validate(), ConfigError);
}

}  // namespace
}  // namespace livecap
