// The pictures, masks and label images of a set of views, undistorted and reduced to a workable size.
#pragma once

#include <filesystem>
#include <functional>

#include "views/camera_files.h"
#include "views/view.h"

namespace livecap {

struct ViewFiles {
  std::filesystem::path images;   // folder of .png/.jpg
  std::filesystem::path cameras;  // see camera_files.h; empty: looked for
  std::filesystem::path masks;    // folder of pictures with the same stems; empty: none
  std::filesystem::path labels;   // the same for LIP ids
  int max_side_px = 1280;         // larger pictures are reduced
};

// Pictures that cannot be read, or have no camera, or are blurred beyond use are left out with a note. Throws IoError
// or ConfigError when a file says something impossible or fewer than kMinViews are left.
std::vector<View> load_views(const ViewFiles& files, std::vector<std::string>& notes);

inline constexpr int kMinViews = 8;

// One picture as a view, undistorted, at most max_side_px large; where its camera was stays open.
View view_of(const std::string& name, const ImageRgb& image, const Camera& camera, int max_side_px);

// What a slight blur takes away from the picture (640 px), over its contrast: a measure of blur that light does not
// change.
double sharpness(const ImageRgb& image);

}  // namespace livecap
