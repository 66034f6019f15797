#include "image/foreground.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>

#include "base/text.h"
#include "foreground_reference.h"
#include "image/foreground_pieces.h"
#include "image/image_io.h"
#include "image/video.h"
#include "livecap/error.h"
#include "support/data_dir.h"
#include "support/kernel_bodies.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

constexpr int kWidth = 200, kHeight = 240;

bool in_person(int x, int y) {
  return std::hypot((x - 100) / 30.0, (y - 120) / 80.0) < 1;
}
bool in_shadow(int x, int y) {
  return std::hypot((x - 150) / 40.0, (y - 200) / 12.0) < 1;
}
bool in_other(int x, int y) {
  return x >= 57 && x < 69 && y >= 30 && y < 46;
}

bool beside_the_foot(int x, int y) {
  return std::hypot((x - 112) / 12.0, (y - 190) / 8.0) < 1;
}

// A textured room; with a person (blue-green), a shadow and something else that moves. deep: what a second shadow,
// beside the person's foot, leaves of the light.
ImageRgb scene(bool person, float gain, unsigned seed, float deep = 1) {
  std::mt19937 random(seed);
  std::normal_distribution<float> noise(0, 2);
  ImageRgb image{kWidth, kHeight, {}};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      float value[3] = {120 + 30 * std::sin(0.1f * x), 110 + 20 * std::cos(0.07f * y), 90};
      if (person && in_shadow(x, y)) {
        for (float& v : value) v *= 0.75f;
      }
      if (person && beside_the_foot(x, y)) {
        for (float& v : value) v *= deep;
      }
      if (person && in_other(x, y)) value[0] = 220;
      if (person && in_person(x, y)) value[0] = 40, value[1] = 90, value[2] = 130 + 20 * ((x / 8) % 2);
      for (float v : value)
        image.pixels.push_back(static_cast<uint8_t>(std::clamp(v * gain + noise(random), 0.f, 255.f)));
    }
  }
  return image;
}

// As a network would give it: right in the middle, vague and too small at the border.
PersonMask vague_mask() {
  PersonMask mask{kWidth, kHeight, {}};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double r = std::hypot((x - 100) / 28.0, (y - 120) / 76.0);
      mask.probability.push_back(static_cast<uint8_t>(255 / (1 + std::exp(25 * (r - 1)))));
    }
  }
  return mask;
}

// Everything that a test needs for one picture size, on the first test device.
class ForegroundModel {
 public:
  explicit ForegroundModel(const ForegroundOptions& options = {}) : options_(options) {}
  void train(const ImageRgb& plate) {
    background_.train(plate);
    segmenter_.reset();
  }
  ImageGray segment(const ImageRgb& image, const PersonMask& network) {
    if (!segmenter_) segmenter_.emplace(device_, background_, kWidth, kHeight, options_);
    DeviceFrame frame(device_, kWidth, kHeight);
    ImageGray mask;
    const ForegroundResult result = segmenter_->segment(image, network, frame, mask);
    EXPECT_EQ(result.area_px, std::count(mask.pixels.begin(), mask.pixels.end(), 255));
    EXPECT_EQ(result.area_px == 0, result.box.empty());
    if (result.area_px > 0) EXPECT_EQ(frame.mask.read_all(), mask.pixels);
    EXPECT_EQ(frame.rgb.read_all(), image.pixels);
    return mask;
  }

 private:
  ocl::DeviceContext device_{ocl::select_device(test::device_selectors().front())};
  ForegroundOptions options_;
  BackgroundModel background_;
  std::optional<ForegroundSegmenter> segmenter_;
};

template <typename Truth>
double iou(const ImageGray& mask, Truth&& truth) {
  int both = 0, either = 0;
  for (int y = 0; y < mask.height; ++y) {
    for (int x = 0; x < mask.width; ++x) {
      const bool a = mask.pixels[size_t(y) * mask.width + x] > 127, b = truth(x, y);
      both += a && b;
      either += a || b;
    }
  }
  return either ? double(both) / either : 1;
}

TEST(Foreground, FindsThePersonDespiteShadowOthersAndGain) {
  for (int plates : {1, 8}) {
    ForegroundModel model;
    for (int i = 0; i < plates; ++i) model.train(scene(false, 1, 10 + i));
    for (float gain : {1.0f, 0.9f, 1.12f}) {
      const ImageGray mask = model.segment(scene(true, gain, 99), vague_mask());
      EXPECT_GT(iou(mask, in_person), test::kForegroundIou) << plates << " plates, gain " << gain;
      for (int y = 0; y < kHeight; ++y) {
        for (int x = 0; x < kWidth; ++x) EXPECT_FALSE(in_other(x, y) && mask.pixels[y * kWidth + x]) << x << "," << y;
      }
    }
  }
}

// A shadow so dark that it may be none stays in the mask, and is in doubt where the network sees nobody. A lighter one
// is not in the mask, and a darker one is not a shadow's.
TEST(Foreground, ADarkShadowBesideTheFootIsInDoubt) {
  BackgroundModel background;
  background.train(scene(false, 1, 1));
  PersonMask seen{kWidth, kHeight, {}}, sees_all = seen;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      seen.probability.push_back(in_person(x, y) ? 200 : 20);
      sees_all.probability.push_back(in_person(x, y) || beside_the_foot(x, y) ? 200 : 20);
    }
  }
  // The shares of shadow and person that these pixels have.
  const auto shares = [&](const std::vector<uint8_t>& pixels) {
    int shadow = 0, shadow_in = 0, person = 0, person_in = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const bool in = pixels[size_t(y) * kWidth + x] != 0;
        person += in_person(x, y), person_in += in_person(x, y) && in;
        const bool shaded = beside_the_foot(x, y) && !in_person(x, y);
        shadow += shaded, shadow_in += shaded && in;
      }
    }
    return std::pair(double(shadow_in) / shadow, double(person_in) / person);
  };
  test::on_every_device([&](ocl::DeviceContext& device) {
    ForegroundSegmenter segmenter(device, background, kWidth, kHeight);
    DeviceFrame frame(device, kWidth, kHeight);
    ImageGray mask;
    const auto is_in_doubt = [&](float deep, const PersonMask& network) {
      segmenter.segment(scene(true, 1, 2, deep), network, frame, mask);
      return segmenter.find_sure(mask).has_value();
    };
    ASSERT_TRUE(is_in_doubt(0.42f, seen));
    EXPECT_GT(shares(mask.pixels).first, 0.8);
    const auto [shadow, person] = shares(segmenter.sure_mask().read_all());
    EXPECT_LT(shadow, 0.1);
    EXPECT_GT(person, 0.97);
    EXPECT_FALSE(is_in_doubt(0.42f, sees_all));
    EXPECT_FALSE(is_in_doubt(0.42f, {})) << "no network";
    EXPECT_FALSE(is_in_doubt(0.7f, seen));
    EXPECT_LT(shares(mask.pixels).first, 0.1);
    EXPECT_FALSE(is_in_doubt(0.15f, seen));
    EXPECT_GT(shares(mask.pixels).first, 0.8);
    EXPECT_FALSE(is_in_doubt(0.42f, PersonMask{kWidth, kHeight, std::vector<uint8_t>(kWidth * kHeight, 3)}))
        << "nobody";
    ForegroundOptions lenient;
    lenient.max_hole = 0.5f;  // of the person; the shadow is smaller
    ForegroundSegmenter doubts_little(device, background, kWidth, kHeight, lenient);
    doubts_little.segment(scene(true, 1, 2, 0.42f), seen, frame, mask);
    EXPECT_FALSE(doubts_little.find_sure(mask).has_value()) << "less than a hole that is closed";
    // What was in doubt elsewhere in another picture is forgotten.
    PersonMask upper = seen;
    std::fill(upper.probability.begin() + kWidth * kHeight / 2, upper.probability.end(), uint8_t{0});
    const auto sure_of_upper = [&](ForegroundSegmenter& own) {
      own.segment(scene(true, 1, 2, 0.42f), upper, frame, mask);
      return own.find_sure(mask) ? own.sure_mask().read_all() : mask.pixels;
    };
    ForegroundSegmenter fresh(device, background, kWidth, kHeight);
    EXPECT_TRUE(is_in_doubt(0.42f, seen));
    EXPECT_EQ(sure_of_upper(segmenter), sure_of_upper(fresh));
  });
}

// Somebody else comes near: only what the network calls the person is left on that side, while a part of the person
// that the network missed stays.
TEST(Foreground, AStrangerBesideThePersonIsLeftOut) {
  const auto in_stranger = [](int x, int y) {
    return !in_person(x, y) && std::hypot((x - 160) / 34.0, (y - 125) / 80.0) < 1;
  };
  ForegroundModel model;
  model.train(scene(false, 1, 1));
  ImageRgb image = scene(true, 1, 2);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (in_stranger(x, y)) image.pixels[3 * (y * kWidth + x)] = 230;
    }
  }
  PersonMask network = vague_mask();
  const auto in_missed_head = [](int x, int y) { return in_person(x, y) && y < 50; };
  for (int y = 0; y < 50; ++y) std::fill_n(&network.probability[y * kWidth], kWidth, uint8_t{0});
  const ImageGray mask = model.segment(image, network);
  const auto area = [&](auto&& part) {
    int in = 0, all = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        all += part(x, y);
        in += part(x, y) && mask.pixels[y * kWidth + x];
      }
    }
    return static_cast<double>(in) / all;
  };
  EXPECT_LT(area(in_stranger), 0.06);
  EXPECT_GT(area(in_missed_head), 0.8);
  EXPECT_GT(area(in_person), test::kForegroundIou);
}

TEST(Foreground, WithoutTheNetworkTheLargestPieceIsKept) {
  ForegroundModel model;
  model.train(scene(false, 1, 1));
  const ImageGray mask = model.segment(scene(true, 1.05f, 2), {});
  EXPECT_GT(iou(mask, [](int x, int y) { return in_person(x, y) || in_other(x, y); }), test::kForegroundIou);
}

TEST(Foreground, WithoutAPlateTheNetworkDecides) {
  ForegroundModel model;
  const PersonMask network = vague_mask();
  const ImageGray mask = model.segment(scene(true, 1, 2), network);
  EXPECT_GT(iou(mask, [&](int x, int y) { return network.probability[y * kWidth + x] > 127; }), test::kForegroundIou);
}

TEST(Foreground, NobodyIsAnEmptyMask) {
  auto area = [](const ImageGray& mask) { return std::count(mask.pixels.begin(), mask.pixels.end(), 255); };
  ForegroundModel model;
  const PersonMask nobody{kWidth, kHeight, std::vector<uint8_t>(kWidth * kHeight, 3)};
  EXPECT_EQ(area(model.segment(scene(true, 1, 2), {})), 0);  // neither plate nor network
  EXPECT_EQ(area(model.segment(scene(true, 1, 2), nobody)), 0);
  model.train(scene(false, 1, 1));
  EXPECT_EQ(area(model.segment(scene(true, 1, 2), nobody)), 0);
  EXPECT_EQ(area(model.segment(scene(false, 1.1f, 7), {})), 0);
}

TEST(Foreground, RealHolesStayOpen) {
  ForegroundModel model;
  model.train(scene(false, 1, 1));
  ImageRgb image = scene(true, 1, 2);
  const ImageRgb empty = scene(false, 1, 3);
  auto in_hole = [](int x, int y) { return std::hypot(x - 100, y - 120) < 12; };
  auto in_speck = [](int x, int y) { return std::hypot(x - 100, y - 80) < 1.5; };
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      if (in_hole(x, y) || in_speck(x, y))
        std::copy_n(&empty.pixels[3 * (y * kWidth + x)], 3, &image.pixels[3 * (y * kWidth + x)]);
    }
  }
  PersonMask network{kWidth, kHeight, std::vector<uint8_t>(kWidth * kHeight, 0)};
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) network.probability[y * kWidth + x] = in_person(x, y) ? 140 : 0;
  }
  const ImageGray mask = model.segment(image, network);
  EXPECT_EQ(mask.pixels[120 * kWidth + 100], 0);
  EXPECT_EQ(mask.pixels[80 * kWidth + 100], 255);
}

// Against the same decisions in plain C++ and OpenCV. Divisions and the smoothing's weights are rounded differently, so
// single pixels at the thresholds may differ.
TEST(Foreground, AgreesWithPlainCpp) {
  test::on_every_device_and_body([](ocl::DeviceContext& device) {
    std::mt19937 random(5);
    for (const auto& [width, height] : {std::pair{200, 240}, {97, 131}, {33, 40}, {9, 7}}) {
      for (int plates : {0, 1, 6}) {
        for (bool gated : {true, false}) {
          BackgroundModel background;
          const auto part = [&, w = width, h = height](const ImageRgb& whole) {
            ImageRgb image{w, h, {}};
            for (int y = 0; y < h; ++y) {
              const auto row = whole.pixels.begin() + 3 * ((y + (kHeight - h) / 2) * kWidth + (kWidth - w) / 2);
              image.pixels.insert(image.pixels.end(), row, row + 3 * w);
            }
            return image;
          };
          for (int i = 0; i < plates; ++i) background.train(part(scene(false, 1, 10 + i)));
          PersonMask network;
          if (gated) {
            const PersonMask whole = vague_mask();
            network = {width, height, {}};
            for (int y = 0; y < height; ++y) {
              const auto row = whole.probability.begin() + (y + (kHeight - height) / 2) * kWidth + (kWidth - width) / 2;
              network.probability.insert(network.probability.end(), row, row + width);
            }
          }
          const ImageRgb image = part(scene(true, 1.07f, 77, 0.4f));
          ForegroundSegmenter segmenter(device, background, width, height);
          DeviceFrame frame(device, width, height);
          ImageGray mask;
          segmenter.segment(image, network, frame, mask);
          const std::optional<ForegroundResult> found = segmenter.find_sure(mask);
          const auto reference = test::reference_foreground(background, {}, image, network);
          const std::vector<uint8_t> sure = found ? segmenter.sure_mask().read_all() : mask.pixels;
          int different = 0, sure_different = 0;
          for (size_t p = 0; p < mask.pixels.size(); ++p) {
            different += mask.pixels[p] != reference.mask.pixels[p];
            sure_different += sure[p] != reference.sure.pixels[p];
          }
          SCOPED_TRACE(format("%dx%d, %d plates, %s", width, height, plates, gated ? "gated" : "not gated"));
          EXPECT_LE(different, test::kForegroundDifferentPx);
          EXPECT_LE(sure_different, test::kForegroundDifferentPx);
          if (height > 200) EXPECT_EQ(found.has_value(), plates > 0 && gated);
          if (found) EXPECT_EQ(found->area_px, std::count(sure.begin(), sure.end(), 255));
          if (width > 90 && (plates > 0 || gated)) {
            EXPECT_GT(std::count(mask.pixels.begin(), mask.pixels.end(), 255), 1000);
          }
        }
      }
    }
  });
}

// A crop's mask that the device lays over the picture is the one that OpenCV lays there: a vague one, and one
// that is the same nearly everywhere.
TEST(Foreground, ACropsMaskIsLaidOverThePicture) {
  const PersonMask vague = vague_mask();
  CropMask crop{{64, 64, {}}, {0.31, 0.07, -9.3, -0.07, 0.31, 4.6}, {5, 11, kWidth - 3, kHeight}};
  for (int y = 0; y < 64; ++y) {
    for (int x = 0; x < 64; ++x)
      crop.probability.pixels.push_back(vague.probability[size_t(y) * kHeight / 64 * kWidth + x * kWidth / 64]);
  }
  CropMask flat = crop;
  for (uint8_t& pixel : flat.probability.pixels) pixel = pixel > 127 ? 255 : 0;
  for (size_t p = 5; p < flat.probability.pixels.size(); p += 237) flat.probability.pixels[p] ^= 1;
  BackgroundModel background;
  background.train(scene(false, 1, 10));
  for (CropMask* laid_crop : {&crop, &flat}) {
    const PixelBox& box = laid_crop->box;
    ImageGray laid{kWidth, kHeight, std::vector<uint8_t>(size_t(kWidth) * kHeight, 0)};
    warp_affine(laid_crop->probability, laid_crop->mask_from_image, box.x0, box.y0, box.x1, box.y1, laid);
    ASSERT_GT(std::count_if(laid.pixels.begin(), laid.pixels.end(), [](uint8_t p) { return p > 127; }), 1000);
    const PersonMask network{kWidth, kHeight, laid.pixels};
    test::on_every_device_and_body([&](ocl::DeviceContext& device) {
      ForegroundSegmenter segmenter(device, background, kWidth, kHeight);
      DeviceFrame frame(device, kWidth, kHeight);
      const ImageRgb image = scene(true, 1.07f, 77);
      ImageGray expected, mask;
      segmenter.segment(image, network, frame, expected);
      segmenter.segment(image, *laid_crop, frame, mask);
      EXPECT_EQ(frame.network_mask.read_all(), laid.pixels);
      EXPECT_EQ(mask.pixels, expected.pixels);
      EXPECT_GT(std::count(mask.pixels.begin(), mask.pixels.end(), 255), 1000);
      laid_crop->box.x1 = kWidth + 1;
      EXPECT_THROW(segmenter.segment(image, *laid_crop, frame, mask), LogicError);
      laid_crop->box.x1 = kWidth - 3;
    });
  }
}

// What was written for the network before is not written again.
TEST(Foreground, APictureThatIsThereIsNotUploaded) {
  BackgroundModel background;
  background.train(scene(false, 1, 10));
  test::on_every_device_and_body([&](ocl::DeviceContext& device) {
    ForegroundSegmenter segmenter(device, background, kWidth, kHeight);
    DeviceFrame uploaded(device, kWidth, kHeight), there(device, kWidth, kHeight);
    const ImageRgb image = scene(true, 1.07f, 77);
    ImageGray expected, mask;
    segmenter.segment(image, vague_mask(), uploaded, expected);
    for (const ImageRgb& picture : {image, scene(false, 1.07f, 77)}) {
      there.rgb.write(picture.pixels);
      there.has_picture = true;
      segmenter.segment(image, vague_mask(), there, mask);
      EXPECT_EQ(mask.pixels == expected.pixels, picture.pixels == image.pixels);
    }
  });
}

// So few are a stranger nowhere, whatever the pixels of the cells are.
TEST(Foreground, FewBeyondAreFewByPixels) {
  std::mt19937 random(9);
  int n_few = 0;
  for (int i = 0; i < 400; ++i) {
    const int width = 60 + static_cast<int>(random() % 40), height = 70;
    const int cell_width = (width + kGateCell - 1) / kGateCell, cell_height = (height + kGateCell - 1) / kGateCell;
    PersonMask network{width, height, std::vector<uint8_t>(size_t(width) * height, 0)};
    const unsigned vague = 1 + random() % 128;  // certain inside, all but certain around
    for (int y = 10; y < height; ++y) {
      for (int x = 15; x < width; ++x)
        network.probability[size_t(y) * width + x] = static_cast<uint8_t>(x < 45 ? 255 - random() % vague : 127);
    }
    ImageGray cells{cell_width, cell_height, {}};
    for (int v = 0; v < cell_height; ++v) {
      for (int u = 0; u < cell_width; ++u) {
        int sum = 0, n = 0;
        for (int y = 4 * v; y < std::min(4 * v + 4, height); ++y) {
          for (int x = 4 * u; x < std::min(4 * u + 4, width); ++x, ++n)
            sum += network.probability[size_t(y) * width + x];
        }
        cells.pixels.push_back(static_cast<uint8_t>((2 * sum + n) / (2 * n)));
      }
    }
    const int n_beyond = static_cast<int>(random() % 300);
    const StrangerSearch search{network, {0, 0, width, height}, 2, 0.9f};
    if (!few_beyond(cells, 0.9f, n_beyond)) continue;
    ++n_few;
    EXPECT_FALSE(may_be_strangers(search, n_beyond)) << n_beyond;
  }
  EXPECT_GT(n_few, 100);
}

TEST(Foreground, DiscsAreOpenCvs) {
  std::mt19937 random(4);
  for (int radius : {1, 2, 5, 16, 40}) {
    ImageGray mask{61, 47, std::vector<uint8_t>(61 * 47, 0)};
    for (uint8_t& pixel : mask.pixels) pixel = random() % 50 == 0 ? 255 : 0;
    ImageGray holes = mask;
    for (uint8_t& pixel : holes.pixels) pixel = static_cast<uint8_t>(255 - pixel);
    cv::Mat grown, shrunk;
    cv::dilate(cv::Mat(47, 61, CV_8UC1, mask.pixels.data()), grown, test::disc(radius));
    cv::erode(cv::Mat(47, 61, CV_8UC1, holes.pixels.data()), shrunk, test::disc(radius));
    grow_by_disc(mask, radius);
    shrink_by_disc(holes, radius);
    EXPECT_EQ(cv::countNonZero(grown != cv::Mat(47, 61, CV_8UC1, mask.pixels.data())), 0) << radius;
    EXPECT_EQ(cv::countNonZero(shrunk != cv::Mat(47, 61, CV_8UC1, holes.pixels.data())), 0) << radius;
  }
}

TEST(Foreground, SizesMustAgree) {
  ForegroundModel model;
  model.train(scene(false, 1, 1));
  EXPECT_THROW(model.train(ImageRgb{2, 1, std::vector<uint8_t>(6)}), ConfigError);
  EXPECT_THROW(model.train(ImageRgb{}), ConfigError);
  EXPECT_THROW(model.segment(ImageRgb{2, 1, std::vector<uint8_t>(6)}, {}), ConfigError);
  EXPECT_THROW(model.segment(scene(true, 1, 1), PersonMask{2, 1, {0, 0}}), ConfigError);
  BackgroundOptions background;
  background.shadow_darkest = 2;
  EXPECT_THROW(BackgroundModel{background}, ConfigError);
  for (const float darkest : {0.0f, 0.6f, std::nanf("")})
    EXPECT_THROW(BackgroundModel{BackgroundOptions{.doubt_darkest = darkest}}, ConfigError) << darkest;
  ForegroundOptions options;
  options.smooth_px = 11;
  EXPECT_THROW(ForegroundModel{options}.segment(scene(true, 1, 1), {}), ConfigError);
}

TEST(Foreground, RecordedSequence) {
  LIVECAP_DATA_OR_SKIP(sequence, "skirt_dance");
  BackgroundModel background;
  background.train(read_image_rgb(sequence / "background.png"));
  ocl::DeviceContext device(ocl::select_device(test::device_selectors().front()));
  ForegroundSegmenter segmenter(device, background, background.width(), background.height());
  DeviceFrame on_device(device, background.width(), background.height());
  ImageGray mask;
  VideoReader reader((sequence / "video.mp4").string());
  Frame frame;
  double sum = 0;
  int n = 0;
  while (reader.read(frame)) {
    if (frame.index % 10 != 5 || frame.index < 10) continue;
    const ImageGray truth =
        read_image_gray(sequence / "truth" / "masks" / format("%06d.png", static_cast<int>(frame.index)));
    // A crude stand-in for a network: the truth averaged over 13x13 pixels.
    PersonMask network{truth.width, truth.height, std::vector<uint8_t>(truth.pixels.size(), 0)};
    for (int y = 6; y + 6 < truth.height; ++y) {
      for (int x = 6; x + 6 < truth.width; ++x) {
        int total = 0;
        for (int v = -6; v <= 6; v += 2) {
          for (int u = -6; u <= 6; u += 2) total += truth.pixels[size_t(y + v) * truth.width + x + u];
        }
        network.probability[size_t(y) * truth.width + x] = static_cast<uint8_t>(total / 49);
      }
    }
    segmenter.segment(frame.image, network, on_device, mask);
    sum += iou(mask, [&](int x, int y) { return truth.pixels[size_t(y) * truth.width + x] > 127; });
    ++n;
  }
  ASSERT_GT(n, 10);
  EXPECT_GT(sum / n, test::kRecordedForegroundIou);
}

}  // namespace
}  // namespace livecap
