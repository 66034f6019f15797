// Where the cameras of a set of pictures stood, in the formats of other tools; how a JPEG is turned.
#include "base/text.h"
#include "fuzz/fuzz.h"
#include "image/exif_orientation.h"
#include "views/camera_files.h"

namespace livecap::fuzz {
namespace {

const std::vector<std::string> kFiles = {"cameras.txt",  "images.txt",  "cameras.yml",
                                         "cameras.json", "cameras.xml", "pictures/0.jpg"};

const char* const kColmapCameras =
    "# comment\n1 PINHOLE 640 480 500 510 320 240\n7 OPENCV 640 480 500 510 320 240 0.1 0.02 0.003 0.004\n"
    "8 SIMPLE_RADIAL 64 48 50 32 24 0.1\n";
const char* const kColmapImages =
    "2 0.70710678 0 0.70710678 0 1 2 3 7 b side.jpg\n1 2 3 4\n1 1 0 0 0 0 0 5 1 a.png\n\n3 1 0 0 0 0 0 5e0 8 c.png\n\n";

const char* const kYaml = R"(%YAML:1.0
---
image_width: 640
image_height: 480
camera_matrix: !!opencv-matrix
   rows: 3
   cols: 3
   dt: d
   data: [ 500., 0., 320., 0., 510., 240., 0., 0., 1. ]
distortion_coefficients: !!opencv-matrix
   rows: 1
   cols: 5
   dt: d
   data: [ 0.1, 0., 0., 0., 0. ]
views:
   - { image: "a.png", rvec: !!opencv-matrix { rows: 3, cols: 1, dt: d, data: [ 0., 1., 0. ] },
       tvec: !!opencv-matrix { rows: 3, cols: 1, dt: d, data: [ 0., 0., 5. ] } }
   - { image: "b.png", R: !!opencv-matrix { rows: 3, cols: 3, dt: f, data: [ 1., 0., 0., 0., 1., 0., 0., 0., 1. ] },
       T: !!opencv-matrix { rows: 1, cols: 3, dt: d, data: [ 0., 0., 5. ] } }
)";
const char* const kJson = R"({
    "image_width": 640, "image_height": 480,
    "camera_matrix": { "type_id": "opencv-matrix", "rows": 3, "cols": 3, "dt": "d", "data": [ 500, 0, 320, 0, 510, 240, 0, 0, 1 ] },
    "views": [ { "image": "a.png",
        "rvec": { "type_id": "opencv-matrix", "rows": 3, "cols": 1, "dt": "d", "data": [ 0, 1, 0 ] },
        "tvec": { "type_id": "opencv-matrix", "rows": 3, "cols": 1, "dt": "d", "data": [ 0, 0, 5 ] } } ]
})";

// The segments before a picture: one of another kind, then the orientation.
std::string turned_jpeg() {
  return std::string("\xff\xd8\xff\xe0\0\4xx\xff\xe1\0\x22", 12) + std::string("Exif\0\0II*\0\x08\0\0\0\1\0", 16) +
         std::string("\x12\1\3\0\1\0\0\0\6\0\0\0\0\0\0\0\xff\xda", 18);
}

}  // namespace

std::vector<std::string> seeds() {
  return {join_files({{"cameras.txt", kColmapCameras}, {"images.txt", kColmapImages}}),
          join_files({{"cameras.yml", kYaml}}), join_files({{"cameras.json", kJson}}),
          join_files({{"pictures/0.jpg", turned_jpeg()}})};
}

}  // namespace livecap::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace livecap;
  static const fuzz::ScratchFolder folder;
  const auto files = fuzz::split_files({reinterpret_cast<const char*>(data), size}, fuzz::kFiles);
  folder.hold(files);
  const auto read = [&](const std::filesystem::path& path) {
    fuzz::accepts(folder.path().string(), [&] {
      for (const ViewPose& view : read_view_poses(path, folder.path() / "pictures")) {
        view.camera.validate();
        fuzz::require(view.camera_from_world.matrix().allFinite(), "finite poses");
      }
    });
  };
  if (files.count("cameras.txt")) read(folder.path());
  for (const char* name : {"cameras.yml", "cameras.json", "cameras.xml"}) {
    if (files.count(name)) read(folder.path() / name);
  }
  if (files.count("pictures/0.jpg")) {
    fuzz::accepts(folder.path().string(), [&] {
      const int turns = quarter_turns(exif_orientation(read_file(folder.path() / "pictures/0.jpg")));
      fuzz::require(turns >= 0 && turns <= 3, "0 to 3 quarter turns");
    });
  }
  return 0;
}
