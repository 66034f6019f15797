// Running COLMAP, with a script of that name on PATH in its place: what is asked of it, and what becomes of its
// answers.
#include "views/run_colmap.h"

#include <gtest/gtest.h>

#include <csignal>
#include <cstdlib>
#include <stdexcept>

#include "base/text.h"
#include "image/image_io.h"
#include "livecap/error.h"
#include "views/camera_files.h"

namespace livecap {
namespace {

// Writes what it was asked to asked.txt and refuses options that it does not know; its mapper makes two models, the
// second with N_PLACED pictures.
constexpr char kScript[] = R"script(#!/bin/sh
echo "$@" >> "$(dirname "$0")/asked.txt"
command=$1
case $command in
  feature_extractor) options="database_path image_path ImageReader.camera_model ImageReader.single_camera"
    options="$options $EXTRACTION.use_gpu" ;;
  exhaustive_matcher) options="database_path $MATCHING.use_gpu" ;;
  mapper) options="database_path image_path output_path" ;;
  model_converter) options="input_path output_path output_type" ;;
esac
for word in "$@"; do
  case $word in
    -h) for option in $options; do echo "  --$option arg"; done; exit 0 ;;
    --*) case " $options " in
        *" ${word#--} "*) ;;
        *) echo "unrecognised option '$word'"; exit 1 ;;
      esac ;;
  esac
done
while [ $# -gt 1 ]; do
  case $1 in --output_path) out=$2 ;; --input_path) in=$2 ;; esac
  shift
done
if [ "$command" = "$FAILING" ]; then echo "first"; echo "no memory for features"; exit 3; fi
case $command in
  mapper) mkdir -p "$out/0" "$out/1" ;;
  model_converter)
    echo "1 SIMPLE_RADIAL 64 64 70 32 32 0.01" > "$out/cameras.txt"
    n=2
    if [ "$(basename "$in")" = 1 ]; then n=$N_PLACED; fi
    i=0
    : > "$out/images.txt"
    while [ $i -lt $n ]; do
      printf '%d 1 0 0 0 0 0 5 1 %02d.png\n\n' $i $i >> "$out/images.txt"
      i=$((i + 1))
    done ;;
esac
)script";

class RunColmap : public testing::Test {
 protected:
  RunColmap() : folder_(std::filesystem::path(testing::TempDir()) / "run_colmap_test"), path_(getenv("PATH")) {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_ / "images");
    std::filesystem::create_directories(folder_ / "tmp");
    for (int i = 0; i < 10; ++i)
      write_png(ImageGray{64, 64, std::vector<uint8_t>(64 * 64, 90)}, folder_ / "images" / format("%02d.png", i));
    setenv("TMPDIR", (folder_ / "tmp").c_str(), 1);
    setenv("N_PLACED", "9", 1);
    setenv("FAILING", "nothing", 1);
    setenv("EXTRACTION", "SiftExtraction", 1);
    setenv("MATCHING", "SiftMatching", 1);
  }
  ~RunColmap() override {
    setenv("PATH", path_.c_str(), 1);
    for (const char* name : {"TMPDIR", "N_PLACED", "FAILING", "EXTRACTION", "MATCHING"}) unsetenv(name);
    std::filesystem::remove_all(folder_);
  }
  void install(const std::string& script = kScript) {
    std::filesystem::create_directories(folder_ / "bin");
    write_file_atomically(folder_ / "bin" / "colmap", script);
    std::filesystem::permissions(folder_ / "bin" / "colmap", std::filesystem::perms::owner_all);
    setenv("PATH", ((folder_ / "bin").string() + ":" + path_).c_str(), 1);
  }
  std::string failure() {
    std::vector<std::string> notes;
    try {
      ColmapRun run(folder_ / "images", notes);
    } catch (const Error& error) {
      return error.what();
    }
    return "none";
  }

  std::filesystem::path folder_;
  std::string path_;
};

TEST_F(RunColmap, TakesTheLargestModelAndCleansUp) {
  install();
  std::vector<std::string> notes;
  {
    const ColmapRun run(folder_ / "images", notes);
    const std::vector<ViewPose> poses = read_view_poses(run.model());
    ASSERT_EQ(poses.size(), 9u);
    EXPECT_DOUBLE_EQ(poses[0].camera.distortion[0], 0.01);
    EXPECT_FALSE(std::filesystem::is_empty(folder_ / "tmp"));
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "tmp"));
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("9 of 10"), std::string::npos) << notes[0];
  const std::string asked = read_file(folder_ / "bin" / "asked.txt");
  size_t at = 0;
  for (const char* step : {"feature_extractor", "exhaustive_matcher", "mapper", "model_converter"}) {
    at = asked.find(step, at);
    ASSERT_NE(at, std::string::npos) << step << " in order, in\n" << asked;
  }
  EXPECT_NE(asked.find("--ImageReader.single_camera 1"), std::string::npos) << asked;
  // Pictures of two sizes are of two cameras.
  write_png(ImageGray{96, 64, std::vector<uint8_t>(96 * 64, 90)}, folder_ / "images" / "03.png");
  ColmapRun(folder_ / "images", notes);
  EXPECT_NE(read_file(folder_ / "bin" / "asked.txt").find("--ImageReader.single_camera 0"), std::string::npos);
}

TEST_F(RunColmap, WhatGoesWrongIsOneLine) {
  install();
  setenv("N_PLACED", "4", 1);
  EXPECT_NE(failure().find("COLMAP places only 4 of 10"), std::string::npos) << failure();
  setenv("N_PLACED", "9", 1);
  setenv("FAILING", "exhaustive_matcher", 1);
  EXPECT_NE(failure().find("`colmap exhaustive_matcher` failed: no memory for features"), std::string::npos)
      << failure();
  setenv("PATH", (folder_ / "nowhere").c_str(), 1);
  EXPECT_NE(failure().find("apt install colmap"), std::string::npos) << failure();
  setenv("PATH", path_.c_str(), 1);
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "tmp"));
  for (int i = 3; i < 10; ++i) std::filesystem::remove(folder_ / "images" / format("%02d.png", i));
  EXPECT_NE(failure().find("3 pictures; at least 8"), std::string::npos) << failure();
  std::filesystem::remove_all(folder_ / "images");
  EXPECT_NE(failure().find("no folder of pictures"), std::string::npos) << failure();
}

TEST_F(RunColmap, CanBeStopped) {
  install("#!/bin/sh\nexec sleep 60\n");
  std::vector<std::string> notes;
  EXPECT_THROW(ColmapRun(folder_ / "images", notes, [](int, int) { return false; }), Error);
  EXPECT_TRUE(std::filesystem::is_empty(folder_ / "tmp"));
}

TEST_F(RunColmap, Version4CallsItsOptionsOtherwise) {
  install();
  setenv("EXTRACTION", "FeatureExtraction", 1);
  setenv("MATCHING", "FeatureMatching", 1);
  EXPECT_EQ(failure(), "none");
  const std::string asked = read_file(folder_ / "bin" / "asked.txt");
  EXPECT_NE(asked.find("--FeatureExtraction.use_gpu 0"), std::string::npos) << asked;
  EXPECT_NE(asked.find("--FeatureMatching.use_gpu 0"), std::string::npos) << asked;
}

// Nobody can wait for the children of a program that ignores their end.
TEST_F(RunColmap, AnEndThatNobodySawIsNoSuccess) {
  install();
  const auto before = std::signal(SIGCHLD, SIG_IGN);
  const std::string what = failure();
  std::signal(SIGCHLD, before);
  EXPECT_NE(what.find("cannot be told how `colmap` ended"), std::string::npos) << what;
}

TEST_F(RunColmap, DoesNotOutliveAProgressThatThrows) {
  install("#!/bin/sh\necho $$ > \"$(dirname \"$0\")/id\"\nexec sleep 60\n");
  const std::filesystem::path file = folder_ / "bin" / "id";
  std::vector<std::string> notes;
  EXPECT_THROW(ColmapRun(folder_ / "images", notes,
                         [&](int, int) {
                           if (std::filesystem::exists(file) && std::filesystem::file_size(file) > 0)
                             throw std::runtime_error("enough");
                           return true;
                         }),
               std::runtime_error);
  EXPECT_NE(kill(std::stoi(read_file(file)), 0), 0) << "it still runs";
}

}  // namespace
}  // namespace livecap
