// Everything of the pipeline between a picture that has been read and the result that is published, over the two
// devices of a run.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "actor/actor.h"
#include "capture/detection_source.h"
#include "capture/pipeline.h"
#include "image/background_model.h"
#include "livecap/camera.h"
#include "livecap/method.h"
#include "ocl/device.h"

namespace livecap {

// Who is captured, and the GLB that it came from.
struct CapturedActor {
  Actor actor;
  std::string glb;
};

// Throws IoError, ConfigError (see load_actor, make_builtin_actor_glb).
CapturedActor load_captured_actor(const MethodOptions& options);

class CaptureEngine {
 public:
  // camera: undistorted. Builds every program, allocates every buffer and launches every kernel once. actor must
  // outlive the engine. Throws ConfigError, IoError, OclError.
  CaptureEngine(const MethodOptions& options, const DetectionOptions& detections, const ocl::DevicePair& devices,
                const Actor& actor, const Camera& camera, const BackgroundModel& background);
  ~CaptureEngine();

  // All but read and publish, which are the caller's. The engine must outlive them.
  PipelineStages stages();

  // After the stages have ended: as if no frame had come, but with what was learned of the room, the light and the
  // person.
  void start_over();

  // How many frames should be under way at once where older ones are dropped (see run_pipelined()): those that wait for
  // later poses, as many as there are threads to work on them, and one more. Others would add to the delay alone.
  int most_under_way() const;

  // What the person stands on, as of the last pose: as given, or learned. nullopt while it is not known, or cannot be.
  // Not beside the stages.
  std::optional<FloorPlane> floor() const;

  // Device buffers made since the constructor, by anybody.
  int64_t buffers_made() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace livecap
