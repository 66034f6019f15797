#include "views/run_colmap.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <set>
#include <sstream>
#include <system_error>
#include <thread>

#include "base/text.h"
#include "image/image_io.h"
#include "livecap/error.h"
#include "views/camera_files.h"
#include "views/load_views.h"

extern char** environ;

namespace livecap {

namespace {

using std::filesystem::path;

constexpr int kSteps = 4;
constexpr char kLog[] = "log.txt";  // of the last command

std::vector<path> pictures_in(const path& folder) {
  if (!std::filesystem::is_directory(folder)) throw IoError(folder.string() + ": is no folder of pictures");
  std::vector<path> pictures;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder)) {
    std::string kind = entry.path().extension().string();
    std::transform(kind.begin(), kind.end(), kind.begin(), [](unsigned char c) { return std::tolower(c); });
    if (kind == ".png" || kind == ".jpg" || kind == ".jpeg") pictures.push_back(entry.path());
  }
  return pictures;
}

bool all_of_one_size(const std::vector<path>& pictures) {
  std::set<std::pair<int, int>> sizes;
  for (const path& picture : pictures) {
    try {
      sizes.insert(stored_picture_size(picture));
    } catch (const IoError&) {  // COLMAP leaves it out
    }
  }
  return sizes.size() <= 1;
}

// What still runs when this goes is killed: the progress callback may throw.
class Child {
 public:
  explicit Child(pid_t id) : id_(id) {}
  ~Child() {
    if (ended_) return;
    kill(id_, SIGKILL);
    while (waitpid(id_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  // status: as waitpid gives it. Throws Error when nobody can tell, as in a program that ignores SIGCHLD.
  bool has_ended(int& status) {
    pid_t found;
    do {
      found = waitpid(id_, &status, WNOHANG);
    } while (found < 0 && errno == EINTR);
    if (found == 0) return false;
    ended_ = true;
    if (found < 0)
      throw Error(std::string("--colmap: it cannot be told how `colmap` ended: ") + std::strerror(errno) +
                  " (is SIGCHLD ignored?)");
    return true;
  }

 private:
  pid_t id_;
  bool ended_ = false;
};

std::string last_line(const path& log) {
  std::istringstream in(read_file(log));
  std::string last;
  for (std::string line; std::getline(in, line);)
    if (line.find_first_not_of(" \t\r=") != std::string::npos) last = line;
  return last;
}

}  // namespace

ColmapRun::ColmapRun(const path& pictures, std::vector<std::string>& notes,
                     const std::function<bool(int, int)>& progress)
    : progress_(progress) {
  const std::vector<path> files = pictures_in(pictures);
  if (static_cast<int>(files.size()) < kMinViews)
    throw ConfigError(format("%s: %zu pictures; at least %d from all around are needed, 40 to 80 are good",
                             pictures.string().c_str(), files.size(), kMinViews));
  const std::string database = (folder_ / "database.db").string(), images = pictures.string();
  const path sparse = folder_ / "sparse", text = folder_ / "text";
  std::filesystem::create_directories(sparse);
  std::filesystem::create_directories(text);
  // One camera when all pictures have one size; a model this program reads.
  run({"feature_extractor", "--database_path", database, "--image_path", images, "--ImageReader.camera_model",
       "SIMPLE_RADIAL", "--ImageReader.single_camera", all_of_one_size(files) ? "1" : "0",
       use_gpu_option("feature_extractor", "Extraction"), "0"});
  run({"exhaustive_matcher", "--database_path", database, use_gpu_option("exhaustive_matcher", "Matching"), "0"});
  run({"mapper", "--database_path", database, "--image_path", images, "--output_path", sparse.string()});
  // The mapper may make several models: the one with most pictures.
  size_t most = 0;
  for (const auto& entry : std::filesystem::directory_iterator(sparse)) {
    const path converted = text / entry.path().filename();
    std::filesystem::create_directories(converted);
    run({"model_converter", "--input_path", entry.path().string(), "--output_path", converted.string(), "--output_type",
         "TXT"});
    const size_t n = read_view_poses(converted).size();
    if (n > most) most = n, model_ = converted;
  }
  if (2 * most < files.size() || model_.empty())
    throw ConfigError(
        format("%s: COLMAP places only %zu of %zu pictures; more of them, sharper, with more overlap and "
               "a room with texture are needed (or --video, turning before a static camera)",
               pictures.string().c_str(), most, files.size()));
  if (most < files.size())
    notes.push_back(format("COLMAP places %zu of %zu pictures; the others are left out", most, files.size()));
}

// COLMAP 4 has other features than SIFT and calls it so.
std::string ColmapRun::use_gpu_option(const std::string& command, const std::string& step) {
  status_of({command, "-h"});  // some versions call help a failure
  const std::string of_any_feature = "--Feature" + step + ".use_gpu";
  return read_file(folder_ / kLog).find(of_any_feature) != std::string::npos ? of_any_feature
                                                                             : "--Sift" + step + ".use_gpu";
}

void ColmapRun::run(const std::vector<std::string>& arguments) {
  const int status = status_of(arguments);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw ConfigError("--colmap: `colmap " + arguments.front() + "` failed: " + last_line(folder_ / kLog));
  step_ = std::min(step_ + 1, kSteps - 1);
}

int ColmapRun::status_of(const std::vector<std::string>& arguments) {
  std::vector<std::string> words = {"colmap"};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  // Its graphical parts need no screen.
  std::vector<std::string> settings;
  for (char** entry = environ; *entry; ++entry)
    if (std::strncmp(*entry, "QT_QPA_PLATFORM=", 16) != 0) settings.emplace_back(*entry);
  settings.emplace_back("QT_QPA_PLATFORM=offscreen");
  std::vector<char*> envp;
  for (std::string& setting : settings) envp.push_back(setting.data());
  envp.push_back(nullptr);

  const path log = folder_ / kLog;
  posix_spawn_file_actions_t files;
  posix_spawn_file_actions_init(&files);
  posix_spawn_file_actions_addopen(&files, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
  posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  posix_spawn_file_actions_adddup2(&files, STDOUT_FILENO, STDERR_FILENO);
  pid_t child = 0;
  const int fault = posix_spawnp(&child, "colmap", &files, nullptr, argv.data(), envp.data());
  posix_spawn_file_actions_destroy(&files);
  if (fault == ENOENT)
    throw ConfigError("--colmap: no program `colmap` is installed (Debian: apt install colmap); or give --cameras");
  if (fault != 0) throw ConfigError(std::string("--colmap: `colmap` cannot be run: ") + std::strerror(fault));
  Child running(child);
  int status = 0;
  bool stopped = false;
  while (!running.has_ended(status)) {
    if (!stopped && progress_ && !progress_(step_, kSteps)) {
      kill(child, SIGTERM);
      stopped = true;
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  if (stopped) throw Error("interrupted while running COLMAP");
  return status;
}

}  // namespace livecap
