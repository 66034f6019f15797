// What the options of a build have to be, and which of them go together.
#include "acquire/body_shape.h"
#include "acquire/build_actor.h"
#include "acquire/person_frame.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap::acquire {

void BuildOptions::validate() const {
  if (!turntable.video.empty()) {
    turntable.validate();
    for (const auto& [option, given] : {std::pair{"--images", !views.images.empty()},
                                        {"--cameras", !views.cameras.empty()},
                                        {"--masks", !views.masks.empty()},
                                        {"--labels", !views.labels.empty()},
                                        {"--mesh", !mesh.empty()},
                                        {"--joints", !joints.empty()}})
      if (given) throw ConfigError(std::string(option) + " does not go with --video, which finds its cameras itself");
  } else if (!turntable.camera.empty() || turntable.fov_deg > 0) {
    throw ConfigError("--camera and --fov belong to --video; the cameras of pictures are given by --cameras");
  }
  if (colmap) {
    if (views.images.empty()) throw ConfigError("--colmap needs --images, the pictures whose cameras it finds");
    for (const auto& [option, given] :
         {std::pair{"--cameras", !views.cameras.empty()}, {"--mesh", !mesh.empty()}, {"--joints", !joints.empty()}})
      if (given) throw ConfigError(std::string(option) + " does not go with --colmap, which makes a world of its own");
  }
  if (!parser.network.empty()) {
    parser.validate();
    if (!has_pictures()) throw ConfigError("--parser needs pictures: --images or --video");
    if (!views.labels.empty()) throw ConfigError("--labels does not go with --parser, which makes the label images");
  }
  if (!has_pictures() && mesh.empty())
    throw ConfigError(
        "--images, --video or --mesh is needed: pictures of the person, a video of them turning, or a scan");
  for (const auto& [option, given] : {std::pair{"--cameras", !views.cameras.empty()},
                                      {"--masks", !views.masks.empty()},
                                      {"--labels", !views.labels.empty()}})
    if (given && views.images.empty())
      throw ConfigError(std::string(option) + " needs --images, the pictures that it belongs to");
  unit_in_mm(unit);
  if (target_vertices < 500 || target_vertices > 40000)
    throw ConfigError(format("--vertices %d; must be within 500..40000", target_vertices));
  if (!(height_mm == 0 || (height_mm >= kLowestMm && height_mm <= kTallestMm)))
    throw ConfigError(format("--height %g m; must be within 0.8..2.5", height_mm / 1000));
  if (!(grid_mm >= 3 && grid_mm <= 30)) throw ConfigError(format("--grid %g mm; must be within 3..30", grid_mm));
  if (texture_size < 128 || texture_size > 8192)
    throw ConfigError(format("--texture %d; must be within 128..8192", texture_size));
}

}  // namespace livecap::acquire
