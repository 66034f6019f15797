// A short sequence read back with other tools: does the truth agree with the picture?
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "base/text.h"
#include "glb_file.h"
#include "image/video.h"
#include "livecap/camera.h"
#include "livecap/error.h"
#include "support/tolerances.h"
#include "synth/synth.h"

namespace livecap {
namespace {

constexpr int kEmpty = 3, kFrames = 33;

struct Pc2 {
  int n_points = 0, n_samples = 0;
  std::vector<float> xyz;
  const float* sample(int frame) const { return &xyz[static_cast<size_t>(frame) * 3 * n_points]; }
};

Pc2 read_pc2(const std::filesystem::path& path) {
  const std::string bytes = read_file(path);
  EXPECT_EQ(bytes.substr(0, 12), std::string("POINTCACHE2\0", 12));
  int32_t version;
  float start, rate;
  Pc2 cache;
  std::memcpy(&version, &bytes[12], 4);
  std::memcpy(&cache.n_points, &bytes[16], 4);
  std::memcpy(&start, &bytes[20], 4);
  std::memcpy(&rate, &bytes[24], 4);
  std::memcpy(&cache.n_samples, &bytes[28], 4);
  EXPECT_EQ(version, 1);
  EXPECT_EQ(start, 0);
  EXPECT_EQ(rate, 1);
  cache.xyz.resize((bytes.size() - 32) / 4);
  EXPECT_EQ(cache.xyz.size(), static_cast<size_t>(3) * cache.n_points * cache.n_samples);
  std::memcpy(cache.xyz.data(), &bytes[32], cache.xyz.size() * 4);
  return cache;
}

SynthOptions small(const std::string& actor) {
  SynthOptions options;
  options.actor = actor;
  options.motions = {"dance"};
  options.width = 272;
  options.height = 480;
  options.empty_frames = kEmpty;
  options.n_frames = kFrames;
  return options;
}

struct Sequence {
  std::filesystem::path folder;
  SynthReport report;
  Pc2 truth;
  nlohmann::json joints;
  Camera camera;

  explicit Sequence(const SynthOptions& options, const std::string& name) {
    folder = std::filesystem::temp_directory_path() / ("livecap_synth_" + name + std::to_string(::getpid()));
    report = write_sequence(options, folder);
    truth = read_pc2(folder / "truth" / "vertices.pc2");
    joints = nlohmann::json::parse(read_file(folder / "truth" / "joints.json"));
    camera = load_camera(folder / "camera.json");
  }
  ~Sequence() { std::filesystem::remove_all(folder); }

  cv::Mat mask(int frame) const {
    return cv::imread((folder / "truth" / "masks" / format("%06d.png", frame)).string(), cv::IMREAD_UNCHANGED);
  }
  // glTF metres -> pixels.
  cv::Point2d project(const float* p) const {
    return {camera.fx * p[0] / -p[2] + camera.cx, camera.fy * -p[1] / -p[2] + camera.cy};
  }
};

const Sequence& skirt() {
  static const Sequence sequence(small("skirt"), "skirt");
  return sequence;
}

TEST(Sequence, HasTheFilesAndFrames) {
  const Sequence& s = skirt();
  EXPECT_EQ(s.report.n_frames, kFrames);
  EXPECT_EQ(s.truth.n_samples, kFrames);
  EXPECT_EQ(s.camera.width, 272);
  EXPECT_EQ(s.camera.height, 480);
  const auto file = test::read_glb(read_file(s.folder / "actor.glb"));
  EXPECT_EQ(s.truth.n_points, static_cast<int>(file.vertices.size()));
  const std::string labels = read_file(s.folder / "truth" / "labels.npy");
  const auto glb_labels = file.attribute<float>("_LABEL");
  ASSERT_GT(labels.size(), file.vertices.size());
  EXPECT_EQ(labels.substr(0, 6), "\x93NUMPY");
  for (size_t i = 0; i < file.vertices.size(); ++i)
    ASSERT_EQ(labels[labels.size() - file.vertices.size() + i], static_cast<char>(glb_labels[file.first[i]]));
  VideoReader video((s.folder / "video.mp4").string());
  Frame frame;
  int n = 0;
  while (video.read(frame)) ++n;
  EXPECT_EQ(n, kFrames);
  EXPECT_EQ(video.info().width, 272);
  EXPECT_EQ(video.info().height, 480);
}

// The lowest point of who stands there is on the floor that camera.json tells, if it was asked to.
TEST(Sequence, TellsTheFloorWhenAsked) {
  EXPECT_FALSE(skirt().camera.floor);
  SynthOptions options = small("trousers");
  options.motions = {"turn"};
  options.n_frames = kEmpty + 4;
  options.cloth = false;
  options.floor = true;
  const Sequence s(options, "floor");
  ASSERT_TRUE(s.camera.floor);
  const auto& n = s.camera.floor->normal;
  for (int frame = kEmpty; frame < s.report.n_frames; ++frame) {
    double lowest = 1e9;
    for (int i = 0; i < s.truth.n_points; ++i) {
      const float* p = s.truth.sample(frame) + 3 * i;  // glTF, metres
      lowest = std::min(lowest, 1000 * (n[0] * p[0] - n[1] * p[1] - n[2] * p[2]) + s.camera.floor->distance_mm);
    }
    EXPECT_NEAR(lowest, 0, test::kOnFloorMm) << "frame " << frame;
  }
}

TEST(Sequence, StartsEmpty) {
  const Sequence& s = skirt();
  for (int frame = 0; frame < kEmpty; ++frame) {
    for (int i = 0; i < 3 * s.truth.n_points; ++i) ASSERT_TRUE(std::isnan(s.truth.sample(frame)[i]));
    EXPECT_TRUE(s.joints["frames"][frame].is_null());
    EXPECT_EQ(cv::countNonZero(s.mask(frame)), 0);
  }
  for (int i = 0; i < 3 * s.truth.n_points; ++i) ASSERT_TRUE(std::isfinite(s.truth.sample(kEmpty)[i]));
}

TEST(Sequence, TruthProjectsOntoTheMask) {
  const Sequence& s = skirt();
  const auto file = test::read_glb(read_file(s.folder / "actor.glb"));
  for (int frame = kEmpty; frame < kFrames; frame += 5) {
    const cv::Mat mask = s.mask(frame);
    cv::Mat wide, narrow, filled = cv::Mat::zeros(mask.size(), CV_8U);
    const cv::Mat disc = cv::getStructuringElement(cv::MORPH_ELLIPSE, {5, 5});
    cv::dilate(mask, wide, disc);
    int inside = 0;
    constexpr int kShift = 4;  // sixteenths of a pixel
    std::vector<cv::Point> at;
    for (int i = 0; i < s.truth.n_points; ++i) {
      const cv::Point2d p = s.project(s.truth.sample(frame) + 3 * i);
      const cv::Point q(static_cast<int>(std::lround(p.x)), static_cast<int>(std::lround(p.y)));
      at.emplace_back(static_cast<int>(std::lround(p.x * (1 << kShift))),
                      static_cast<int>(std::lround(p.y * (1 << kShift))));
      inside += q.x >= 0 && q.y >= 0 && q.x < wide.cols && q.y < wide.rows && wide.at<uint8_t>(q) > 0;
    }
    EXPECT_GT(inside, test::kTruthMaskShare * s.truth.n_points) << "frame " << frame;
    // The other way round: what the truth fills is the mask, but for its border.
    for (const auto& t : file.triangles) {
      const cv::Point corners[3] = {at[t[0]], at[t[1]], at[t[2]]};
      cv::fillConvexPoly(filled, corners, 3, cv::Scalar(255), cv::LINE_8, kShift);
    }
    cv::erode(filled, narrow, disc);
    EXPECT_LT(cv::countNonZero(narrow & ~mask), (1 - test::kTruthMaskShare) * cv::countNonZero(mask))
        << "frame " << frame;
    EXPECT_GT(cv::countNonZero(filled & mask), test::kTruthMaskShare * cv::countNonZero(mask)) << "frame " << frame;
  }
}

TEST(Sequence, PictureShowsThePersonWhereTheMaskIs) {
  const Sequence& s = skirt();
  const cv::Mat plate = cv::imread((s.folder / "background.png").string());
  ASSERT_EQ(plate.cols, 272);
  VideoReader video((s.folder / "video.mp4").string());
  Frame frame;
  for (int i = 0; video.read(frame); ++i) {
    cv::Mat rgb(frame.image.height, frame.image.width, CV_8UC3, frame.image.pixels.data()), bgr, difference;
    cv::cvtColor(rgb, bgr, cv::COLOR_RGB2BGR);
    cv::absdiff(bgr, plate, difference);
    if (i < kEmpty) {
      const cv::Scalar mean = cv::mean(difference);
      EXPECT_LT(mean[0] + mean[1] + mean[2], 3 * 6) << "an empty frame is the plate but for noise and gain";
    } else if (i % 10 == 0) {
      const cv::Mat mask = s.mask(i);
      const cv::Scalar in = cv::mean(difference, mask), out = cv::mean(difference, ~mask);
      EXPECT_GT(in[0] + in[1] + in[2], 8 * (out[0] + out[1] + out[2])) << "frame " << i;
    }
  }
}

TEST(Sequence, BonesKeepTheirLengths) {
  const Sequence& s = skirt();
  const std::vector<std::string> names = s.joints["names"];
  const auto index = [&](const std::string& name) {
    return static_cast<size_t>(std::find(names.begin(), names.end(), name) - names.begin());
  };
  const auto at = [&](int frame, const std::string& name) {
    const auto& p = s.joints["frames"][frame].at(index(name));
    return Eigen::Vector3d(p[0], p[1], p[2]);
  };
  for (const auto& [a, b] : {std::pair{"Hips", "Spine"},
                             {"LeftArm", "LeftForeArm"},
                             {"RightForeArm", "RightHand"},
                             {"LeftUpLeg", "LeftLeg"},
                             {"RightLeg", "RightFoot"},
                             {"Neck", "Head"}}) {
    const double length = (at(kEmpty, a) - at(kEmpty, b)).norm();
    EXPECT_GT(length, 0.05);
    for (int frame = kEmpty + 1; frame < kFrames; ++frame)
      EXPECT_NEAR((at(frame, a) - at(frame, b)).norm(), length, test::kJointRounding)
          << a << "-" << b << ", frame " << frame;
  }
  // She faces the camera at first: her left is on the right of the picture, her head above her feet.
  EXPECT_GT(at(kEmpty, "LeftArm").x(), at(kEmpty, "RightArm").x());
  EXPECT_GT(at(kEmpty, "Head").y(), at(kEmpty, "LeftFoot").y() + 1);
  EXPECT_NEAR(at(kEmpty, "Hips").z(), -3.6, 0.4);
}

TEST(Sequence, SkirtSwingsBeyondSkinning) {
  for (const std::string actor : {"skirt", "trousers"}) {
    SynthOptions options = small(actor);
    options.cloth = false;
    const Sequence stiff(options, actor + "_stiff");
    options.cloth = true;
    const Sequence loose(options, actor + "_loose");
    EXPECT_EQ(stiff.report.cloth_p95_mm, 0);
    const int label = actor == "skirt" ? 12 : 5;
    const std::string labels = read_file(loose.folder / "truth" / "labels.npy");
    std::vector<double> swing;
    double largest = 0, elsewhere = 0;
    for (int frame = kEmpty; frame < kFrames; ++frame)
      for (int i = 0; i < loose.truth.n_points; ++i) {
        double d2 = 0;
        for (int k = 0; k < 3; ++k)
          d2 += std::pow(loose.truth.sample(frame)[3 * i + k] - stiff.truth.sample(frame)[3 * i + k], 2);
        const int of = labels[labels.size() - loose.truth.n_points + i];
        largest = std::max(largest, std::sqrt(d2));
        if (of == label) swing.push_back(1000 * std::sqrt(d2));
        if (of == 2 || of >= 13) elsewhere = std::max(elsewhere, std::sqrt(d2));
      }
    std::sort(swing.begin(), swing.end());
    const double p95 = swing[swing.size() * 95 / 100];
    EXPECT_GT(p95, 10) << actor << ": mm";
    EXPECT_LT(largest, 0.265) << "m";
    EXPECT_EQ(elsewhere, 0) << "skin, hair and shoes do not swing";
  }
}

TEST(Sequence, IsTheSameEveryTime) {
  SynthOptions options = small("skirt");
  const Sequence again(options, "again");
  for (const char* name : {"actor.glb", "camera.json", "background.png", "video.mp4", "truth/vertices.pc2",
                           "truth/joints.json", "truth/labels.npy", "truth/masks/000020.png"})
    EXPECT_TRUE(read_file(again.folder / name) == read_file(skirt().folder / name)) << name;
}

TEST(Sequence, StaysValidWhenStopped) {
  const auto folder = std::filesystem::temp_directory_path() / ("livecap_synth_stop" + std::to_string(::getpid()));
  const SynthReport report = write_sequence(small("trousers"), folder, [](int frame, int) { return frame < 5; });
  EXPECT_EQ(report.n_frames, 5);
  EXPECT_EQ(read_pc2(folder / "truth" / "vertices.pc2").n_samples, 5);
  EXPECT_EQ(nlohmann::json::parse(read_file(folder / "truth" / "joints.json"))["frames"].size(), 5u);
  // A shorter run into the same folder leaves nothing of the longer one.
  write_sequence(small("trousers"), folder, [](int frame, int) { return frame < 3; });
  EXPECT_TRUE(std::filesystem::exists(folder / "truth/masks/000002.png"));
  EXPECT_FALSE(std::filesystem::exists(folder / "truth/masks/000003.png"));
  EXPECT_FALSE(std::filesystem::exists(folder / "truth/masks/000004.png"));
  std::filesystem::remove_all(folder);
}

TEST(Sequence, RefusesBadOptions) {
  const auto folder = std::filesystem::temp_directory_path() / ("livecap_synth_never" + std::to_string(::getpid()));
  const auto refuse = [&](auto change) {
    SynthOptions options = small("skirt");
    change(options);
    EXPECT_THROW(write_sequence(options, folder), ConfigError);
  };
  refuse([](SynthOptions& o) { o.actor = "robot"; });
  refuse([](SynthOptions& o) { o.motions.clear(); });
  refuse([](SynthOptions& o) { o.motions = {"fly"}; });
  refuse([](SynthOptions& o) { o.crouch_deg = 60; });
  refuse([](SynthOptions& o) { o.width = 271; });
  refuse([](SynthOptions& o) { o.fps = 0; });
  refuse([](SynthOptions& o) { o.fov_deg = NAN; });
  refuse([](SynthOptions& o) { o.height_mm = 1e9; });
  EXPECT_FALSE(std::filesystem::exists(folder));
  EXPECT_THROW(write_sequence(small("skirt"), "/proc/nowhere"), IoError);
}

}  // namespace
}  // namespace livecap
