// Pictures of a known actor from all around, with cameras, masks and label images: what an actor build is tried on,
// because every step's truth is known. The pictures come from the renderer of the synthetic sequences, which shares
// nothing with what reads them.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>

#include "actor/actor.h"
#include "base/value_range.h"

namespace livecap::synth {

struct RehearsalOptions {
  static constexpr ValueRange kViews{1, 1000}, kSide{64, 8192};

  int n_views = 70;
  int width = 720;            // px
  int height = 960;           // px
  double fov_deg = 42;        // of the longer side
  double distance_mm = 2900;  // camera to the body's axis
  double noise = 1.2;         // sensor noise, 8-bit levels
  double blur_px = 0.4;
  double unit_mm = 1000;  // length of one unit of the cameras' world
  uint64_t seed = 1;

  void validate() const;  // throws ConfigError
};

// Writes images/, masks/, labels/ (%03d.png) and a COLMAP text model (cameras.txt, images.txt) into `folder`. The world
// is the actor's rest frame, Y up, in the given unit. progress: false stops. Throws ConfigError, IoError.
void write_rehearsal(const Actor& actor, const RehearsalOptions& options, const std::filesystem::path& folder,
                     const std::function<bool(int done, int total)>& progress = {});

}  // namespace livecap::synth
