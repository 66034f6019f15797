// The OpenCL C sources: embedded in the program, or read from LIVECAP_KERNEL_DIR for kernel development.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace livecap::ocl {

struct EmbeddedKernel {
  const char* path;  // relative to kernels/, "terms/photo.cl"
  const char* text;
  size_t size;
};

extern const EmbeddedKernel kEmbeddedKernels[];
extern const int kEmbeddedKernelCount;

// The file with every #include "..." (paths relative to kernels/) expanded once, and #line marks so that build logs
// show real paths. Throws LogicError when a file does not exist.
std::string resolve_kernel_source(const std::string& path);

// Paths of all kernel files, for lint-like tests.
std::vector<std::string> kernel_paths();

}  // namespace livecap::ocl
