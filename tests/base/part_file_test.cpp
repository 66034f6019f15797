// A file takes its name when it is whole; until then the old one is there.
#include "base/part_file.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "base/scratch_folder.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

namespace fs = std::filesystem;

TEST(PartFile, TakesItsNameWhenItIsWhole) {
  const ScratchFolder folder;
  const fs::path file = folder.path() / "motion.bvh", link = folder.path() / "link.bvh";
  write_file_atomically(file, "old");
  fs::create_symlink("motion.bvh", link);
  {
    const PartFile broken_off(link);
    write_file_atomically(broken_off.path(), "half");
    EXPECT_EQ(read_file(file), "old");
  }
  EXPECT_EQ(read_file(file), "old");
  PartFile whole(link);
  write_file_atomically(whole.path(), "new");
  whole.finish();
  EXPECT_EQ(read_file(file), "new");
  EXPECT_TRUE(fs::is_symlink(link));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path()), fs::directory_iterator()), 2);
}

TEST(PartFile, ADeviceIsWrittenToAsItIs) {
  PartFile null("/dev/null");
  EXPECT_EQ(null.path(), "/dev/null");
  EXPECT_NO_THROW(null.finish());
}

TEST(PartFile, WhatWasNeverWrittenIsNamed) {
  const ScratchFolder folder;
  EXPECT_THROW(PartFile(folder.path() / "none").finish(), IoError);
}

}  // namespace
}  // namespace livecap
