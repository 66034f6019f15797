// A camera beside the capturing one: file format and transform.
#include "eval/extra_view.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include "base/text.h"
#include "livecap/error.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

namespace fs = std::filesystem;

class ExtraViewFile : public testing::Test {
 protected:
  ExtraViewFile() {
    folder_ = fs::temp_directory_path() / format("livecap_view_%d", static_cast<int>(::getpid()));
    fs::create_directories(folder_);
  }
  ~ExtraViewFile() override { fs::remove_all(folder_); }

  ExtraView open(const std::string& field) {
    write_file_atomically(folder_ / "side.json",
                          R"({"width":90,"height":160,"fx":100,"fy":100,"cx":44.5,"cy":79.5)" + field + "}");
    return open_view(folder_ / "side.json", folder_);
  }
  void expect_refused(const std::string& field, const std::string& word) {
    try {
      open(field);
      FAIL() << field << " was accepted";
    } catch (const IoError& error) {
      EXPECT_NE(std::string(error.what()).find("side.json"), std::string::npos) << error.what();
      EXPECT_NE(std::string(error.what()).find(word), std::string::npos) << error.what();
    }
  }
  fs::path folder_;
};

class ExtraView : public ExtraViewFile {};

TEST_F(ExtraView, ACameraToTheSubjectsLeftLooksAlongX) {
  // It stands at x = +3000, z = 3000 and looks towards -x: its z is -x, its x is z.
  const livecap::ExtraView view = open(R"(,"view_from_camera":[[0,0,1,-3000],[0,1,0,0],[-1,0,0,3000]])");
  EXPECT_EQ(view.name, "side.json");
  EXPECT_EQ(view.camera.width, 90);
  // A point 200 mm beyond the subject's place, 100 mm to its side, is 200 mm right of the view's axis at 2900 mm.
  const std::vector<float> moved = to_view(view, std::vector<float>{100, 50, 3200});
  EXPECT_NEAR(moved[0], 200, test::kMillimetreFloat);
  EXPECT_NEAR(moved[1], 50, test::kMillimetreFloat);
  EXPECT_NEAR(moved[2], 2900, test::kMillimetreFloat);
}

TEST_F(ExtraView, RefusesWhatIsNoTransform) {
  expect_refused("", "view_from_camera");
  expect_refused(R"(,"view_from_camera":[[1,0,0,0],[0,1,0,0]])", "three rows");
  expect_refused(R"(,"view_from_camera":[[1,0,0],[0,1,0],[0,0,1]])", "four numbers");
  expect_refused(R"(,"view_from_camera":[[1,0,0,0],[0,1,0,0],[0,0,"1",0]])", "[2][2]");
  expect_refused(R"(,"view_from_camera":[[2,0,0,0],[0,2,0,0],[0,0,2,0]])", "rotation");
  expect_refused(R"(,"view_from_camera":[[1,0,0,0],[0,1,0,0],[0,0,-1,0]])", "rotation");  // a reflection
  EXPECT_THROW(open_view(folder_ / "none.json", folder_), IoError);
  EXPECT_THROW(open_view(folder_ / "side.json", folder_ / "none"), IoError);
}

}  // namespace
}  // namespace livecap
