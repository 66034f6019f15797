// `livecap render`: pictures and films of a capture folder, from its own camera or from anywhere about the person.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>

#include "render/options.h"

namespace livecap::render {

struct RenderReport {
  int64_t pictures = 0;  // painted; a sheet holds that many
  int64_t empty = 0;     // of them without the person: frames that were not tracked
  int width = 0;         // of a picture, px
  int height = 0;
  double fps = 0;        // of the film
  bool complete = true;  // false: stopped early; the pictures before that are written
};

// After each picture; false stops.
using RenderProgress = std::function<bool(int64_t done, int64_t total)>;

// How many pictures of so many pixels, samples counted, are painted at a time: one for every processor, but no more
// than 2 GB have room for.
size_t pictures_at_once(int64_t drawn_pixels, unsigned processors);

// Throws ConfigError for options, IoError for a folder or a file that is not what it has to be and for output that
// cannot be written; no film or sheet is left then, and a folder has the pictures that the message counts.
RenderReport render_capture(const RenderOptions& options, const RenderProgress& progress = {});

}  // namespace livecap::render
