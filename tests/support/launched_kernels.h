// Which kernels a known-answer test launches: `livecap devices` promises a test of every kernel.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <set>
#include <sstream>
#include <string>

#include "base/text.h"
#include "base/trace.h"
#include "ocl/context.h"

namespace livecap::test {

inline std::string kernel_names(ocl::DeviceContext& device, const std::string& program) {
  size_t size = 0;
  const cl_program built = device.program(program);
  EXPECT_EQ(clGetProgramInfo(built, CL_PROGRAM_KERNEL_NAMES, 0, nullptr, &size), CL_SUCCESS);
  std::string names(size, '\0');
  EXPECT_EQ(clGetProgramInfo(built, CL_PROGRAM_KERNEL_NAMES, size, names.data(), nullptr), CL_SUCCESS);
  while (!names.empty() && names.back() == '\0') names.pop_back();
  return names;
}

// The trace of everything that was launched on the devices that `work` opens, as text.
template <typename Work>
std::string launched_by(Work&& work) {
  const auto path = std::filesystem::temp_directory_path() / format("livecap_launches_%d.json", int(::getpid()));
  start_trace();
  work();
  write_trace(path);
  const std::string launched = read_file(path);
  std::filesystem::remove(path);
  return launched;
}

// Every kernel of the program, as this device has it, is launched by self_test(device), but those that nobody launches
// on such a device.
template <typename SelfTest>
void expect_every_kernel_launched(const ocl::DeviceInfo& info, const std::string& program, SelfTest&& self_test,
                                  const std::set<std::string>& unused = {}) {
  std::string names;
  const std::string launched = launched_by([&] {
    ocl::DeviceContext device(info);
    self_test(device);
    names = kernel_names(device, program);
  });
  std::istringstream list(names);
  int n = 0;
  for (std::string name; std::getline(list, name, ';'); ++n)
    EXPECT_EQ(launched.find('"' + name + '"') == std::string::npos, unused.contains(name))
        << program << ": " << name << " has no known answer, or is not unused";
  EXPECT_GT(n, 0) << program;
}

}  // namespace livecap::test
