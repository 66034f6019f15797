// Masks or label images: a folder with one file for each picture, made of the pictures by other tools.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "base/image_rgb.h"

namespace livecap {

// A picture as it is stored, and the clockwise quarter turns after which it is upright (image/exif_orientation.h).
struct StoredPicture {
  std::string name;  // in its folder
  int width = 0, height = 0;
  int turns = 0;
};

class CompanionFiles {
 public:
  // folder: empty: there are none. Tools turn pictures before they work on them, or do not: by their size, files of
  // pictures that were turned by 90 degrees tell what was done in this folder.
  CompanionFiles(std::filesystem::path folder, const std::vector<StoredPicture>& pictures);

  // folder/<stem of the picture>.png (or .jpg, or the picture's whole name with .png behind it, as COLMAP has it). The
  // companion of sub/a.jpg is sub/a.png; a.png only when no picture in another folder is called so as well. Empty:
  // there is none.
  std::filesystem::path of(const std::string& picture) const;

  // image: what `file` holds, turned as its picture was, if it was not yet. Throws IoError when it has another size.
  ImageGray upright(ImageGray image, const std::filesystem::path& file, const StoredPicture& picture);

  // How many were taken as upright although nothing tells.
  int n_unclear() const { return n_unclear_; }

 private:
  std::filesystem::path folder_;
  std::map<std::string, int> n_of_stem_;
  bool any_stored_ = false, any_turned_ = false;  // of the files whose size tells
  int n_unclear_ = 0;
};

}  // namespace livecap
