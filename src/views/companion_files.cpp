#include "views/companion_files.h"

#include <utility>

#include "base/text.h"
#include "image/exif_orientation.h"
#include "image/image_io.h"
#include "livecap/error.h"

namespace livecap {

namespace {

using std::filesystem::path;

bool size_tells(const StoredPicture& picture) {
  return picture.turns % 2 == 1 && picture.width != picture.height;
}

// A JPEG with EXIF data of its own has been turned when it was read.
bool turns_itself(const path& file) {
  return exif_orientation(read_file(file)) != 1;
}

ImageGray turned(const ImageGray& image, int quarter_turns) {
  ImageGray result = image;
  for (int i = 0; i < quarter_turns; ++i) {
    const ImageGray from = result;
    result.width = from.height, result.height = from.width;
    for (int y = 0; y < from.height; ++y)
      for (int x = 0; x < from.width; ++x)
        result.pixels[size_t(x) * result.width + from.height - 1 - y] = from.pixels[size_t(y) * from.width + x];
  }
  return result;
}

}  // namespace

CompanionFiles::CompanionFiles(path folder, const std::vector<StoredPicture>& pictures) : folder_(std::move(folder)) {
  for (const StoredPicture& picture : pictures) ++n_of_stem_[path(picture.name).stem().string()];
  if (folder_.empty()) return;
  for (const StoredPicture& picture : pictures) {
    if (!size_tells(picture)) continue;
    const path file = of(picture.name);
    if (file.empty()) continue;
    try {
      if (turns_itself(file)) continue;
      const auto size = stored_picture_size(file);
      any_stored_ |= size == std::pair{picture.width, picture.height};
      any_turned_ |= size == std::pair{picture.height, picture.width};
    } catch (const IoError&) {  // told when it is read
    }
  }
}

path CompanionFiles::of(const std::string& picture) const {
  const path name = path(picture).filename(), below = path(picture).parent_path();
  std::vector<path> folders = {folder_ / below};
  if (!below.empty() && n_of_stem_.at(name.stem().string()) == 1) folders.push_back(folder_);
  for (const path& where : folders)
    for (const std::string& candidate :
         {name.stem().string() + ".png", name.string() + ".png", name.stem().string() + ".jpg"})
      if (std::filesystem::exists(where / candidate)) return where / candidate;
  return {};
}

ImageGray CompanionFiles::upright(ImageGray image, const path& file, const StoredPicture& picture) {
  if (picture.turns > 0 && !turns_itself(file)) {
    if (size_tells(picture) ? image.width == picture.width && image.height == picture.height
                            : any_stored_ && !any_turned_)
      image = turned(image, picture.turns);
    else if (!size_tells(picture) && any_stored_ == any_turned_)
      ++n_unclear_;
  }
  const bool sideways = picture.turns % 2 == 1;
  const int width = sideways ? picture.height : picture.width, height = sideways ? picture.width : picture.height;
  if (image.width != width || image.height != height)
    throw IoError(file.string() +
                  format(": %d x %d, its picture is %d x %d", image.width, image.height, width, height));
  return image;
}

}  // namespace livecap
