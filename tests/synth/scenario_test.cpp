// Difficult sequences: does the truth stay true, and is the difficulty there?
#include "synth/scenario.h"

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>

#include "base/text.h"
#include "image/video.h"
#include "livecap/error.h"
#include "support/tolerances.h"
#include "synth/synth.h"

namespace livecap {
namespace {

constexpr int kScenarioFrames = 40;
constexpr size_t kPc2Header = 32;

struct ScenarioSequence {
  std::filesystem::path folder;
  SynthReport report;
  std::string vertices;  // of vertices.pc2, without its header
  nlohmann::json joints;
  std::vector<cv::Mat> pictures;  // [n_frames] BGR
  std::vector<double> pts_ms;

  ScenarioSequence(const std::string& scenario, int n_frames = kScenarioFrames) {
    SynthOptions options;
    options.scenario = scenario;
    options.motions = {"walk"};
    options.width = 136;
    options.height = 240;
    options.noise = 0;
    options.gain_drift = 0;
    options.empty_frames = 0;
    options.n_frames = n_frames;
    folder = std::filesystem::temp_directory_path() / ("livecap_scenario_" + scenario + std::to_string(::getpid()));
    report = write_sequence(options, folder);
    vertices = read_file(folder / "truth" / "vertices.pc2").substr(kPc2Header);
    joints = nlohmann::json::parse(read_file(folder / "truth" / "joints.json"))["frames"];
    VideoReader video((folder / "video.mp4").string());
    for (Frame frame; video.read(frame);) {
      const cv::Mat rgb(frame.image.height, frame.image.width, CV_8UC3, frame.image.pixels.data());
      cv::cvtColor(rgb, pictures.emplace_back(), cv::COLOR_RGB2BGR);
      pts_ms.push_back(frame.pts_ms);
    }
  }
  ~ScenarioSequence() { std::filesystem::remove_all(folder); }

  cv::Mat mask(int frame) const {
    return cv::imread((folder / "truth" / "masks" / format("%06d.png", frame)).string(), cv::IMREAD_UNCHANGED);
  }
  std::string vertices_of(int frame) const {
    const size_t size = size_t(12) * report.n_vertices;
    return vertices.substr(frame * size, size);
  }
  bool has_vertices(int frame) const { return !std::isnan(*reinterpret_cast<const float*>(&vertices_of(frame)[0])); }
  cv::Mat plate() const { return cv::imread((folder / "background.png").string()); }
};

const ScenarioSequence& undisturbed() {
  static const ScenarioSequence sequence("none");
  return sequence;
}

// Pixels of a BGR picture that are darker than another by more than the given number of levels.
cv::Mat darker(const cv::Mat& picture, const cv::Mat& than, int levels) {
  cv::Mat a, b;
  cv::cvtColor(picture, a, cv::COLOR_BGR2GRAY);
  cv::cvtColor(than, b, cv::COLOR_BGR2GRAY);
  return a + levels < b;
}

TEST(Scenario, LeavingIsOutOfThePictureAndBack) {
  const ScenarioSequence s("leave", 110);
  ASSERT_EQ(s.report.n_frames, 110);
  int gone = -1, back = -1;
  for (int i = 0; i < 110; ++i) {
    const bool visible = cv::countNonZero(s.mask(i)) > 0;
    const bool known = !s.joints[i].is_null();
    EXPECT_EQ(known, s.has_vertices(i)) << i;
    if (visible) EXPECT_TRUE(known) << i;
    if (!known && gone < 0) gone = i;
    if (known && gone >= 0 && back < 0) back = i;
    if (back >= 0) EXPECT_TRUE(known) << i;
  }
  ASSERT_GT(gone, 0);
  EXPECT_GT(back, gone + 15);
  EXPECT_LT(back, 80);
  cv::Mat difference;
  cv::absdiff(s.pictures[gone + 5], s.plate(), difference);
  const cv::Scalar mean = cv::mean(difference);
  EXPECT_LT(mean[0] + mean[1] + mean[2], 3 * test::kVideoColour);
}

TEST(Scenario, ThePasserByIsNotPartOfTheTruth) {
  const ScenarioSequence s("two-people");
  EXPECT_TRUE(s.vertices == undisturbed().vertices);
  EXPECT_EQ(s.joints, undisturbed().joints);
  int frames_with_two = 0;
  for (int i = 0; i < kScenarioFrames; ++i) {
    EXPECT_EQ(cv::countNonZero(s.mask(i) != undisturbed().mask(i)), 0) << "behind her he covers nothing";
    cv::Mat difference, gray;
    cv::absdiff(s.pictures[i], undisturbed().pictures[i], difference);
    cv::cvtColor(difference, gray, cv::COLOR_BGR2GRAY);
    gray.setTo(0, s.mask(i));
    frames_with_two += cv::countNonZero(gray > 30) > 200;
  }
  EXPECT_GT(frames_with_two, 15);
}

TEST(Scenario, TheShadowMovesAndTheTruthDoesNot) {
  const ScenarioSequence s("moving-shadow");
  EXPECT_TRUE(s.vertices == undisturbed().vertices);
  const auto middle = [&](int frame) {
    const cv::Moments m = cv::moments(darker(s.pictures[frame], undisturbed().pictures[frame], 12), true);
    EXPECT_GT(m.m00, 0.03 * s.pictures[frame].total()) << frame;
    return m.m10 / m.m00;
  };
  EXPECT_GT(middle(25), middle(5) + 20) << "px";
}

TEST(Scenario, TheRoomHasTheColoursOfTheClothes) {
  const ScenarioSequence s("similar-background");
  EXPECT_TRUE(s.vertices == undisturbed().vertices);
  // Upper and lower half of the person against the plate there, mean colours; against the plain room for comparison.
  const cv::Mat mask = s.mask(0);
  const cv::Rect box = cv::boundingRect(mask);
  const auto distance = [&](const ScenarioSequence& of, int from, int to) {
    cv::Mat part = cv::Mat::zeros(mask.size(), CV_8U);
    const cv::Rect rows(0, box.y + from * box.height / 100, mask.cols, (to - from) * box.height / 100);
    mask(rows).copyTo(part(rows));
    return cv::norm(cv::mean(of.pictures[0], part) - cv::mean(of.plate(), part));
  };
  EXPECT_LT(distance(s, 25, 40), 0.6 * distance(undisturbed(), 25, 40));
  EXPECT_LT(distance(s, 48, 65), 0.6 * distance(undisturbed(), 48, 65));
}

TEST(Scenario, AGapKeepsTheTimesOfWhatIsLeft) {
  const ScenarioSequence s("gap");  // 1.33 s: frames 21, 22 and 23 are missing
  ASSERT_EQ(s.report.n_frames, kScenarioFrames - 3);
  ASSERT_EQ(s.pictures.size(), static_cast<size_t>(kScenarioFrames - 3));
  ASSERT_EQ(s.joints.size(), static_cast<size_t>(kScenarioFrames - 3));
  for (int i = 0; i < kScenarioFrames - 3; ++i) {
    const int at = i < 21 ? i : i + 3;
    EXPECT_NEAR(s.pts_ms[i], 1000 * at / 30.0, test::kPtsMs);
    EXPECT_TRUE(s.vertices_of(i) == undisturbed().vertices_of(at)) << i;
    EXPECT_EQ(cv::countNonZero(s.mask(i) != undisturbed().mask(at)), 0) << i;
  }
}

TEST(Scenario, UnknownNameIsRefused) {
  SynthOptions options;
  options.scenario = "earthquake";
  EXPECT_THROW(options.validate(), ConfigError);
  for (const std::string& name : scenario_names()) {
    options.scenario = name;
    EXPECT_NO_THROW(options.validate());
  }
}

}  // namespace
}  // namespace livecap
