#include "ocl/pocl_library.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <optional>
#include <utility>
#include <vector>

#include "ocl/device.h"
#include "ocl/pocl_cache.h"

namespace livecap {
namespace {

TEST(PoclLibrary, DriverNameFollowsTheVersion) {
  EXPECT_EQ(ocl::one_core_driver_of("/usr/lib/x86_64-linux-gnu/libpocl.so.2.10.0"), "basic");  // PoCL 3.1
  EXPECT_EQ(ocl::one_core_driver_of("libpocl.so.2.9.0"), "basic");                             // PoCL 3.0
  EXPECT_EQ(ocl::one_core_driver_of("libpocl.so.2.11.0"), "cpu-minimal");                      // PoCL 4.0
  EXPECT_EQ(ocl::one_core_driver_of("/opt/somewhere/lib/libpocl.so.2.12.0"), "cpu-minimal");   // PoCL 5.0
  EXPECT_EQ(ocl::one_core_driver_of("libpocl.so.3.0"), "cpu-minimal");
  for (const char* name : {"libpocl.so", "libpocl.so.2", "libpocl.so.x.1", "libnvidia-opencl.so.1.2", ""})
    EXPECT_EQ(ocl::one_core_driver_of(name), "") << name;
}

TEST(PoclLibrary, FoundThroughIcdFiles) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "livecap_icd";
  std::filesystem::create_directories(folder);
  EXPECT_EQ(ocl::one_core_driver({folder}), "");
  std::ofstream(folder / "other.icd") << "libsomething.so.2.12.0\n";
  EXPECT_EQ(ocl::one_core_driver({folder}), "");
  std::ofstream(folder / "pocl.icd") << "/nowhere/libpocl.so.2.12.0\n";
  EXPECT_EQ(ocl::one_core_driver({folder / "missing", folder}), "cpu-minimal");
  std::filesystem::remove_all(folder);
}

TEST(PoclLibrary, ACacheThatCannotBeWrittenIsReplacedOrNamed) {
  const auto folder = std::filesystem::path(testing::TempDir()) / "livecap_pocl_cache";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "file") << "no folder";
  const std::string file = (folder / "file").string();
  std::vector<std::pair<const char*, std::optional<std::string>>> before;
  for (const char* name : {"POCL_CACHE_DIR", "XDG_CACHE_HOME"}) {
    const char* value = std::getenv(name);
    before.emplace_back(name, value ? std::optional<std::string>(value) : std::nullopt);
    ::unsetenv(name);
  }
  ::setenv("XDG_CACHE_HOME", folder.c_str(), 1);
  EXPECT_EQ(ocl::pocl_cache_folder(), folder / "pocl" / "kcache");
  EXPECT_EQ(ocl::pocl_cache_complaint(), "");  // can be made
  ocl::require_pocl_cache();
  EXPECT_EQ(std::getenv("POCL_CACHE_DIR"), nullptr);
  ::setenv("XDG_CACHE_HOME", file.c_str(), 1);
  EXPECT_EQ(ocl::pocl_cache_complaint().rfind(file + "/pocl/kcache, where PoCL", 0), 0u);
  ocl::require_pocl_cache();
  ASSERT_NE(std::getenv("POCL_CACHE_DIR"), nullptr);
  EXPECT_TRUE(std::filesystem::is_directory(std::getenv("POCL_CACHE_DIR")));
  EXPECT_EQ(ocl::pocl_cache_complaint(), "");
  ::setenv("POCL_CACHE_DIR", file.c_str(), 1);  // the user's
  ocl::require_pocl_cache();
  EXPECT_EQ(std::getenv("POCL_CACHE_DIR"), file);
  EXPECT_NE(ocl::pocl_cache_complaint(), "");
  for (const auto& [name, value] : before) value ? ::setenv(name, value->c_str(), 1) : ::unsetenv(name);
  std::filesystem::remove_all(folder);
}

// Whatever PoCL is installed, its one-core driver must have been understood: two devices of one core each.
TEST(PoclLibrary, InstalledPoclGivesTwoOneCoreDevices) {
  const std::string driver = ocl::one_core_driver(ocl::icd_folders());
  if (driver.empty()) GTEST_SKIP() << "skipped: no PoCL of known version";
  ocl::prepare_platforms();
  if (std::getenv("POCL_DEVICES") != driver + " " + driver) GTEST_SKIP() << "skipped: POCL_DEVICES is set";
  int n = 0;
  for (const auto& device : ocl::list_devices()) n += device.is_cpu && device.compute_units == 1;
  EXPECT_GE(n, 2);
}

}  // namespace
}  // namespace livecap
