#include "views/load_views.h"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "base/median.h"
#include "base/text.h"
#include "image/exif_orientation.h"
#include "image/image_io.h"
#include "image/undistort.h"
#include "livecap/error.h"
#include "views/companion_files.h"
#include "views/picture_orientation.h"

namespace livecap {

namespace {

using std::filesystem::path;

// Where each pixel of the reduced, undistorted picture comes from in the picture as it was taken.
cv::Mat sampling_map(const Camera& from, const Camera& to) {
  cv::Mat map(to.height, to.width, CV_32FC2);
  for (int v = 0; v < to.height; ++v)
    for (int u = 0; u < to.width; ++u) {
      const auto [x, y] = distorted(from, (u - to.cx) / to.fx, (v - to.cy) / to.fy);
      map.at<cv::Vec2f>(v, u) = {static_cast<float>(from.fx * x + from.cx), static_cast<float>(from.fy * y + from.cy)};
    }
  return map;
}

ImageRgb sample_rgb(const ImageRgb& image, const cv::Mat& map, int factor) {
  cv::Mat from(image.height, image.width, CV_8UC3, const_cast<uint8_t*>(image.pixels.data()));
  cv::Mat averaged = from;
  if (factor > 1) cv::blur(from, averaged, {factor, factor});
  ImageRgb result{map.cols, map.rows, std::vector<uint8_t>(size_t(3) * map.cols * map.rows)};
  cv::Mat to(map.rows, map.cols, CV_8UC3, result.pixels.data());
  cv::remap(averaged, to, map, cv::noArray(), cv::INTER_LINEAR, cv::BORDER_REPLICATE);
  return result;
}

ImageGray sample_gray(const ImageGray& image, const cv::Mat& map, int interpolation) {
  const cv::Mat from(image.height, image.width, CV_8UC1, const_cast<uint8_t*>(image.pixels.data()));
  ImageGray result{map.cols, map.rows, std::vector<uint8_t>(size_t(map.cols) * map.rows)};
  cv::Mat to(map.rows, map.cols, CV_8UC1, result.pixels.data());
  cv::remap(from, to, map, cv::noArray(), interpolation, cv::BORDER_CONSTANT, 0);
  return result;
}

Camera reduced(const Camera& camera, int max_side) {
  const double share = std::min(1.0, static_cast<double>(max_side) / std::max(camera.width, camera.height));
  Camera small = camera;
  small.width = std::max(1, static_cast<int>(std::lround(camera.width * share)));
  small.height = std::max(1, static_cast<int>(std::lround(camera.height * share)));
  const double sx = static_cast<double>(small.width) / camera.width,
               sy = static_cast<double>(small.height) / camera.height;
  small.fx *= sx;
  small.fy *= sy;
  small.cx = (camera.cx + 0.5) * sx - 0.5;
  small.cy = (camera.cy + 0.5) * sy - 0.5;
  small.distortion = {};
  return small;
}

// Clockwise, of COLMAP's pictures, whose cameras are those of the stored picture; 0 for what cannot be read.
int stored_turns(const path& file) {
  if (!std::filesystem::exists(file)) return 0;
  try {
    require_no_pipe(file);
    return quarter_turns(exif_orientation(read_file(file)));
  } catch (const IoError&) {  // told when the picture is read
    return 0;
  }
}

// 255 = person. Some tools write 1 instead, which would be nobody.
ImageGray read_mask(const path& file) {
  ImageGray mask = read_image_mask(file);
  const int most = mask.pixels.empty() ? 0 : *std::max_element(mask.pixels.begin(), mask.pixels.end());
  if (most > 0 && most < 128)
    throw IoError(file.string() + format(": its largest value is %d; in a mask 255 means person", most));
  return mask;
}

bool is_all(const ImageGray& mask, uint8_t expected) {
  return std::all_of(mask.pixels.begin(), mask.pixels.end(), [&](uint8_t value) { return value == expected; });
}

View view_of(const std::string& name, const ImageRgb& image, const Camera& camera, int max_side_px, cv::Mat& map) {
  View view;
  view.name = name;
  view.camera = reduced(camera, max_side_px);
  map = sampling_map(camera, view.camera);
  view.image = sample_rgb(image, map, std::max(1, static_cast<int>(camera.width / view.camera.width)));
  return view;
}

}  // namespace

View view_of(const std::string& name, const ImageRgb& image, const Camera& camera, int max_side_px) {
  cv::Mat map;
  return view_of(name, image, camera, max_side_px, map);
}

double sharpness(const ImageRgb& image) {
  if (image.width < 3 || image.height < 3) return 0;
  const cv::Mat rgb(image.height, image.width, CV_8UC3, const_cast<uint8_t*>(image.pixels.data()));
  cv::Mat gray, small;
  cv::cvtColor(rgb, gray, cv::COLOR_RGB2GRAY);
  const double share = 640.0 / std::max(image.width, image.height);
  if (share < 1)
    cv::resize(gray, small, {}, share, share, cv::INTER_AREA);
  else
    small = gray;
  small.convertTo(small, CV_32F);
  cv::Scalar mean, deviation;
  cv::meanStdDev(small, mean, deviation);
  cv::Mat blurred;
  cv::GaussianBlur(small, blurred, {3, 3}, 0.8);
  const double lost = cv::norm(small, blurred, cv::NORM_L2) / std::sqrt(static_cast<double>(small.total()));
  return deviation[0] > 1 ? lost / deviation[0] : 0;
}

std::vector<View> load_views(const ViewFiles& files, std::vector<std::string>& notes) {
  if (!std::filesystem::is_directory(files.images)) throw IoError(files.images.string() + ": is no folder of pictures");
  for (const auto& [option, folder] : {std::pair{"--masks", files.masks}, std::pair{"--labels", files.labels}})
    if (!folder.empty() && !std::filesystem::is_directory(folder))
      throw IoError(folder.string() + ": is no folder (" + option + ")");
  const path where = files.cameras.empty() ? find_view_poses(files.images) : files.cameras;
  if (files.cameras.empty()) notes.push_back("cameras: of " + where.string() + " (--cameras says otherwise)");
  std::vector<View> views;
  std::vector<double> sharp;
  int n_missing = 0, n_no_mask = 0, n_no_labels = 0;
  bool any_in_masks = false, any_around = false;
  int n_turned = 0;
  const bool as_stored = is_colmap_model(where);
  const std::vector<ViewPose> poses = read_view_poses(where, files.images);
  std::vector<StoredPicture> stored;
  for (const ViewPose& pose : poses)
    stored.push_back({pose.picture, pose.camera.width, pose.camera.height,
                      as_stored ? stored_turns(files.images / pose.picture) : 0});
  CompanionFiles masks(files.masks, stored), label_images(files.labels, stored);
  for (size_t i = 0; i < poses.size(); ++i) {
    ViewPose pose = poses[i];
    const path file = files.images / pose.picture;
    if (!std::filesystem::exists(file)) {
      if (++n_missing <= 3)
        notes.push_back(file.string() + ": named by " + where.string() + " but not there; left out");
      continue;
    }
    ImageRgb image;
    try {
      require_no_pipe(file);
      image = read_image_rgb(file);
    } catch (const IoError& error) {
      notes.push_back(std::string(error.what()) + "; left out");
      continue;
    }
    if (stored[i].turns > 0) pose = turned(pose, stored[i].turns), ++n_turned;
    const Camera& camera = pose.camera;
    if (image.width != camera.width || image.height != camera.height)
      throw IoError(file.string() + format(": %d x %d, its camera has %d x %d", image.width, image.height, camera.width,
                                           camera.height));
    cv::Mat map;
    View view = view_of(pose.picture, image, camera, files.max_side_px, map);
    view.camera_from_world = pose.camera_from_world;
    if (!files.masks.empty()) {
      if (const path file = masks.of(pose.picture); !file.empty()) {
        const ImageGray mask = masks.upright(read_mask(file), file, stored[i]);
        any_in_masks |= !is_all(mask, 0);
        any_around |= !is_all(mask, 255);
        view.mask = sample_gray(mask, map, cv::INTER_LINEAR);
        view.exact_mask = true;
      } else {
        ++n_no_mask;
      }
    }
    if (!files.labels.empty()) {
      if (const path file = label_images.of(pose.picture); !file.empty())
        view.labels =
            sample_gray(label_images.upright(read_image_labels(file), file, stored[i]), map, cv::INTER_NEAREST);
      else
        ++n_no_labels;
    }
    sharp.push_back(sharpness(view.image));
    views.push_back(std::move(view));
  }
  if (n_turned > 0) notes.push_back(format("%d pictures are turned upright as their EXIF data says", n_turned));
  for (const auto& [folder, n] : {std::pair{files.masks, masks.n_unclear()}, {files.labels, label_images.n_unclear()}})
    if (n > 0)
      notes.push_back(
          format("%d files in %s are of pictures that were turned upside down, or are square: their size does not tell "
                 "whether they were turned too, and they are taken as upright",
                 n, folder.string().c_str()));
  if (n_missing > 3) notes.push_back(format("%d pictures in all are not there", n_missing));
  if (const int n_masks = static_cast<int>(views.size()) - n_no_mask; !files.masks.empty() && !views.empty()) {
    if (n_masks == 0)
      throw IoError(files.masks.string() +
                    format(": has a mask of none of the %zu pictures (expected <stem>.png)", views.size()));
    if (!any_in_masks)
      throw IoError(files.masks.string() + format(": nobody is in any of the %d masks; 255 means person", n_masks));
    if (!any_around)
      throw IoError(files.masks.string() +
                    format(": the person fills all of the %d masks; 255 means person, 0 background", n_masks));
  }
  if (n_no_mask > 0)
    notes.push_back(
        format("%d pictures have no mask in %s; the network's is used", n_no_mask, files.masks.string().c_str()));
  if (n_no_labels > 0) {
    const std::string expected = format("label image in %s (expected <stem>.png)", files.labels.string().c_str());
    if (n_no_labels == static_cast<int>(views.size()))
      throw IoError(format("none of the %zu pictures has a ", views.size()) + expected);
    notes.push_back(format("%d of %zu pictures have no ", n_no_labels, views.size()) + expected);
  }
  // A picture much less sharp than the others was moved or out of focus.
  if (!views.empty()) {
    const double usual = median(sharp);
    std::vector<View> kept;
    for (size_t i = 0; i < views.size(); ++i) {
      if (sharp[i] < 0.4 * usual)
        notes.push_back(views[i].name + format(": blurred (%.2f of the usual sharpness); left out", sharp[i] / usual));
      else
        kept.push_back(std::move(views[i]));
    }
    views = std::move(kept);
    if (usual < 0.02) notes.push_back("all pictures are blurred; texture and shape will be coarse");
  }
  if (static_cast<int>(views.size()) < kMinViews)
    throw ConfigError(
        format("%s: %zu usable pictures with cameras; at least %d from all around are needed, 40 to 80 are good",
               files.images.string().c_str(), views.size(), kMinViews));
  return views;
}

}  // namespace livecap
