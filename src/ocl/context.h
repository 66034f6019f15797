// One device, one context, one in-order queue, and the programs built for it.
#pragma once

#include <CL/cl.h>

#include <map>
#include <memory>
#include <mutex>
#include <string>
#include <vector>

#include "ocl/device.h"
#include "ocl/handles.h"
#include "ocl/pinned_copies.h"

namespace livecap::ocl {

struct SharedMemory {};

// Not thread-safe: each context belongs to one thread at a time. Buffers and kernels must not outlive it.
class DeviceContext {
 public:
  // track: name of the queue in a trace (base/trace.h). Throws OclError when the context or queue cannot be made.
  explicit DeviceContext(const DeviceInfo& info, const std::string& track = "device");
  // A second queue to the same device, memory and programs: buffers of either may be used by kernels of both, one after
  // the other (finish() in between).
  DeviceContext(const DeviceContext& sibling, SharedMemory, const std::string& track = "device");
  ~DeviceContext();
  DeviceContext(const DeviceContext&) = delete;
  DeviceContext& operator=(const DeviceContext&) = delete;

  const DeviceInfo& info() const { return info_; }
  bool is_cpu() const { return info_.is_cpu; }
  // Rows of a work-item of kernels/shared/lanes.h.
  int lanes() const { return info_.is_cpu ? info_.cpu_lanes : 1; }
  cl_context context() const { return context_.get(); }
  cl_command_queue queue() const { return queue_.get(); }
  // How host memory comes to a GPU and back; none on CPUs.
  PinnedCopies* copies() const { return copies_.get(); }

  // The program of kernels/<path> with these extra options ("-D NAME=1"), built at the first request (from the binary
  // cache when it has it). LC_DEVICE=1, LC_CPU=0|1, LC_POCL=0|1, LC_VECTOR=lanes() are defined. Throws OclError with
  // the build log's first error; all of it goes to the log.
  cl_program program(const std::string& path, const std::string& options = {});

  // So that a GPU begins now what is enqueued: some drivers else wait until somebody waits for it.
  void start();
  // Waits until everything enqueued has run.
  void finish();

 private:
  struct BuiltProgram {
    cl_program program = nullptr;
    int twin = -1;  // of PoCL (ocl/program_twins.h)
  };
  // Of a context and its siblings, which may ask for programs at the same time; they wait while one is built.
  struct Programs {
    ~Programs();
    std::mutex mutex;
    std::map<std::string, BuiltProgram> by_name;  // path + options
  };

  void open_queue(const std::string& track);
  cl_program build(const std::string& path, const std::string& options) const;

  DeviceInfo info_;
  ContextHandle context_;
  QueueHandle queue_;
  std::unique_ptr<PinnedCopies> copies_;
  std::shared_ptr<Programs> programs_;
};

// Outcome of one known-answer test of `livecap devices`.
struct SelfTestResult {
  std::string kernel;
  bool ok = false;
  std::string detail;  // what was expected and found when not ok
};

}  // namespace livecap::ocl
