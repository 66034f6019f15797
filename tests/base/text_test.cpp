#include "base/text.h"

#include <gtest/gtest.h>

#include "livecap/error.h"

namespace livecap {
namespace {

std::string refusal(const std::filesystem::path& path) {
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
  EXPECT_EQ(refusal(testing::TempDir()), std::string(testing::TempDir()) + ": is a folder, expected a file");
  EXPECT_EQ(refusal("/dev/zero"), "/dev/zero: is a device, expected a file");
  EXPECT_EQ(refusal("/no/such"), "/no/such: no such file");
}

}  // namespace
}  // namespace livecap
