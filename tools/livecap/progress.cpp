#include "progress.h"

#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <utility>

#include "base/log.h"
#include "base/text.h"

namespace livecap::tools {
namespace {

constexpr double kTerminalPeriodMs = 100;
constexpr double kLinePeriodMs = 1000;
constexpr int kBarWidth = 24;

volatile std::sig_atomic_t g_interrupted = 0;

extern "C" void on_interrupt(int signal) {
  g_interrupted = 1;
  // A terminal that is closed may say so twice, by the kernel and by its shell.
  std::signal(signal, signal == SIGHUP ? SIG_IGN : SIG_DFL);
}

}  // namespace

Progress::Progress(std::string what)
    : what_(std::move(what)), quiet_(log_level() == LogLevel::kError), terminal_(::isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (line_open_) std::fputc('\n', stderr);
}

void Progress::update(int64_t done, int64_t total, const std::string& detail) {
  if (quiet_) return;
  done_ = done;
  total_ = total;
  detail_ = detail;
  dirty_ = true;
  const double now_ms = timer_.elapsed_ms();
  if (first_ms_ < 0) {
    first_ms_ = now_ms;
    first_done_ = done;
  }
  if (now_ms - printed_ms_ >= (terminal_ ? kTerminalPeriodMs : kLinePeriodMs)) print();
}

void Progress::finish() {
  if (!quiet_ && dirty_) print();
  if (line_open_) std::fputc('\n', stderr);
  line_open_ = false;
}

void Progress::print() {
  const double now_ms = timer_.elapsed_ms();
  printed_ms_ = now_ms;
  dirty_ = false;
  const double seconds = (now_ms - first_ms_) / 1000;
  const double fps = seconds > 0 ? static_cast<double>(done_ - first_done_) / seconds : 0;

  std::string line = what_;
  if (total_ > 0) {
    const double part = std::clamp(static_cast<double>(done_) / static_cast<double>(total_), 0.0, 1.0);
    if (terminal_) {
      const int filled = static_cast<int>(part * kBarWidth);
      line += " [" + std::string(filled, '#') + std::string(kBarWidth - filled, '.') + "]";
    }
    line += format(" %lld/%lld %3.0f %%", static_cast<long long>(done_), static_cast<long long>(total_), 100 * part);
  } else {
    line += format(" %lld", static_cast<long long>(done_));
  }
  line += format(" %.1f fps", fps);
  if (total_ > done_ && fps > 0) {
    line += " ETA " + format_duration(static_cast<double>(total_ - done_) / fps);
  }
  if (!detail_.empty()) line += " " + detail_;
  std::fprintf(stderr, terminal_ ? "\r\033[K%s" : "%s\n", line.c_str());
  std::fflush(stderr);
  line_open_ = terminal_;
}

void StageProgress::update(const std::string& stage, int64_t done, int64_t total) {
  if (stage != stage_) {
    finish();
    progress_.emplace(what_ + ": " + stage);
    stage_ = stage;
  }
  progress_->update(done, total);
}

void StageProgress::finish() {
  if (progress_) progress_->finish();
  progress_.reset();
  stage_.clear();
}

std::string format_duration(double seconds) {
  const long long whole = static_cast<long long>(std::clamp(seconds, 0.0, 359999.0) + 0.5);
  if (whole >= 3600) return format("%lld:%02lld:%02lld", whole / 3600, whole / 60 % 60, whole % 60);
  return format("%lld:%02lld", whole / 60, whole % 60);
}

void catch_interrupt() {
  std::signal(SIGINT, on_interrupt);
  std::signal(SIGTERM, on_interrupt);
  if (std::signal(SIGHUP, on_interrupt) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);  // started by nohup
}
bool interrupted() {
  return g_interrupted != 0;
}

}  // namespace livecap::tools
