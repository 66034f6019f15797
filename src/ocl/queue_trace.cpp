#include "ocl/queue_trace.h"

#include <deque>
#include <limits>
#include <map>
#include <mutex>
#include <utility>

#include "base/trace.h"
#include "livecap/error.h"
#include "ocl/handles.h"
#include "ocl/status.h"

namespace livecap::ocl {
namespace {

constexpr int kClockTries = 16;
constexpr size_t kMostPending = 1024;

struct Command {
  std::string name;
  EventHandle event;
};

struct Queue {
  std::string track;
  double host_minus_device_us = 0;
  std::deque<Command> pending;
};

std::mutex mutex;
std::map<cl_command_queue, Queue> queues;

double event_us(cl_event event, cl_profiling_info which) {
  cl_ulong ns = 0;
  check(clGetEventProfilingInfo(event, which, sizeof(ns), &ns, nullptr), "clGetEventProfilingInfo");
  return static_cast<double>(ns) * 1e-3;
}

// From the write that came back quickest: its end lies just before the return.
double clock_difference_us(cl_context context, cl_command_queue queue) {
  cl_int status = CL_SUCCESS;
  const MemoryHandle memory(clCreateBuffer(context, CL_MEM_READ_WRITE, 4, nullptr, &status));
  check(status, "clCreateBuffer");
  double least = std::numeric_limits<double>::infinity(), difference = 0;
  for (int i = 0; i < kClockTries; ++i) {
    const int32_t value = i;
    cl_event written = nullptr;
    const double before = trace_clock_us();
    check(clEnqueueWriteBuffer(queue, memory.get(), CL_TRUE, 0, 4, &value, 0, nullptr, &written),
          "clEnqueueWriteBuffer");
    const EventHandle event(written);
    const double after = trace_clock_us();
    const double end = event_us(written, CL_PROFILING_COMMAND_END);
    if (after - before < least) {
      least = after - before;
      difference = (before + after) / 2 - end;
    }
  }
  return difference;
}

cl_int state_of(const Command& command) {
  cl_int state = CL_QUEUED;
  clGetEventInfo(command.event.get(), CL_EVENT_COMMAND_EXECUTION_STATUS, sizeof(state), &state, nullptr);
  return state;
}

// Hands over the commands that have ended, from the first on. One without times throws, and is gone as well.
void collect(Queue& queue) {
  while (!queue.pending.empty()) {
    const cl_int state = state_of(queue.pending.front());
    if (state > CL_COMPLETE) return;
    const Command command = std::move(queue.pending.front());
    queue.pending.pop_front();
    if (state < CL_COMPLETE) continue;  // it failed
    const double begin = event_us(command.event.get(), CL_PROFILING_COMMAND_START) + queue.host_minus_device_us;
    const double end = event_us(command.event.get(), CL_PROFILING_COMMAND_END) + queue.host_minus_device_us;
    add_trace_span(queue.track, command.name, begin, end);
  }
}

}  // namespace

void trace_queue(cl_context context, cl_command_queue queue, const std::string& track) {
  const double difference = clock_difference_us(context, queue);
  std::lock_guard lock(mutex);
  queues.insert_or_assign(queue, Queue{track, difference, {}});
  ++traced_queues;
}

void end_queue_trace(cl_command_queue queue) {
  std::lock_guard lock(mutex);
  const auto found = queues.find(queue);
  if (found == queues.end()) return;
  try {
    collect(found->second);
  } catch (const Error&) {  // a device without times has an empty track
  }
  queues.erase(found);
  --traced_queues;
}

void QueueSpan::record() noexcept {
  try {
    EventHandle event(event_);
    std::lock_guard lock(mutex);
    const auto found = queues.find(queue_);
    if (found == queues.end()) return;
    found->second.pending.push_back({name_, std::move(event)});
    if (found->second.pending.size() >= kMostPending) collect(found->second);
  } catch (...) {  // a timeline with gaps is better than a capture that ends
  }
}

}  // namespace livecap::ocl
