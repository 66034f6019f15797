#include "ocl/program_cache.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "base/text.h"
#include "support/test_device.h"

namespace livecap {
namespace {

namespace fs = std::filesystem;

constexpr char kSource[] = "kernel void twice(global int* x) { x[get_global_id(0)] *= 2; }";

// A cache folder of its own for as long as it lives.
class CacheFolder {
 public:
  CacheFolder() : path_(fs::temp_directory_path() / format("livecap_program_cache_%d", int(::getpid()))) {
    if (const char* before = std::getenv("LIVECAP_CACHE_DIR")) before_ = before;
    fs::remove_all(path_);
    ::setenv("LIVECAP_CACHE_DIR", path_.c_str(), 1);
  }
  ~CacheFolder() {
    before_.empty() ? ::unsetenv("LIVECAP_CACHE_DIR") : ::setenv("LIVECAP_CACHE_DIR", before_.c_str(), 1);
    fs::remove_all(path_);
  }
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
  std::string before_;
};

// A driver that caches itself is never asked for a binary, which on PoCL would compile everything twice.
TEST(ProgramCache, KeepsBinariesOnlyWhereTheDriverDoesNot) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const CacheFolder folder;
    device.program("raster/visibility.cl", "-D LC_TEST_OF_CACHE=1");
    int n_files = 0;
    for (const auto& entry : fs::directory_iterator(folder.path())) {
      ++n_files;
      EXPECT_EQ(fs::file_size(entry.path()) == 0, device.info().is_pocl());
      EXPECT_TRUE(ocl::is_compiled_program(entry.path()));
    }
    EXPECT_EQ(n_files, 1);
  });
}

TEST(ProgramCache, PoclIsKnownByItsPlatformsName) {
  ocl::DeviceInfo device;
  device.platform_name = "Portable Computing Language";
  EXPECT_TRUE(device.is_pocl());
  device.platform_name = "NVIDIA CUDA";
  EXPECT_FALSE(device.is_pocl());
}

TEST(ProgramCache, BinariesComeBackAndDamagedOnesAreDropped) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const CacheFolder folder;
    const char* text = kSource;
    const size_t size = sizeof(kSource) - 1;
    cl_device_id id = device.info().device;
    cl_program program = clCreateProgramWithSource(device.context(), 1, &text, &size, nullptr);
    ASSERT_EQ(clBuildProgram(program, 1, &id, "", nullptr, nullptr), CL_SUCCESS);
    const fs::path file = ocl::program_cache_file(kSource, "", device.info());
    EXPECT_EQ(file.parent_path(), folder.path());
    EXPECT_FALSE(ocl::is_compiled_program(file));
    EXPECT_EQ(ocl::load_cached_program(file, device.context(), id, ""), nullptr);
    ocl::store_cached_program(file, program);
    clReleaseProgram(program);
    cl_program loaded = ocl::load_cached_program(file, device.context(), id, "");
    ASSERT_NE(loaded, nullptr);
    clReleaseProgram(loaded);
    std::ofstream(file, std::ios::binary | std::ios::trunc) << "no program";
    EXPECT_EQ(ocl::load_cached_program(file, device.context(), id, ""), nullptr);
    EXPECT_FALSE(fs::exists(file));
  });
}

}  // namespace
}  // namespace livecap
