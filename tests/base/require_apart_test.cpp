#include "base/require_apart.h"

#include <gtest/gtest.h>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

namespace fs = std::filesystem;

TEST(RequireApart, AnInputIsNoOutputByAnyName) {
  const fs::path folder = fs::path(testing::TempDir()) / "require_apart";
  fs::remove_all(folder);
  fs::create_directories(folder);
  write_file_atomically(folder / "camera.json", "{}");
  fs::create_symlink(folder / "camera.json", folder / "link.json");
  fs::create_hard_link(folder / "camera.json", folder / "other.json");
  const std::vector<fs::path> outputs = {folder / "new.glb", folder / "camera.json"};
  for (const fs::path& input :
       {folder / "camera.json", folder / "." / "camera.json", folder / "link.json", folder / "other.json"}) {
    try {
      require_apart({{"--video", "none.mp4"}, {"--camera", input}}, outputs);
      ADD_FAILURE() << input;
    } catch (const ConfigError& error) {
      EXPECT_EQ(error.what(),
                "--camera " + input.string() + ": would be overwritten by what this writes; give another --out");
    }
  }
  EXPECT_NO_THROW(require_apart({{"--camera", ""}, {"--actor", "builtin:skirt"}, {"--video", "webcam:0"}}, outputs));
  write_file_atomically(folder / "apart.json", "{}");
  EXPECT_NO_THROW(require_apart({{"--camera", folder / "apart.json"}}, outputs));
}

TEST(RequireApart, TwoResultsAreTwoFiles) {
  const fs::path folder = fs::path(testing::TempDir()) / "two_results";
  fs::remove_all(folder);
  fs::create_directories(folder);
  fs::create_symlink("new.html", folder / "link.html");
  const fs::path file = folder / "new.html";
  for (const fs::path& same : {file, folder / "." / "new.html", folder / "link.html"})
    EXPECT_THROW(require_apart({}, {file, same}, "--html"), ConfigError) << same;
  EXPECT_NO_THROW(require_apart({}, {file, folder / "other.html", "", ""}));
}

}  // namespace
}  // namespace livecap
