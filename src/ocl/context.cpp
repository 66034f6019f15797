#include "ocl/context.h"

#include "base/log.h"
#include "base/text.h"
#include "base/trace.h"
#include "livecap/error.h"
#include "ocl/kernel_source.h"
#include "ocl/program_cache.h"
#include "ocl/program_twins.h"
#include "ocl/queue_trace.h"
#include "ocl/status.h"

namespace livecap::ocl {
namespace {

std::string build_log(cl_program program, cl_device_id device) {
  size_t size = 0;
  if (clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, 0, nullptr, &size) != CL_SUCCESS || size == 0)
    return {};
  std::string log(size, '\0');
  clGetProgramBuildInfo(program, device, CL_PROGRAM_BUILD_LOG, size, log.data(), nullptr);
  while (!log.empty() && (log.back() == '\0' || log.back() == '\n')) log.pop_back();
  return log;
}

// The one that says why: of the first error, else the first of all.
std::string telling_line(const std::string& log) {
  const size_t error = log.find("error");
  const size_t before = error == std::string::npos ? error : log.rfind('\n', error);
  const size_t begin = before == std::string::npos ? 0 : before + 1;
  return one_line(log.substr(begin, log.find('\n', begin) - begin));
}

}  // namespace

DeviceContext::Programs::~Programs() {
  for (auto& [name, built] : by_name) {
    if (built.program) clReleaseProgram(built.program);
    if (built.twin >= 0) give_back_twin(name, built.twin);
  }
}

DeviceContext::DeviceContext(const DeviceInfo& info, const std::string& track)
    : info_(info), programs_(std::make_shared<Programs>()) {
  cl_int status = CL_SUCCESS;
  const cl_context_properties properties[] = {CL_CONTEXT_PLATFORM,
                                              reinterpret_cast<cl_context_properties>(info.platform), 0};
  context_.reset(clCreateContext(properties, 1, &info_.device, nullptr, nullptr, &status));
  check(status, "clCreateContext", info_.label());
  open_queue(track);
}

DeviceContext::DeviceContext(const DeviceContext& sibling, SharedMemory, const std::string& track)
    : info_(sibling.info_), programs_(sibling.programs_) {
  check(clRetainContext(sibling.context()), "clRetainContext", info_.label());
  context_.reset(sibling.context());
  open_queue(track);
}

void DeviceContext::open_queue(const std::string& track) {
  cl_int status = CL_SUCCESS;
  queue_.reset(clCreateCommandQueue(context(), info_.device, tracing() ? CL_QUEUE_PROFILING_ENABLE : 0, &status));
  check(status, "clCreateCommandQueue", info_.label());
  if (!is_cpu()) copies_ = std::make_unique<PinnedCopies>(context(), queue());
  if (tracing()) trace_queue(context(), queue(), track);
}

DeviceContext::~DeviceContext() {
  clFinish(queue());
  copies_.reset();
  if (traced_queues > 0) end_queue_trace(queue());
  programs_.reset();  // before the context they are of
}

cl_program DeviceContext::program(const std::string& path, const std::string& options) {
  const std::scoped_lock lock(programs_->mutex);
  const std::string name = path + "\n" + options;
  BuiltProgram& built = programs_->by_name[name];
  if (built.program) return built.program;
  if (info_.is_pocl() && built.twin < 0) built.twin = take_twin(name);
  return built.program = build(path, built.twin > 0 ? options + " -D LC_TWIN=" + std::to_string(built.twin) : options);
}

cl_program DeviceContext::build(const std::string& path, const std::string& extra_options) const {
  const std::string source = resolve_kernel_source(path);
  // PoCL's compiler counts its warnings on the user's console (vectors wider than the processor's change an ABI that
  // nobody else uses); house/kernels looks for those that matter.
  const std::string options = std::string("-cl-std=CL1.2 -w -D LC_DEVICE=1 -D LC_CPU=") + (is_cpu() ? "1" : "0") +
                              " -D LC_VECTOR=" + std::to_string(lanes()) +
                              " -D LC_POCL=" + (info_.is_pocl() ? "1" : "0") +
                              (extra_options.empty() ? "" : " " + extra_options);
  const std::filesystem::path cache_file = program_cache_file(source, options, info_);
  cl_program program = load_cached_program(cache_file, context(), info_.device, options);
  if (!program) {
    if (!cache_file.empty() && !is_compiled_program(cache_file))
      log_warning("first run of these kernels on this device: compiling kernels/" + path);
    const char* text = source.c_str();
    const size_t size = source.size();
    cl_int status = CL_SUCCESS;
    program = clCreateProgramWithSource(context(), 1, &text, &size, &status);
    check(status, "clCreateProgramWithSource", path);
    status = clBuildProgram(program, 1, &info_.device, options.c_str(), nullptr, nullptr);
    if (status != CL_SUCCESS) {
      const std::string log = build_log(program, info_.device);
      clReleaseProgram(program);
      const std::string where = "kernels/" + path + " on " + info_.label() + ", options " + options;
      log_error("the build log of " + where + ":\n" + log);
      throw OclError("clBuildProgram failed: " + status_name(status) + " (" + where + "): " + telling_line(log));
    }
    if (info_.is_pocl()) {
      mark_compiled_program(cache_file);
    } else {
      store_cached_program(cache_file, program);
    }
  }
  return program;
}

void DeviceContext::start() {
  if (!is_cpu()) check(clFlush(queue()), "clFlush", info_.label());
}

void DeviceContext::finish() {
  if (copies_) return copies_->finish();
  check(clFinish(queue()), "clFinish", info_.label());
}

}  // namespace livecap::ocl
