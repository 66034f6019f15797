#include "base/require_writable.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <string>

#include "livecap/error.h"

namespace livecap {
namespace {

namespace fs = std::filesystem;

std::string refusal(const fs::path& file) {
  try {
    require_writable(file);
  } catch (const IoError& error) {
    return error.what();
  }
  return {};
}

TEST(RequireWritable, NamesWhatIsInTheWay) {
  const fs::path folder = fs::path(testing::TempDir()) / "require_writable", nowhere = folder / "nowhere";
  fs::create_directories(folder);
  EXPECT_EQ(refusal(folder / "new"), "");
  EXPECT_EQ(refusal("in_the_working_folder"), "");
  EXPECT_EQ(refusal(folder), folder.string() + ": is a folder, expected a file to write");
  EXPECT_EQ(refusal(nowhere / "new"), (nowhere / "new").string() + ": there is no folder " + nowhere.string());
  fs::remove(folder / "link");
  fs::create_symlink(nowhere / "new", folder / "link");
  EXPECT_EQ(refusal(folder / "link"), (folder / "link").string() + ": there is no folder " + nowhere.string());
  if (::geteuid() != 0) {  // who may write everywhere
    fs::permissions(folder, fs::perms::owner_write, fs::perm_options::remove);
    EXPECT_EQ(refusal(folder / "new"), (folder / "new").string() + ": cannot be written: Permission denied");
    fs::permissions(folder, fs::perms::owner_all);
  }
  fs::remove_all(folder);
}

}  // namespace
}  // namespace livecap
