#include <cmath>
#include <filesystem>

#include "actor/height_range.h"
#include "base/fov_range.h"
#include "base/text.h"
#include "capture/components.h"
#include "image/video.h"
#include "livecap/capture.h"
#include "livecap/error.h"

namespace livecap {

const char* track_status_name(TrackStatus status) {
  switch (status) {
    case TrackStatus::kOk:
      return "ok";
    case TrackStatus::kInitialized:
      return "initialized";
    case TrackStatus::kNobody:
      return "nobody";
    case TrackStatus::kLost:
      return "lost";
    case TrackStatus::kDamaged:
      return "damaged";
    case TrackStatus::kDropped:
      return "dropped";
  }
  return "?";
}

const char* stage_name(CaptureStage stage) {
  constexpr const char* kNames[kStageCount] = {"read", "network", "segment", "pose", "surface", "output"};
  const int index = static_cast<int>(stage);
  return index >= 0 && index < kStageCount ? kNames[index] : "?";
}

void MethodOptions::validate() const {
  if (actor.empty()) throw ConfigError("--actor is missing: an actor.glb or builtin:skirt, builtin:trousers");
  if (height_mm != 0 && !kActorHeightMm.contains(height_mm))
    throw ConfigError(format("--height %g m: must be between 0.5 and 3 metres", height_mm / 1000));
  if (rigidity != 0 && !(rigidity > 0 && rigidity <= 1e6))
    throw ConfigError(format("--rigidity %g: must be between 0 and 1e6; the labels' are 1 to 200", rigidity));
  for (const std::string& name : without) require_component(name);
}

void CaptureOptions::validate() const {
  if (video.empty()) throw ConfigError("--video is missing: a video file, a folder of images or webcam:N");
  MethodOptions::validate();
  if (out.empty()) throw ConfigError("--out is missing: the folder to write");
  if (const auto folder = std::filesystem::path(trace).parent_path();
      !folder.empty() && !std::filesystem::is_directory(folder))
    throw ConfigError("--trace " + trace + ": there is no such folder");
  if (camera.empty() == (fov_deg == 0)) throw ConfigError("give either --camera FILE or --fov DEGREES");
  if (fov_deg != 0) require_within("--fov", fov_deg, kFovDeg, "degrees");
  if (!background.empty() && background_frames > 0)
    throw ConfigError("give either --background or --background-frames, not both");
  if (background_frames < 0)
    throw ConfigError(format("--background-frames %d: must not be negative", background_frames));
  if (first < 0) throw ConfigError(format("--first %lld: must not be negative", static_cast<long long>(first)));
  if (frames == 0 || frames < -1) throw ConfigError("--frames: must be at least 1");
  if (learn_frames < 0)
    throw ConfigError(format("--learn-frames %lld: must not be negative", static_cast<long long>(learn_frames)));
  if (!detections.empty() && background.empty() && background_frames == 0)
    throw ConfigError(
        "--detections needs --background or --background-frames: without the network there is no person mask");
  if (!(missed_detections >= 0 && missed_detections <= 1))
    throw ConfigError(format("--miss-detections %g: must be between 0 and 1", missed_detections));
  if (draw < 0 || draw > 99) throw ConfigError(format("--draw %d: must be between 0 and 99", draw));
  if (draw > 0 && !detections.empty())
    throw ConfigError("--draw is of the network's detections: not with --detections, which are as they are");
  if (sequential && realtime) throw ConfigError("--sequential and --pace realtime exclude each other");
  if (decoded && is_webcam(video))
    throw ConfigError(video + ": frames of a webcam cannot be decoded before it is captured");
  if (!(bvh_unit_m > 0) || !std::isfinite(bvh_unit_m))
    throw ConfigError("--bvh-unit: must be a positive length in metres");
}

}  // namespace livecap
