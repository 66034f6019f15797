// A kernel of a program, launched with its arguments in one call:
//   Kernel skin(device, "surface/slices.cl", "skin_vertices");
//   skin.launch(n, 64, n, rest, weights, out);
#pragma once

#include <CL/cl.h>

#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "ocl/buffer.h"
#include "ocl/context.h"

namespace livecap::ocl {

// A __local argument of this many bytes.
struct LocalMemory {
  size_t bytes;
};

// Work sizes of up to two dimensions. `local` 0 lets the driver choose.
struct Range {
  size_t global_x = 0;
  size_t global_y = 1;
  size_t local_x = 0;
  size_t local_y = 1;
};

class Kernel {
 public:
  Kernel() = default;
  // path: source below kernels/. Throws OclError naming the kernel when it does not exist.
  Kernel(DeviceContext& device, const std::string& path, const std::string& name, const std::string& options = {});
  ~Kernel();
  Kernel(Kernel&& other) noexcept { *this = std::move(other); }
  Kernel& operator=(Kernel&& other) noexcept;
  Kernel(const Kernel&) = delete;
  Kernel& operator=(const Kernel&) = delete;

  // n work-items in work-groups of `local` (the global size is rounded up: kernels guard with `if (i >= n) return`).
  // Nothing is launched for n = 0. Arguments: Buffer<T>, LocalMemory, or scalars and structs by value.
  template <typename... Args>
  void launch(size_t n, size_t local, const Args&... args) {
    if (n == 0) return;
    launch(Range{local ? (n + local - 1) / local * local : n, 1, local, 1}, args...);
  }
  template <typename... Args>
  void launch(const Range& range, const Args&... args) {
    if (range.global_x == 0 || range.global_y == 0) return;
    cl_uint index = 0;
    (set_arg(index++, args), ...);
    enqueue(range);
  }

  const std::string& name() const { return name_; }

 private:
  template <typename T>
  void set_arg(cl_uint index, const Buffer<T>& buffer) {
    const cl_mem memory = buffer.memory();
    set_raw(index, sizeof(memory), &memory);
  }
  void set_arg(cl_uint index, LocalMemory local) { set_raw(index, local.bytes, nullptr); }
  template <typename T>
  requires std::is_trivially_copyable_v<T>
  void set_arg(cl_uint index, const T& value) {
    static_assert(sizeof(T) % 4 == 0, "kernel arguments are made of 4-byte fields");
    static_assert(!std::is_same_v<T, double> && !std::is_same_v<T, size_t>, "kernels take float and int");
    set_raw(index, sizeof(T), &value);
  }
  void set_raw(cl_uint index, size_t size, const void* value);
  void enqueue(const Range& range);

  cl_kernel kernel_ = nullptr;
  cl_device_id device_ = nullptr;
  cl_command_queue queue_ = nullptr;
  std::string name_;
  // What each argument was set to last, byte for byte: drivers take long to set them. Good as long as no buffer is
  // made, which might get the handle of one that is gone.
  std::vector<std::vector<unsigned char>> arguments_;
  int64_t buffers_made_ = 0;
};

}  // namespace livecap::ocl
