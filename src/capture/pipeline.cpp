#include "capture/pipeline.h"

#ifdef __linux__
#include <sys/resource.h>
#include <unistd.h>
#endif

#include <condition_variable>
#include <exception>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

#include "base/start_thread.h"
#include "capture/channel.h"

namespace livecap {
namespace {

// Remembers the first exception of any thread.
class FirstError {
 public:
  void capture() {
    std::lock_guard lock(mutex_);
    if (!error_) error_ = std::current_exception();
  }
  void rethrow() {
    if (error_) std::rethrow_exception(error_);
  }

 private:
  std::mutex mutex_;
  std::exception_ptr error_;
};

// How many items are under way, where that is limited.
class UnderWay {
 public:
  explicit UnderWay(int most) : most_(most) {}
  // Waits until another one may set out. False when the run is aborted.
  bool enter() {
    std::unique_lock lock(mutex_);
    changed_.wait(lock, [&] { return most_ == 0 || n_ < most_ || aborted_; });
    ++n_;
    return !aborted_;
  }
  void leave() {
    std::lock_guard lock(mutex_);
    --n_;
    changed_.notify_all();
  }
  void abort() {
    std::lock_guard lock(mutex_);
    aborted_ = true;
    changed_.notify_all();
  }

 private:
  std::mutex mutex_;
  std::condition_variable changed_;
  int most_;
  int n_ = 0;
  bool aborted_ = false;
};

// Threads that are told to stop and waited for, also when the system refuses another one.
class AbortedThreads {
 public:
  explicit AbortedThreads(std::function<void()> abort) : abort_(std::move(abort)) {}
  ~AbortedThreads() { abort_and_join(); }
  AbortedThreads(const AbortedThreads&) = delete;
  AbortedThreads& operator=(const AbortedThreads&) = delete;
  // Throws Error.
  void start(std::function<void()> body) { threads_.push_back(start_thread(std::move(body))); }
  void abort_and_join() {
    if (threads_.empty()) return;
    abort_();
    for (std::thread& thread : threads_) thread.join();
    threads_.clear();
  }

 private:
  std::function<void()> abort_;
  std::vector<std::thread> threads_;
};

// Of this thread: where processors are few, it waits for those of the pose and the surface rather than they for it. The
// pose is the longest of the stages and its frames differ most; what interrupts it lengthens everything. Linux counts
// this by thread; no other system is told.
void let_solvers_go_first() {
#ifdef __linux__
  constexpr int kNice = 4;
  setpriority(PRIO_PROCESS, id_t(gettid()), kNice);
#endif
}

}  // namespace

void inherit_dropped(WorkItem& newer, WorkItem&& displaced) {
  std::vector<FrameReport> dropped = std::move(displaced.dropped_before);
  displaced.report.status = TrackStatus::kDropped;
  dropped.push_back(displaced.report);
  dropped.insert(dropped.end(), newer.dropped_before.begin(), newer.dropped_before.end());
  newer.dropped_before = std::move(dropped);
}

void run_sequential(const PipelineStages& stages) {
  for (;;) {
    WorkItem item;
    if (!stages.read(item)) break;
    stages.detect(item);
    stages.gate(item);
    stages.segment(item);
    std::optional<WorkItem> solved = stages.solve(std::move(item));
    if (!solved) continue;
    stages.surface(*solved);
    if (!stages.publish(*solved)) return;
  }
  while (std::optional<WorkItem> waited = stages.flush()) {
    stages.surface(*waited);
    if (!stages.publish(*waited)) return;
  }
}

void run_pipelined(const PipelineStages& stages, bool newest_wins, int most_under_way) {
  Channel<WorkItem> to_detect, to_gate, to_segment, to_solve, to_surface, to_publish;
  UnderWay under_way(most_under_way);
  FirstError error;
  auto abort_all = [&] {
    stages.stop_reading();
    under_way.abort();
    to_detect.abort();
    to_gate.abort();
    to_segment.abort();
    to_solve.abort();
    to_surface.abort();
    to_publish.abort();
  };
  AbortedThreads threads(abort_all);
  auto start = [&](auto&& body) {
    threads.start([&, body] {
      try {
        body();
      } catch (...) {
        error.capture();
        abort_all();
      }
    });
  };

  start([&] {
    let_solvers_go_first();
    for (;;) {
      WorkItem item;
      if (!stages.read(item)) break;
      if (newest_wins) {
        if (!to_detect.push_newest(std::move(item), inherit_dropped)) return;
      } else if (!to_detect.push(std::move(item))) {
        return;
      }
    }
    to_detect.close();
  });
  // A stage between two channels.
  auto between = [&](const std::function<void(WorkItem&)>& stage, Channel<WorkItem>& from, Channel<WorkItem>& to,
                     bool before_the_pose) {
    start([&stage, &from, &to, before_the_pose] {
      if (before_the_pose) let_solvers_go_first();
      while (auto item = from.pop()) {
        stage(*item);
        if (!to.push(std::move(*item))) return;
      }
      to.close();
    });
  };
  start([&] {
    let_solvers_go_first();
    while (under_way.enter()) {
      std::optional<WorkItem> item = to_detect.pop();
      if (!item) break;
      stages.detect(*item);
      if (!to_gate.push(std::move(*item))) return;
    }
    to_gate.close();
  });
  between(stages.gate, to_gate, to_segment, true);
  between(stages.segment, to_segment, to_solve, true);
  start([&] {
    while (auto item = to_solve.pop()) {
      std::optional<WorkItem> solved = stages.solve(std::move(*item));
      if (solved && !to_surface.push(std::move(*solved))) return;
    }
    if (to_solve.aborted()) return;
    while (std::optional<WorkItem> waited = stages.flush()) {
      if (!to_surface.push(std::move(*waited))) return;
    }
    to_surface.close();
  });
  between(stages.surface, to_surface, to_publish, false);

  try {
    while (auto item = to_publish.pop()) {
      if (!stages.publish(*item)) break;
      under_way.leave();
    }
  } catch (...) {
    error.capture();
  }
  threads.abort_and_join();
  error.rethrow();
}

}  // namespace livecap
