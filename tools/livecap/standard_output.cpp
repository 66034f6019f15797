#include "standard_output.h"

#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <cstdio>

#include "livecap/error.h"

namespace livecap::tools {
namespace {

extern "C" void on_closed_pipe(int) {}

bool reader_is_gone() {
  pollfd output{STDOUT_FILENO, POLLOUT, 0};
  return ::poll(&output, 1, 0) == 1 && (output.revents & (POLLERR | POLLHUP)) != 0;
}

}  // namespace

void outlive_closed_pipes() {
  std::signal(SIGPIPE, on_closed_pipe);  // not SIG_IGN, which the programs that are started would inherit
}

bool is_heard() {
  return std::fflush(stdout) == 0 && std::ferror(stdout) == 0;
}

void require_heard() {
  if (is_heard()) return;
  if (reader_is_gone()) {
    std::signal(SIGPIPE, SIG_DFL);
    std::raise(SIGPIPE);
  }
  throw IoError("standard output: cannot be written; is the disk full?");
}

}  // namespace livecap::tools
