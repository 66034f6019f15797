// The truth of a sequence from the motion that a data set gives for its template: where the skeleton's joints and, by
// its skin, the mesh's vertices are in every frame of one camera's video (docs/evaluation.md, "Published data").
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "acquire/import_template.h"

namespace livecap::acquire {

struct MotionFiles {
  std::filesystem::path motion;
  std::filesystem::path cameras;  // empty: the motion is in the camera's frame already
  std::string camera;             // which; empty: the only one
  int first = -1;                 // frame number of the motion that is the video's first; -1: the motion's own first
};

struct TemplateMotion {
  SkeletoolMotion motion;
  std::optional<SkeletoolCamera> camera;
  int first = 0;
  int n_frames = 0;  // of the video, up to the motion's last
};

// Throws IoError naming the file and line, ConfigError for a camera that is not named or not there, or for a first
// frame behind the motion's last.
TemplateMotion read_template_motion(const MotionFiles& files, const SkeletoolSkeleton& skeleton);

// The files that write_template_truth writes.
std::vector<std::filesystem::path> template_truth_files(const std::filesystem::path& folder,
                                                        const TemplateMotion& motion);

struct TruthSummary {
  int n_known = 0;    // frames that the motion has
  int n_outside = 0;  // of these, with the root behind the camera or beside its picture
};

// joints.json, vertices.pc2 and, with a camera, camera.json. folder must be there. actor: the template as
// load_actor_bytes gives it, whose vertex order the file has. Frames that the motion lacks are unknown. progress:
// frames done; false stops with an Error. Throws IoError when something cannot be written.
TruthSummary write_template_truth(const ImportedTemplate& imported, const Actor& actor, const TemplateMotion& motion,
                                  const std::filesystem::path& folder,
                                  const std::function<bool(int done, int total)>& progress = {});

}  // namespace livecap::acquire
