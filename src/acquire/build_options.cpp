// What the options of a build have to be, and which of them go together.
#include "acquire/build_actor.h"
#include "acquire/person_frame.h"
#include "actor/height_range.h"
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
  require_within("--vertices", target_vertices, kTargetVertices);
  require_person_height(height_mm);
  require_within("--grid", grid_mm, kGridMm, "mm");
  require_within("--texture", texture_size, kTextureSize, "px");
}

}  // namespace livecap::acquire
