// A floor by the file of a camera and by that of a capture; floors that cannot be are camera_test.cpp's.
#include "base/floor_plane.h"

#include <gtest/gtest.h>

#include <utility>

#include "base/scratch_folder.h"
#include "base/text.h"
#include "livecap/camera.h"
#include "livecap/error.h"
#include "support/refusal.h"

namespace livecap {
namespace {

TEST(FloorPlane, IsThatOfACamerasFileOrOfACaptures) {
  const ScratchFolder scratch;
  const FloorPlane written{{0, -0.96, -0.28}, 1234.5};
  Camera camera = camera_from_fov(540, 960, 45);
  camera.floor = written;
  save_camera(camera, scratch / "camera.json");
  write_file_atomically(scratch / "report.json",
                        R"({"frames":3,"floor":{"normal":[0,-0.96,-0.28],"distance_mm":1234.5}})");
  for (const char* file : {"camera.json", "report.json"}) {
    const FloorPlane read = load_floor(scratch / file);
    EXPECT_EQ(read.normal, written.normal) << file;
    EXPECT_EQ(read.distance_mm, written.distance_mm) << file;
  }
}

TEST(FloorPlane, AFileThatTellsNoneIsRefused) {
  const ScratchFolder scratch;
  const auto path = scratch / "report.json";
  test::expect_refused<IoError>([&] { load_floor(path); }, {"report.json"});
  for (const auto& [text, named] : {std::pair{"{}", "tells no floor"}, std::pair{R"({"floor":null})", "tells no floor"},
                                    std::pair{"[1]", "not a JSON object"}, std::pair{"{", "not a JSON object"},
                                    std::pair{R"({"floor":{"normal":[0,-1,0]}})", "distance_mm"},
                                    std::pair{R"({"floor":{"normal":[0,-1,0],"distance_mm":1.2}})", "in mm"}}) {
    write_file_atomically(path, text);
    test::expect_refused<IoError>([&] { load_floor(path); }, {"report.json", named});
  }
}

}  // namespace
}  // namespace livecap
