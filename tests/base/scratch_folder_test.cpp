#include "base/scratch_folder.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <string>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

TEST(ScratchFolder, GoesAwayWithItsOwner) {
  std::filesystem::path path;
  {
    const ScratchFolder folder, other;
    path = folder.path();
    EXPECT_NE(path, other.path());
    write_file_atomically(folder / "file", "text");
    EXPECT_TRUE(std::filesystem::exists(path / "file"));
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

TEST(ScratchFolder, NeedsAFolderToBeIn) {
  const ScratchFolder folder;
  const char* set = std::getenv("TMPDIR");
  const std::string before = set ? set : "";
  setenv("TMPDIR", (folder / "none").c_str(), 1);
  EXPECT_THROW(ScratchFolder(), IoError);
  before.empty() ? unsetenv("TMPDIR") : setenv("TMPDIR", before.c_str(), 1);
}

}  // namespace
}  // namespace livecap
