// What runs on the queues of this process, for the timeline of base/trace.h. Only queues that are opened while a trace
// is recorded take part; for others a QueueSpan is a look at one flag.
#pragma once

#include <CL/cl.h>

#include <atomic>
#include <string>

namespace livecap::ocl {

// Queues that take part now.
inline std::atomic<int> traced_queues{0};

// queue: with CL_QUEUE_PROFILING_ENABLE. Its clock is set against the host's. Throws OclError.
void trace_queue(cl_context context, cl_command_queue queue, const std::string& track);
// Hands over what has run since. The queue must be finished.
void end_queue_trace(cl_command_queue queue);

// One command: pass event() to its clEnqueue call.
class QueueSpan {
 public:
  QueueSpan(cl_command_queue queue, const char* name) : queue_(queue), name_(name) {}
  ~QueueSpan() {
    if (event_) record();
  }
  QueueSpan(const QueueSpan&) = delete;
  QueueSpan& operator=(const QueueSpan&) = delete;
  cl_event* event() { return traced_queues.load(std::memory_order_relaxed) > 0 ? &event_ : nullptr; }

 private:
  void record() noexcept;

  cl_command_queue queue_;
  const char* name_;
  cl_event event_ = nullptr;
};

}  // namespace livecap::ocl
