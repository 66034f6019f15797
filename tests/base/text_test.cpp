#include "base/text.h"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "livecap/error.h"

namespace livecap {
namespace {

std::string read_refusal(const std::filesystem::path& path) {
  try {
    read_file(path);
  } catch (const IoError& error) {
    return error.what();
  }
  return {};
}

TEST(Text, ReadsFilesAndNothingElse) {
  const std::filesystem::path path = std::filesystem::path(testing::TempDir()) / "text_test.bin";
  const std::string bytes("a\0\r\n", 4);
  write_file_atomically(path, bytes);
  EXPECT_EQ(read_file(path), bytes);
  EXPECT_EQ(read_refusal(testing::TempDir()), std::string(testing::TempDir()) + ": is a folder, expected a file");
  EXPECT_EQ(read_refusal("/dev/zero"), "/dev/zero: is a device, expected a file");
  EXPECT_EQ(read_refusal("/no/such"), "/no/such: no such file");
}

TEST(Text, WhatALinkLeadsToIsReplaced) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "text_test_links";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder / "below");
  const std::filesystem::path link = folder / "link", other = folder / "other", file = folder / "below" / "file";
  std::filesystem::create_symlink("below/file", link);  // leads nowhere yet
  std::filesystem::create_symlink(link, other);
  for (const std::string bytes : {"first", "second"}) {
    write_file_atomically(other, bytes);
    EXPECT_EQ(read_file(file), bytes);
    EXPECT_TRUE(std::filesystem::is_symlink(link) && std::filesystem::is_symlink(other));
    EXPECT_FALSE(std::filesystem::is_symlink(file));
  }
}

TEST(Text, APipeIsWrittenToAndStaysOne) {
  const std::filesystem::path pipe = std::filesystem::path(testing::TempDir()) / "text_test_pipe";
  std::filesystem::remove(pipe);
  ASSERT_EQ(::mkfifo(pipe.c_str(), 0600), 0);
  const int reader = ::open(pipe.c_str(), O_RDWR | O_NONBLOCK);
  write_file_atomically(pipe, "through");
  EXPECT_TRUE(std::filesystem::is_fifo(pipe));
  char bytes[16];
  EXPECT_EQ(std::string(bytes, std::max<ssize_t>(0, ::read(reader, bytes, sizeof bytes))), "through");
  ::close(reader);
}

// A pipe that nobody writes to is not opened, which would wait for ever.
TEST(Text, PipesAreNotNamedByFiles) {
  const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "text_test_named";
  std::filesystem::create_directories(folder);
  const std::filesystem::path pipe = folder / "pipe", file = folder / "file", link = folder / "link";
  for (const auto& path : {pipe, link}) std::filesystem::remove(path);
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  write_file_atomically(file, "");
  std::filesystem::create_symlink(pipe, link);
  for (const auto& path : {pipe, link}) {
    try {
      require_no_pipe(path);
      ADD_FAILURE() << path;
    } catch (const IoError& error) {
      EXPECT_EQ(error.what(), path.string() + ": is a pipe or a device, expected a file");
    }
  }
  EXPECT_THROW(require_no_pipe("/dev/zero"), IoError);
  EXPECT_NO_THROW(require_no_pipe(file));
  EXPECT_NO_THROW(require_no_pipe(folder)) << "pictures of a video";
  EXPECT_NO_THROW(require_no_pipe(folder / "none"));
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace livecap
