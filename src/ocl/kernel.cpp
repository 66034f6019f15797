#include "ocl/kernel.h"

#include <cstring>

#include "base/text.h"
#include "livecap/error.h"
#include "ocl/queue_trace.h"
#include "ocl/status.h"

namespace livecap::ocl {

Kernel::Kernel(DeviceContext& device, const std::string& path, const std::string& name, const std::string& options)
    : device_(device.info().device), queue_(device.queue()), name_(name) {
  cl_int status = CL_SUCCESS;
  kernel_ = clCreateKernel(device.program(path, options), name.c_str(), &status);
  check(status, "clCreateKernel", name + " of kernels/" + path + " on " + device.info().label());
}

Kernel::~Kernel() {
  if (kernel_) clReleaseKernel(kernel_);
}

Kernel& Kernel::operator=(Kernel&& other) noexcept {
  if (this != &other) {
    if (kernel_) clReleaseKernel(kernel_);
    kernel_ = std::exchange(other.kernel_, nullptr);
    device_ = other.device_;
    queue_ = std::exchange(other.queue_, nullptr);
    name_ = std::move(other.name_);
    arguments_ = std::move(other.arguments_);
    buffers_made_ = other.buffers_made_;
  }
  return *this;
}

void Kernel::set_raw(cl_uint index, size_t size, const void* value) {
  if (const int64_t made = BufferMemory::made; made != buffers_made_) {
    arguments_.clear();
    buffers_made_ = made;
  }
  if (index >= arguments_.size()) arguments_.resize(index + 1);
  std::vector<unsigned char>& last = arguments_[index];
  if (value && last.size() == size && std::memcmp(last.data(), value, size) == 0) return;
  const cl_int status = clSetKernelArg(kernel_, index, size, value);
  if (status != CL_SUCCESS) check(status, "clSetKernelArg", name_ + " argument " + std::to_string(index));
  const auto* bytes = static_cast<const unsigned char*>(value);
  last.assign(bytes, bytes ? bytes + size : bytes);
}

void Kernel::enqueue(const Range& range) {
  const size_t global[2] = {range.global_x, range.global_y};
  const size_t local[2] = {range.local_x, range.local_y};
  QueueSpan span(queue_, name_.c_str());
  const cl_int status = clEnqueueNDRangeKernel(queue_, kernel_, 2, nullptr, global, range.local_x ? local : nullptr, 0,
                                               nullptr, span.event());
  if (status == CL_INVALID_WORK_GROUP_SIZE) {
    size_t most = 0;
    clGetKernelWorkGroupInfo(kernel_, device_, CL_KERNEL_WORK_GROUP_SIZE, sizeof(most), &most, nullptr);
    if (most > 0 && range.local_x * range.local_y > most)
      throw OclError(format("%s: needs work-groups of %zu; this device has at most %zu for it", name_.c_str(),
                            range.local_x * range.local_y, most));
  }
  check(status, "clEnqueueNDRangeKernel", name_);
}

}  // namespace livecap::ocl
