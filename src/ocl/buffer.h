// Device memory with element counts. Host transfers are blocking unless their name says otherwise: one read per stage,
// no hidden finish elsewhere, but for GPUs where page-locked memory is full (ocl/pinned_copies.h) and for a buffer that
// goes with a transfer under way.
#pragma once

#include <CL/cl.h>

#include <atomic>
#include <span>
#include <utility>
#include <vector>

#include "livecap/error.h"
#include "ocl/context.h"
#include "ocl/queue_trace.h"
#include "ocl/status.h"

namespace livecap::ocl {

// Bytes in the buffers of this process, now and at most so far, and how many buffers were ever made. A frame of a
// running capture changes none of them.
struct BufferMemory {
  static inline std::atomic<size_t> now{0}, peak{0};
  static inline std::atomic<int64_t> made{0};
  static void add(size_t bytes) {
    ++made;
    const size_t sum = now += bytes;
    size_t most = peak;
    while (sum > most && !peak.compare_exchange_weak(most, sum)) {
    }
  }
};

// An array of T on one device. A default-constructed buffer is empty and must not be passed to a kernel; a buffer of
// zero elements holds one, because OpenCL forbids empty ones.
template <typename T>
class Buffer {
 public:
  using value_type = T;

  Buffer() = default;
  Buffer(DeviceContext& device, size_t count) : queue_(device.queue()), copies_(device.copies()), count_(count) {
    cl_int status = CL_SUCCESS;
    memory_ =
        clCreateBuffer(device.context(), CL_MEM_READ_WRITE, (count > 0 ? count : 1) * sizeof(T), nullptr, &status);
    check(status, "clCreateBuffer", std::to_string(count * sizeof(T)) + " bytes on " + device.info().label());
    BufferMemory::add(count_ * sizeof(T));
  }
  Buffer(DeviceContext& device, std::span<const T> values) : Buffer(device, values.size()) { write(values); }
  Buffer(DeviceContext& device, const std::vector<T>& values) : Buffer(device, std::span<const T>(values)) {}
  ~Buffer() { release(); }
  Buffer(Buffer&& other) noexcept { *this = std::move(other); }
  Buffer& operator=(Buffer&& other) noexcept {
    if (this != &other) {
      release();
      memory_ = std::exchange(other.memory_, nullptr);
      queue_ = std::exchange(other.queue_, nullptr);
      copies_ = std::exchange(other.copies_, nullptr);
      count_ = std::exchange(other.count_, 0);
      staged_ = std::move(other.staged_);
      staged_event_ = std::exchange(other.staged_event_, nullptr);
      under_way_ = std::exchange(other.under_way_, false);
    }
    return *this;
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;

  size_t size() const { return count_; }
  bool empty() const { return count_ == 0; }
  cl_mem memory() const { return memory_; }

  // Blocking copies of values.size() elements from element `offset` on. Throws LogicError when they do not fit.
  void write(std::span<const T> values, size_t offset = 0) {
    if (values.empty()) return;
    require(values.size() + offset <= count_);
    if (copies_) return copies_->write(memory_, offset * sizeof(T), values.data(), values.size_bytes(), true);
    QueueSpan span(queue_, "write");
    check(clEnqueueWriteBuffer(queue_, memory_, CL_TRUE, offset * sizeof(T), values.size_bytes(), values.data(), 0,
                               nullptr, span.event()),
          "clEnqueueWriteBuffer");
  }
  void write(const std::vector<T>& values, size_t offset = 0) { write(std::span<const T>(values), offset); }
  void read(std::span<T> values, size_t offset = 0) const { read(values, offset, CL_TRUE); }
  // Copies the values and returns; they are written in order. For small inputs of the kernels that follow: a blocking
  // write would wait for everything before it.
  void write_later(std::span<const T> values) {
    if (values.empty()) return;
    require(values.size() <= count_);
    if (copies_) return copies_->write(memory_, 0, values.data(), values.size_bytes(), false);
    wait_for_staged();
    staged_.assign(values.begin(), values.end());
    QueueSpan span(queue_, "write");
    cl_event* traced = span.event();
    check(clEnqueueWriteBuffer(queue_, memory_, CL_FALSE, 0, values.size_bytes(), staged_.data(), 0, nullptr,
                               traced ? traced : &staged_event_),
          "clEnqueueWriteBuffer");
    if (!traced) return;
    clRetainEvent(*traced);
    staged_event_ = *traced;
  }
  // The same for large ones: a CPU takes them without a copy between, and waits.
  void hand_over(std::span<const T> values, size_t offset = 0) {
    if (!copies_) return write(values, offset);
    if (values.empty()) return;
    require(values.size() + offset <= count_);
    copies_->write(memory_, offset * sizeof(T), values.data(), values.size_bytes(), false);
  }
  // The same in the order of another queue to the same memory.
  void hand_over(DeviceContext& through, std::span<const T> values) {
    if (!through.copies()) throw LogicError("hand_over: a CPU's queue does not take copies in order");
    require(values.size() <= count_);
    through.copies()->write(memory_, 0, values.data(), values.size_bytes(), false);
  }
  // All of it, in the order of another queue to the same memory.
  std::vector<T> read_through(DeviceContext& through) const {
    std::vector<T> values(count_);
    if (values.empty()) return values;
    const size_t bytes = values.size() * sizeof(T);
    if (through.copies()) {
      through.copies()->read(memory_, 0, values.data(), bytes, true);
    } else {
      check(clEnqueueReadBuffer(through.queue(), memory_, CL_TRUE, 0, bytes, values.data(), 0, nullptr, nullptr),
            "clEnqueueReadBuffer");
    }
    return values;
  }
  // Returns at once; the values are there after the next blocking read through the same queue, and must live until
  // then or until the buffer is gone.
  void read_later(std::span<T> values) const { read(values, 0, CL_FALSE); }
  std::vector<T> read_all() const {
    std::vector<T> values(count_);
    read(std::span<T>(values));
    return values;
  }
  // In-order, not blocking.
  void fill(T value) {
    if (count_ == 0) return;
    QueueSpan span(queue_, "fill");
    check(clEnqueueFillBuffer(queue_, memory_, &value, sizeof(T), 0, count_ * sizeof(T), 0, nullptr, span.event()),
          "clEnqueueFillBuffer");
  }
  void copy_from(const Buffer& other) {
    if (other.count_ == 0) return;
    require(other.count_ <= count_);
    QueueSpan span(queue_, "copy");
    check(clEnqueueCopyBuffer(queue_, other.memory_, memory_, 0, 0, other.count_ * sizeof(T), 0, nullptr, span.event()),
          "clEnqueueCopyBuffer");
  }

 private:
  void read(std::span<T> values, size_t offset, cl_bool blocking) const {
    if (values.empty()) return;
    require(values.size() + offset <= count_);
    under_way_ = blocking == CL_FALSE;
    if (copies_)
      return copies_->read(memory_, offset * sizeof(T), values.data(), values.size_bytes(), blocking == CL_TRUE);
    QueueSpan span(queue_, "read");
    check(clEnqueueReadBuffer(queue_, memory_, blocking, offset * sizeof(T), values.size_bytes(), values.data(), 0,
                              nullptr, span.event()),
          "clEnqueueReadBuffer");
  }
  void wait_for_staged() {
    if (!staged_event_) return;
    clWaitForEvents(1, &staged_event_);
    clReleaseEvent(staged_event_);
    staged_event_ = nullptr;
  }
  static void require(bool fits) {
    if (!fits) throw LogicError("ocl::Buffer: transfer outside the buffer");
  }
  void release() noexcept {
    if (!memory_) return;
    wait_for_staged();
    if (under_way_ && copies_) {
      try {
        copies_->finish();
      } catch (const Error&) {  // a queue that failed has told so before
      }
    }
    if (under_way_ && !copies_) clFinish(queue_);
    clReleaseMemObject(memory_);
    BufferMemory::now -= count_ * sizeof(T);
    memory_ = nullptr;
  }

  cl_mem memory_ = nullptr;
  cl_command_queue queue_ = nullptr;
  PinnedCopies* copies_ = nullptr;  // of a GPU
  size_t count_ = 0;
  std::vector<T> staged_;  // of a write_later that may still be under way
  cl_event staged_event_ = nullptr;
  mutable bool under_way_ = false;  // a transfer that was not waited for may be
};

}  // namespace livecap::ocl
