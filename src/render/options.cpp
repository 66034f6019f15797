#include "render/options.h"

#include <algorithm>
#include <cmath>

#include "base/joined.h"
#include "base/text.h"
#include "livecap/error.h"
#include "render/picture_sink.h"

namespace livecap::render {
namespace {

constexpr int kMinSide = 16, kMaxSide = 8192;
constexpr int kMaxSamples = 4;
constexpr int kMaxPanels = 100;

void require_one_of(const char* option, const std::string& value, const std::vector<std::string>& names) {
  if (std::find(names.begin(), names.end(), value) != names.end()) return;
  throw ConfigError(std::string(option) + " " + value + ": expected one of " + joined(names));
}

void require_within(const char* option, double value, double low, double high) {
  if (value >= low && value <= high) return;
  throw ConfigError(format("%s %g: expected %g to %g", option, value, low, high));
}

}  // namespace

const std::vector<std::string>& view_names() {
  static const std::vector<std::string> names = {"camera", "front", "left", "right", "back"};
  return names;
}

const std::vector<std::string>& style_names() {
  static const std::vector<std::string> names = {"texture", "clay",      "wire",        "checks",
                                                 "normals", "materials", "displacement"};
  return names;
}

bool RenderOptions::is_about_person() const {
  return view != "camera" || azimuth_deg || elevation_deg || distance_m || orbit;
}

bool RenderOptions::needs_video() const {
  return side_by_side || background == "video" || (background.empty() && !is_about_person());
}

void RenderOptions::validate() const {
  if (capture.empty()) throw ConfigError("--capture is missing: a folder that `livecap capture` wrote");
  if (out.empty()) throw ConfigError("--out is missing: FILE.mp4, FILE.png or a folder");
  output_kind(out);  // throws
  require_one_of("--view", view, view_names());
  require_one_of("--style", style, style_names());
  if (azimuth_deg) require_within("--azimuth", *azimuth_deg, -360, 360);
  if (elevation_deg) require_within("--elevation", *elevation_deg, -90, 90);
  if (distance_m) require_within("--distance", *distance_m, 0.5, 100);
  if (azimuth_deg && view != "camera")
    throw ConfigError("--azimuth and --view " + view + " both say from where: give one of them");
  if (background == "video" && is_about_person())
    throw ConfigError(
        "--background video: the video is the camera's view only; --side-by-side shows it beside another");
  if (background == "none" && side_by_side)
    throw ConfigError("--background none: not with --side-by-side, whose left half is opaque");
  if (background == "none" && output_kind(out) == OutputKind::kFilm)
    throw ConfigError("--background none: a film has no transparency; give --out FOLDER or FILE.png");
  require_within("--opacity", opacity, 0, 1);
  if (scale_mm && style != "displacement") throw ConfigError("--scale: is of --style displacement only");
  if (scale_mm && (!(*scale_mm > 0) || !std::isfinite(*scale_mm)))
    throw ConfigError(format("--scale %g: must be above 0 mm", *scale_mm));
  if (!floor && !is_about_person())
    throw ConfigError("--no-floor: the camera's own view has none; see --view, --azimuth and --orbit");
  if (width != 0 || height != 0) {
    require_within("--size", width, kMinSide, kMaxSide);
    require_within("--size", height, kMinSide, kMaxSide);
  }
  require_within("--samples", samples, 1, kMaxSamples);
  if (fps != 0 && output_kind(out) != OutputKind::kFilm)
    throw ConfigError("--fps: is of a film only; expected --out FILE.mp4");
  if (fps != 0) require_within("--fps", fps, kMinFps, kMaxFps);
  if (first < 0) throw ConfigError(format("--first %lld: must not be negative", static_cast<long long>(first)));
  if (every < 1) throw ConfigError(format("--every %lld: must be at least 1", static_cast<long long>(every)));
  if (orbit && sheet_columns == 0 && output_kind(out) == OutputKind::kPicture)
    throw ConfigError("--orbit: one picture does not turn; give --out FILE.mp4, a folder or --sheet, or --azimuth");
  if (sheet_columns != 0 || sheet_rows != 0) {
    require_within("--sheet", sheet_columns, 1, kMaxPanels);
    require_within("--sheet", sheet_rows, 1, kMaxPanels);
    if (output_kind(out) != OutputKind::kPicture) throw ConfigError("--sheet: one picture; expected --out FILE.png");
  }
}

}  // namespace livecap::render
