#include "detect/detections_io.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <random>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

class DetectionsIo : public testing::Test {
 protected:
  DetectionsIo()
      : path_(std::filesystem::temp_directory_path() / format("livecap_detections_%d.jsonl", int(::getpid()))) {}
  ~DetectionsIo() override { std::filesystem::remove(path_); }

  // The message of the IoError that loading this text gives; "" when it loads.
  std::string error_of(const std::string& text) {
    write_file_atomically(path_, text);
    try {
      detect::load_detections(path_);
    } catch (const IoError& e) {
      return e.what();
    }
    return "";
  }

  std::filesystem::path path_;
};

TEST_F(DetectionsIo, ReadsBackWhatWasWrittenAfterEveryFrame) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<float> uniform(-1000, 1000);
  std::vector<Detections> frames;
  detect::DetectionsWriter writer(path_);
  for (int i = 0; i < 5; ++i) {
    Detections d;
    d.frame_index = 3 * i;
    d.person = i != 2;
    d.score = d.person ? 0.97f : 0.1f;
    if (d.person) {
      for (auto& k : d.keypoints) k = {uniform(rng), uniform(rng), uniform(rng), uniform(rng), uniform(rng), 0.3f};
    }
    frames.push_back(d);
    writer.append(d);
    const auto read = detect::load_detections(path_);
    ASSERT_EQ(read.size(), frames.size());
    EXPECT_EQ(read[i].frame_index, d.frame_index);
    EXPECT_EQ(read[i].person, d.person);
    EXPECT_EQ(read[i].score, d.score);
    for (int k = 0; k < kKeypointCount; ++k) {
      EXPECT_EQ(read[i].keypoints[k].x_px, d.keypoints[k].x_px);
      EXPECT_EQ(read[i].keypoints[k].z_mm, d.keypoints[k].z_mm);
      EXPECT_EQ(read[i].keypoints[k].confidence, d.keypoints[k].confidence);
    }
  }
}

TEST_F(DetectionsIo, ErrorsNameTheLineAndTheField) {
  const std::string good = "{\"frame\":0,\"person\":false,\"score\":0.1,\"keypoints\":{}}\n";
  EXPECT_EQ(error_of(good), "");
  EXPECT_EQ(error_of(""), "");
  const std::pair<const char*, const char*> cases[] = {
      {"{\"frame\":1,\"pers", ":2: not valid JSON"},
      {"[1]", ":2: expected a JSON object"},
      {"{\"person\":false,\"score\":0.1}", ":2: field \"frame\" is missing"},
      {"{\"frame\":0,\"person\":false,\"score\":0.1}", ":2: field \"frame\" is 0 after 0"},
      {"{\"frame\":9223372036854775808,\"person\":false,\"score\":0}", "field \"frame\" must be"},
      {"{\"frame\":1,\"person\":1,\"score\":0.1}", "field \"person\""},
      {"{\"frame\":1,\"person\":true,\"score\":null,\"keypoints\":{}}", "field \"score\""},
      {"{\"frame\":1,\"person\":true,\"score\":0.9}", "field \"keypoints\" is missing"},
      {"{\"frame\":1,\"person\":true,\"score\":0.9,\"keypoints\":{\"tail\":[0,0,0,0,0,0]}}",
       "unknown keypoint \"tail\""},
      {"{\"frame\":1,\"person\":true,\"score\":0.9,\"keypoints\":{\"nose\":[0,0,0]}}",
       "keypoint \"nose\" must be a list of 6"},
      {"{\"frame\":1,\"person\":true,\"score\":0.9,\"keypoints\":{\"nose\":[0,0,0,0,0,2]}}",
       "confidence 2 must be in 0..1"},
      {"{\"frame\":1,\"person\":true,\"score\":0.9,\"keypoints\":{\"nose\":[1e99,0,0,0,0,1]}}",
       "\"nose\" must be a finite number"},
  };
  for (const auto& [line, expected] : cases) {
    const std::string message = error_of(good + line);
    EXPECT_NE(message.find(expected), std::string::npos) << line << " gave: " << message;
    EXPECT_NE(message.find(path_.string()), std::string::npos) << message;
  }
}

TEST_F(DetectionsIo, UnwritableFileIsAnError) {
  EXPECT_THROW(detect::DetectionsWriter("/no/such/folder/d.jsonl"), IoError);
}

}  // namespace
}  // namespace livecap
