// Progress of a long run on standard error: a bar with speed and time left on a terminal, one line a second otherwise.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>

#include "base/timer.h"

namespace livecap::tools {

class Progress {
 public:
  // Prints nothing when the log level is kError (-q).
  explicit Progress(std::string what);
  // Ends the bar's line; also when an exception passes by.
  ~Progress();
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  // done of total items are finished; total = 0: unknown. `detail` is appended. Cheap enough for every frame.
  void update(int64_t done, int64_t total, const std::string& detail = {});
  // Prints the last state.
  void finish();

 private:
  void print();

  std::string what_;
  std::string detail_;
  int64_t done_ = 0;
  int64_t total_ = 0;
  bool quiet_ = false;
  bool terminal_ = false;
  bool line_open_ = false;
  bool dirty_ = false;     // something happened after the last print
  double printed_ms_ = 0;  // when that was
  double first_ms_ = -1;   // when the first item was done: start-up does not count in the speed
  int64_t first_done_ = 0;
  Timer timer_;
};

// Progress of a run in stages: each has a bar of its own.
class StageProgress {
 public:
  // what: stands before the stage's name.
  explicit StageProgress(std::string what) : what_(std::move(what)) {}

  // As Progress::update, of one stage; another one than before ends that.
  void update(const std::string& stage, int64_t done, int64_t total);
  void finish();

 private:
  std::string what_;
  std::string stage_;
  std::optional<Progress> progress_;
};

// "1:05" or "2:03:09".
std::string format_duration(double seconds);

// Installs a handler for Ctrl-C, for SIGTERM and for a closed terminal: the first one asks to stop, a second one (not
// of a terminal) ends the process as usual.
void catch_interrupt();
bool interrupted();

}  // namespace livecap::tools
