// OpenCL objects that are released with their holder, also where an exception leaves it.
#pragma once

#include <CL/cl.h>

#include <memory>
#include <type_traits>

namespace livecap::ocl {

template <auto release>
struct Release {
  template <typename Object>
  void operator()(Object* object) const noexcept {
    release(object);
  }
};

template <typename Object, auto release>
using Handle = std::unique_ptr<std::remove_pointer_t<Object>, Release<release>>;

using ContextHandle = Handle<cl_context, clReleaseContext>;
using QueueHandle = Handle<cl_command_queue, clReleaseCommandQueue>;
using MemoryHandle = Handle<cl_mem, clReleaseMemObject>;
using EventHandle = Handle<cl_event, clReleaseEvent>;

}  // namespace livecap::ocl
