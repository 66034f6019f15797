// What `livecap render` can be told.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace livecap::render {

// camera, front, left, right, back.
const std::vector<std::string>& view_names();

// texture, clay, wire, checks, normals, materials, displacement: see docs/formats.md.
const std::vector<std::string>& style_names();

inline constexpr double kScaleMm = 60;

// Of a film.
inline constexpr double kMinFps = 0.01, kMaxFps = 1000;

struct RenderOptions {
  std::string capture;  // folder that run_capture wrote
  std::string actor;    // empty: what its report.json names, else its own actor.glb
  std::string camera;   // empty: likewise; needed for the video only
  std::string video;    // empty: what report.json names
  std::string out;      // FILE.mp4, FILE.png (one picture, or the sheet) or a folder for pictures

  std::string view = "camera";          // one of view_names()
  std::optional<double> azimuth_deg{};  // about the person, from where the capturing camera stands; 90: their left
  std::optional<double> elevation_deg{};
  std::optional<double> distance_m{};  // empty: so that all is seen
  bool orbit = false;                  // once around while the clip lasts

  std::string style = "texture";     // one of style_names()
  double opacity = 1;                // of the person, 0..1
  std::optional<double> scale_mm{};  // displacement: what has the last colour; empty: kScaleMm
  bool skeleton = false;             // bones over it
  std::string background;            // video, none, #rrggbb or a picture file; empty: video, about the person plain
  bool floor = true;                 // about the person: a grid and a shadow
  bool side_by_side = false;         // the video at the left

  int width = 0, height = 0;  // px, of a picture or of a panel of the sheet; 0: the camera's
  int samples = 2;            // per pixel and axis, 1..4
  double fps = 0;             // of a film; 0: so that the clip lasts as long as it did
  int64_t first = 0;          // frame of the video
  int64_t frames = -1;        // at most this many of the video; -1: all
  int64_t every = 1;          // leave out all others
  int sheet_columns = 0;      // > 0: this many by sheet_rows pictures of the clip in one, evenly chosen
  int sheet_rows = 0;

  bool is_about_person() const;
  bool needs_video() const;
  // Throws ConfigError naming the option as the command line has it.
  void validate() const;
};

}  // namespace livecap::render
