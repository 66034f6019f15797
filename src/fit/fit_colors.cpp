// colors_from_frames of fit_actor.h.
#include <algorithm>
#include <cmath>

#include "base/median.h"
#include "fit/fit_actor.h"
#include "meshing/surface_parts.h"
#include "texture/texture.h"

namespace livecap {

namespace {

using Eigen::Vector3d;

constexpr float kLeastFacing = 0.25f;  // cosine; flatter ones show the background as often as themselves
constexpr float kInsidePx = 3;         // from the silhouette
constexpr size_t kLeastSightings = 2;
constexpr double kMirrorMm = 25;  // how near a vertex is to the mirror image of another

Vector3d color_at(const ImageRgb& image, const Eigen::Vector2f& pixel) {
  const int x = std::clamp(static_cast<int>(std::lround(pixel.x())), 0, image.width - 1),
            y = std::clamp(static_cast<int>(std::lround(pixel.y())), 0, image.height - 1);
  const uint8_t* p = &image.pixels[3 * (static_cast<size_t>(y) * image.width + x)];
  return Vector3d(p[0], p[1], p[2]) / 255;
}

}  // namespace

std::vector<Vector3d> colors_from_frames(FramePoser& poser, const meshing::Surface& surface,
                                         const std::vector<FitFrame>& frames, double& seen_share) {
  const size_t n = surface.vertices.size();
  std::vector<std::vector<Vector3d>> samples(n);
  const auto neighbors = meshing::neighbors_of(surface);
  for (const FitFrame& frame : frames) {
    if (!frame.posed) continue;
    const ViewCoverage seen = poser.cover(frame);
    for (size_t i = 0; i < n; ++i) {
      if (seen.facing[i] < kLeastFacing) continue;
      // Beside an occluder's edge a pixel may show the occluder.
      if (std::any_of(neighbors[i].begin(), neighbors[i].end(), [&](int other) { return seen.facing[other] <= 0; }))
        continue;
      const int x = static_cast<int>(std::lround(seen.pixels[i].x())),
                y = static_cast<int>(std::lround(seen.pixels[i].y()));
      if (x < 0 || y < 0 || x >= frame.image.width || y >= frame.image.height) continue;
      if (frame.silhouette.signed_distance[static_cast<size_t>(y) * frame.image.width + x] > -kInsidePx) continue;
      samples[i].push_back(color_at(frame.image, seen.pixels[i]));
    }
  }
  std::vector<Vector3d> colors(n, Vector3d::Constant(0.5));
  std::vector<char> known(n, 0);
  size_t n_seen = 0;
  for (size_t i = 0; i < n; ++i) {
    if (samples[i].size() < kLeastSightings) continue;
    std::vector<double> channel;
    for (int k = 0; k < 3; ++k) {
      channel.clear();
      for (const Vector3d& sample : samples[i]) channel.push_back(sample[k]);
      colors[i][k] = median(channel);
    }
    known[i] = 1;
    ++n_seen;
  }
  seen_share = n > 0 ? static_cast<double>(n_seen) / static_cast<double>(n) : 0;
  // The other side.
  std::vector<char> filled = known;
  for (size_t i = 0; i < n; ++i) {
    if (known[i]) continue;
    const Vector3d mirrored(-surface.vertices[i].x(), surface.vertices[i].y(), surface.vertices[i].z());
    double best = kMirrorMm * kMirrorMm;
    for (size_t j = 0; j < n; ++j) {
      if (!known[j]) continue;
      if (const double d = (surface.vertices[j] - mirrored).squaredNorm(); d < best) {
        best = d, filled[i] = 1;
        colors[i] = colors[j];
      }
    }
  }
  spread_colors(neighbors, filled, colors);
  return colors;
}

}  // namespace livecap
