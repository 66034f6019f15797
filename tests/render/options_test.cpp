#include "render/options.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "livecap/error.h"

namespace livecap::render {
namespace {

RenderOptions good() {
  RenderOptions options;
  options.capture = "capture";
  options.out = "film.mp4";
  return options;
}

TEST(Options, EveryMistakeIsNamed) {
  good().validate();
  using Break = std::function<void(RenderOptions&)>;
  const std::vector<std::pair<std::string, Break>> mistakes = {
      {"--capture", [](RenderOptions& o) { o.capture.clear(); }},
      {"--out", [](RenderOptions& o) { o.out.clear(); }},
      {"--out film.avi", [](RenderOptions& o) { o.out = "film.avi"; }},
      {"--view above: expected one of camera, front", [](RenderOptions& o) { o.view = "above"; }},
      {"--style gold: expected one of texture, clay", [](RenderOptions& o) { o.style = "gold"; }},
      {"--elevation 91", [](RenderOptions& o) { o.elevation_deg = 91; }},
      {"--azimuth nan", [](RenderOptions& o) { o.azimuth_deg = std::nan(""); }},
      {"--azimuth", [](RenderOptions& o) { o.azimuth_deg = 10, o.view = "left"; }},
      {"--distance 0", [](RenderOptions& o) { o.distance_m = 0; }},
      {"--background video", [](RenderOptions& o) { o.background = "video", o.orbit = true; }},
      {"--background none", [](RenderOptions& o) { o.background = "none"; }},
      {"--background none", [](RenderOptions& o) { o.background = "none", o.out = "folder", o.side_by_side = true; }},
      {"--opacity 2", [](RenderOptions& o) { o.opacity = 2; }},
      {"--scale 0", [](RenderOptions& o) { o.scale_mm = 0, o.style = "displacement"; }},
      {"--scale", [](RenderOptions& o) { o.scale_mm = 30; }},
      {"--no-floor", [](RenderOptions& o) { o.floor = false; }},
      {"--orbit", [](RenderOptions& o) { o.orbit = true, o.out = "one.png"; }},
      {"--size 0", [](RenderOptions& o) { o.height = 100; }},
      {"--size 100000", [](RenderOptions& o) { o.width = 100000, o.height = 100; }},
      {"--samples 0", [](RenderOptions& o) { o.samples = 0; }},
      {"--fps -1", [](RenderOptions& o) { o.fps = -1; }},
      {"--fps 0.001", [](RenderOptions& o) { o.fps = 0.001; }},
      {"--fps nan", [](RenderOptions& o) { o.fps = std::nan(""); }},
      {"--fps", [](RenderOptions& o) { o.fps = 25, o.out = "folder"; }},
      {"--fps", [](RenderOptions& o) { o.fps = 25, o.out = "one.png"; }},
      {"--first -2", [](RenderOptions& o) { o.first = -2; }},
      {"--every 0", [](RenderOptions& o) { o.every = 0; }},
      {"--sheet", [](RenderOptions& o) { o.sheet_columns = 2, o.sheet_rows = 2; }},
      {"--sheet 0", [](RenderOptions& o) { o.sheet_columns = 2, o.out = "sheet.png"; }},
  };
  for (const auto& [expected, apply] : mistakes) {
    RenderOptions options = good();
    apply(options);
    try {
      options.validate();
      ADD_FAILURE() << expected << " was accepted";
    } catch (const ConfigError& error) {
      EXPECT_EQ(std::string(error.what()).rfind(expected, 0), 0u) << error.what();
    }
  }
}

TEST(Options, WhatIsAboutThePersonAndWhatNeedsTheVideo) {
  RenderOptions options = good();
  EXPECT_FALSE(options.is_about_person());
  EXPECT_TRUE(options.needs_video());
  options.background = "#ffffff";
  EXPECT_FALSE(options.needs_video());
  options = good();
  options.elevation_deg = 5;
  EXPECT_TRUE(options.is_about_person());
  EXPECT_FALSE(options.needs_video());
  options.side_by_side = true;
  EXPECT_TRUE(options.needs_video());
}

}  // namespace
}  // namespace livecap::render
