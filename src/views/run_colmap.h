// Where the cameras of a set of pictures stood, by running COLMAP when it is installed (docs/actor_build.md).
#pragma once

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "base/scratch_folder.h"

namespace livecap {

// A COLMAP text model in a folder of its own, which goes when this does.
class ColmapRun {
 public:
  // pictures: folder of .png and .jpg. progress: false stops. Features, matches of every pair, mapper. Throws
  // ConfigError when no executable `colmap` is on PATH, when it fails (with its last line), or places fewer than half
  // of the pictures; Error when stopped.
  ColmapRun(const std::filesystem::path& pictures, std::vector<std::string>& notes,
            const std::function<bool(int done, int total)>& progress = {});

  const std::filesystem::path& model() const { return model_; }  // cameras.txt and images.txt

 private:
  void run(const std::vector<std::string>& arguments);
  // Its exit status, as waitpid has it.
  int status_of(const std::vector<std::string>& arguments);
  std::string use_gpu_option(const std::string& command, const std::string& step);

  std::function<bool(int, int)> progress_;
  int step_ = 0;
  ScratchFolder folder_;
  std::filesystem::path model_;
};

}  // namespace livecap
