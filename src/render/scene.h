// One picture of a clip: what is behind, the floor, the person in the style asked for, the bones.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <utility>
#include <vector>

#include "base/image_rgb.h"
#include "render/backdrop.h"
#include "render/clip.h"
#include "render/floor_grid.h"
#include "render/options.h"
#include "render/viewpoint.h"

namespace livecap::render {

// What a picture is made from.
struct SceneFrame {
  int64_t row = 0;                      // of the clip's capture
  double share = 0;                     // of the clip that has passed, 0..1
  std::vector<float> vertices;          // [3*n] mm, camera frame; empty: nobody
  std::vector<Eigen::Vector3d> joints;  // mm, camera frame; empty: nobody
  ImageRgb video;                       // undistorted; empty where it is not needed
};

struct ScenePicture {
  ImageRgb color;
  ImageGray alpha;  // empty: opaque. The colour is not multiplied by it.
};

class Scene {
 public:
  // Keeps references to both. Throws like Backdrop, ConfigError for pictures that are too large, and IoError where the
  // capture lacks what the style shows.
  Scene(const Clip& clip, const RenderOptions& options);

  Viewpoint viewpoint(double share) const;
  // From several threads at once.
  ScenePicture paint(const SceneFrame& frame) const;

  int width() const { return width_; }  // of a picture, both halves of side by side
  int height() const { return fitted_.height; }
  // Pixels of what paint() draws, samples counted.
  int64_t drawn_pixels() const { return int64_t{options_.samples} * options_.samples * fitted_.width * fitted_.height; }

 private:
  ImageRgb paint_over(ImageRgb picture, const SceneFrame& frame, const Viewpoint& view) const;
  // Of the vertices, for the styles that have a colour each: [3*n] in [0,1].
  std::vector<float> colors(const SceneFrame& frame, const std::vector<float>& positions_view) const;

  const Clip& clip_;
  const RenderOptions& options_;
  Camera fitted_;  // the capture's camera in this size
  int width_;
  Surroundings around_;
  double distance_mm_ = 0;
  std::optional<Backdrop> backdrop_;
  std::optional<FloorGrid> floor_;
  std::vector<std::pair<int, int>> bones_;
};

}  // namespace livecap::render
