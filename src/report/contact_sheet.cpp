#include "report/contact_sheet.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <set>

#include "base/log.h"
#include "base/text.h"
#include "eval/mask_raster.h"
#include "eval/true_mesh.h"
#include "eval/truth_folder.h"
#include "image/undistort.h"
#include "image/video.h"
#include "livecap/error.h"
#include "picture/color_scale.h"
#include "picture/overlay.h"
#include "picture/side_by_side.h"

namespace livecap {
namespace {

constexpr double kMarginShare = 0.05;  // of the person's height, around the cut
constexpr double kAspect = 0.62;       // width over height of a panel, so that all are alike
constexpr int kGapPx = 4;              // between panels
constexpr uint8_t kPaper = 250, kBoth = 205;
constexpr float kDimmed = 0.30f;  // of the input behind the error

struct Box {
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // the last two are outside
};

// Around the pixels of either mask.
Box box_of(const ImageGray& a, const ImageGray& b, const Camera& camera) {
  Box box{camera.width, camera.height, 0, 0};
  for (const ImageGray* mask : {&a, &b}) {
    for (size_t i = 0; i < mask->pixels.size(); ++i) {
      if (mask->pixels[i] < 128) continue;
      const int x = static_cast<int>(i) % mask->width, y = static_cast<int>(i) / mask->width;
      box = {std::min(box.x0, x), std::min(box.y0, y), std::max(box.x1, x + 1), std::max(box.y1, y + 1)};
    }
  }
  if (box.x1 <= box.x0) return {0, 0, camera.width, camera.height};
  // Grown to the aspect where the picture is large enough, then moved inside.
  const double margin = 2 * kMarginShare * (box.y1 - box.y0);
  const double height = std::max(box.y1 - box.y0 + margin, (box.x1 - box.x0 + margin) / kAspect);
  const int rows = std::min(static_cast<int>(height), camera.height);
  const int columns = std::min(static_cast<int>(height * kAspect), camera.width);
  const int x0 = std::clamp((box.x0 + box.x1 - columns) / 2, 0, camera.width - columns);
  const int y0 = std::clamp((box.y0 + box.y1 - rows) / 2, 0, camera.height - rows);
  return {x0, y0, x0 + columns, y0 + rows};
}

// Mean over the source pixels below each pixel; enlarging repeats them.
ImageRgb cut(const ImageRgb& image, const Box& box, int height) {
  const double scale = static_cast<double>(box.y1 - box.y0) / height;
  const int width = std::max(1, static_cast<int>(std::lround((box.x1 - box.x0) / scale)));
  ImageRgb out{width, height, std::vector<uint8_t>(size_t(3) * width * height)};
  for (int y = 0; y < height; ++y) {
    const int y0 = std::min(box.y0 + static_cast<int>(y * scale), box.y1 - 1);
    const int y1 = std::clamp(box.y0 + static_cast<int>((y + 1) * scale), y0 + 1, box.y1);
    for (int x = 0; x < width; ++x) {
      const int x0 = std::min(box.x0 + static_cast<int>(x * scale), box.x1 - 1);
      const int x1 = std::clamp(box.x0 + static_cast<int>((x + 1) * scale), x0 + 1, box.x1);
      int sum[3] = {};
      for (int v = y0; v < y1; ++v) {
        for (int u = x0; u < x1; ++u) {
          for (int k = 0; k < 3; ++k) sum[k] += image.pixels[3 * (size_t(v) * image.width + u) + k];
        }
      }
      for (int k = 0; k < 3; ++k) {
        out.pixels[3 * (size_t(y) * width + x) + k] = static_cast<uint8_t>(sum[k] / ((y1 - y0) * (x1 - x0)));
      }
    }
  }
  return out;
}

ImageRgb plain(const Camera& camera) {
  return {camera.width, camera.height, std::vector<uint8_t>(size_t(3) * camera.width * camera.height, kPaper)};
}

// Grey: in both; red: missing in the capture; blue: too much.
ImageRgb outline_picture(const ImageGray& captured, const ImageGray& truth, const Camera& camera) {
  ImageRgb picture = plain(camera);
  for (size_t i = 0; i < truth.pixels.size(); ++i) {
    const bool ours = captured.pixels[i] >= 128, theirs = truth.pixels[i] >= 128;
    if (!ours && !theirs) continue;
    const Rgb color = ours && theirs ? Rgb{kBoth, kBoth, kBoth} : theirs ? Rgb{214, 40, 40} : Rgb{40, 90, 200};
    for (int k = 0; k < 3; ++k) picture.pixels[3 * i + k] = static_cast<uint8_t>(color[k]);
  }
  return picture;
}

ImageRgb error_picture(const std::vector<float>& vertices, const std::vector<float>& truth, const Actor& actor,
                       const Camera& camera, const ImageRgb& input) {
  ImageRgb picture = input;
  for (uint8_t& value : picture.pixels) value = static_cast<uint8_t>(kPaper - kDimmed * (255 - value));
  const std::vector<float> colors = heat_colors(translation_aligned_distances(vertices, truth), kHeatScaleMm);
  OverlayOptions options;
  options.alpha = 1;
  options.colors = colors;
  return render_overlay(actor, vertices, camera, picture, options);
}

// The frames of the video that are wanted, by index; empty when it cannot be read. given: by the user, else the
// capture's own.
std::map<int64_t, ImageRgb> read_frames(const EvalOptions& options, const std::string& given, const std::string& own,
                                        const std::set<int64_t>& wanted, const Undistorter& undistorter) {
  const std::string& video = given.empty() ? own : given;
  std::map<int64_t, ImageRgb> images;
  if (video.empty() || wanted.empty()) return images;
  try {
    if (given.empty()) require_no_pipe(own);
    VideoReader reader(video);
    for (Frame frame; (!options.go_on || options.go_on()) && reader.read(frame) && frame.index <= *wanted.rbegin();) {
      if (wanted.count(frame.index)) images[frame.index] = undistorter.undistort(frame.image);
    }
  } catch (const Error& error) {
    log_warning(std::string("the report has no input pictures: ") + error.what());
    images.clear();
  }
  return images;
}

}  // namespace

ContactSheet contact_sheet(const EvalOptions& options, const std::string& video, const std::vector<int64_t>& frames,
                           int height_px) {
  CaptureFolder capture = open_capture(options.capture, options.actor, options.camera, options.truth / "masks");
  const TrueMesh true_mesh(options.truth, options.truth_actor, capture.actor);
  TruthFolder truth = open_truth(options.truth, capture.vertices ? true_mesh.n_vertices() : 0);
  const Undistorter undistorter(capture.camera);
  const Camera camera = undistorter.undistorted_camera();
  const std::set<int64_t> wanted(frames.begin(), frames.end());
  const std::map<int64_t, ImageRgb> inputs = read_frames(options, video, capture.video, wanted, undistorter);

  ContactSheet sheet;
  sheet.has_video = !inputs.empty();
  sheet.has_outline = !truth.masks.empty();
  sheet.has_error = truth.vertices.has_value();
  for (int64_t row = 0; row < static_cast<int64_t>(capture.rows.size()); ++row) {
    const int64_t index = capture.rows[row].index;
    if (!wanted.count(index)) continue;
    require_going_on(options);
    const TruthFrame expected = truth_frame(truth, index, capture.camera);
    const std::vector<float> vertices = captured_vertices(capture, row);
    const ImageGray captured = render_silhouette(vertices, capture.actor.mesh.triangles, capture.camera);
    const Box box = box_of(captured, expected.mask, camera);
    const auto found = inputs.find(index);
    const ImageRgb input = found != inputs.end() ? found->second : plain(camera);
    std::vector<ImageRgb> panels;
    if (sheet.has_video) panels.push_back(cut(input, box, height_px));
    panels.push_back(
        cut(vertices.empty() ? input : render_overlay(capture.actor, vertices, camera, input), box, height_px));
    if (sheet.has_outline) {
      panels.push_back(
          cut(expected.mask.empty() ? plain(camera) : outline_picture(captured, expected.mask, capture.camera), box,
              height_px));
    }
    if (sheet.has_error) {
      const bool known = !vertices.empty() && !expected.vertices_mm.empty();
      panels.push_back(
          cut(known ? error_picture(vertices, true_mesh.of_captured(expected.vertices_mm), capture.actor, camera, input)
                    : plain(camera),
              box, height_px));
    }
    sheet.pictures[index] = side_by_side(panels, kGapPx);
  }
  return sheet;
}

}  // namespace livecap
