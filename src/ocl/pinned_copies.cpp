#include "ocl/pinned_copies.h"

#include <algorithm>
#include <bit>
#include <cstring>

#include "base/round_up.h"
#include "ocl/queue_trace.h"
#include "ocl/status.h"

namespace livecap::ocl {
namespace {

constexpr size_t kLeast = size_t(4) << 20;
constexpr size_t kAlignment = 256;

}  // namespace

PinnedCopies::~PinnedCopies() {
  release();
}

void PinnedCopies::release() {
  if (!memory_) return;
  if (mapped_) clEnqueueUnmapMemObject(queue_, memory_, mapped_, 0, nullptr, nullptr);
  clReleaseMemObject(memory_);
  memory_ = nullptr;
  mapped_ = nullptr;
  size_ = 0;
}

char* PinnedCopies::take(size_t bytes) {
  if (used_ + bytes > size_) {
    if (used_ > 0) finish();
    if (bytes > size_) {
      release();
      const size_t size = std::bit_ceil(std::max(bytes, kLeast));
      cl_int status = CL_SUCCESS;
      memory_ = clCreateBuffer(context_, CL_MEM_READ_WRITE | CL_MEM_ALLOC_HOST_PTR, size, nullptr, &status);
      check(status, "clCreateBuffer", std::to_string(size) + " bytes of page-locked memory");
      mapped_ = static_cast<char*>(clEnqueueMapBuffer(queue_, memory_, CL_TRUE, CL_MAP_READ | CL_MAP_WRITE, 0, size, 0,
                                                      nullptr, nullptr, &status));
      check(status, "clEnqueueMapBuffer");
      size_ = size;
    }
  }
  char* taken = mapped_ + used_;
  used_ = std::min(size_, used_ + round_up(bytes, kAlignment));
  return taken;
}

void PinnedCopies::write(cl_mem buffer, size_t offset, const void* from, size_t bytes, bool waits) {
  char* pinned = take(bytes);
  std::memcpy(pinned, from, bytes);
  QueueSpan span(queue_, "write");
  cl_event *traced = span.event(), own = nullptr, *event = traced ? traced : waits ? &own : nullptr;
  check(clEnqueueWriteBuffer(queue_, buffer, CL_FALSE, offset, bytes, pinned, 0, nullptr, event),
        "clEnqueueWriteBuffer");
  if (waits) wait_for(*event, own != nullptr);
}

void PinnedCopies::read(cl_mem buffer, size_t offset, void* to, size_t bytes, bool waits) {
  char* pinned = take(bytes);
  QueueSpan span(queue_, "read");
  cl_event *traced = span.event(), own = nullptr, *event = traced ? traced : waits ? &own : nullptr;
  check(clEnqueueReadBuffer(queue_, buffer, CL_FALSE, offset, bytes, pinned, 0, nullptr, event), "clEnqueueReadBuffer");
  reads_.push_back({pinned, to, bytes});
  if (waits) wait_for(*event, own != nullptr);
}

void PinnedCopies::finish() {
  cl_event event = nullptr;
  check(clEnqueueMarkerWithWaitList(queue_, 0, nullptr, &event), "clEnqueueMarkerWithWaitList");
  wait_for(event, true);
}

// event: the last command's. What came before it in the queue has run, too. After an error nobody waits for the reads
// any more: their destinations may go with it.
void PinnedCopies::wait_for(cl_event event, bool owned) {
  std::vector<Read> reads;
  reads.swap(reads_);
  const cl_int status = clWaitForEvents(1, &event);
  if (owned) clReleaseEvent(event);
  check(status, "clWaitForEvents");
  for (const Read& read : reads) std::memcpy(read.to, read.from, read.bytes);
  reads.clear();
  reads_.swap(reads);  // its memory
  used_ = 0;
}

}  // namespace livecap::ocl
