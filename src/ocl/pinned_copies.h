// Transfers between a GPU and the host that no other thread has to wait for. While a blocking call waits, NVIDIA's
// driver lets no call of another thread in, whichever queue it is for; while clWaitForEvents waits, it does. And only
// from and to page-locked memory does it copy without a detour. So everything goes through such memory of the queue.
#pragma once

#include <CL/cl.h>

#include <cstddef>
#include <vector>

namespace livecap::ocl {

class PinnedCopies {
 public:
  // Of this in-order queue; for one thread at a time.
  PinnedCopies(cl_context context, cl_command_queue queue) : context_(context), queue_(queue) {}
  ~PinnedCopies();
  PinnedCopies(const PinnedCopies&) = delete;
  PinnedCopies& operator=(const PinnedCopies&) = delete;

  // offset: of the buffer, bytes. What `from` holds may change afterwards. waits: returns when it is on the device.
  void write(cl_mem buffer, size_t offset, const void* from, size_t bytes, bool waits);
  // `to` is there when this returns, if it waits, or when a later call has waited.
  void read(cl_mem buffer, size_t offset, void* to, size_t bytes, bool waits);
  // Waits until everything enqueued has run.
  void finish();

 private:
  struct Read {
    const char* from;
    void* to;
    size_t bytes;
  };
  char* take(size_t bytes);
  void wait_for(cl_event event, bool owned);
  void release();

  cl_context context_;
  cl_command_queue queue_;
  cl_mem memory_ = nullptr;
  char* mapped_ = nullptr;
  size_t size_ = 0, used_ = 0;
  std::vector<Read> reads_;  // that nobody has waited for
};

}  // namespace livecap::ocl
