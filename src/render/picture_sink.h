// Where rendered pictures go: a film, a folder, one file.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "render/options.h"
#include "render/scene.h"

namespace livecap::render {

class PictureSink {
 public:
  virtual ~PictureSink() = default;
  // index: of the input frame. Throws IoError.
  virtual void write(int64_t index, const ScenePicture& picture) = 0;
  // What was written is complete with it, also when it is less than was planned. Throws IoError.
  virtual void finish() = 0;
};

enum class OutputKind { kFilm, kPicture, kFolder };

// By the name: .mp4, .png, or a folder, which may be there already. Throws ConfigError for another ending.
OutputKind output_kind(const std::string& out);

// For pictures of this size. Nothing of a film or a sheet is left when it is destroyed before finish(). Throws
// IoError for what cannot be written.
std::unique_ptr<PictureSink> open_sink(const RenderOptions& options, int width, int height, double fps);

}  // namespace livecap::render
