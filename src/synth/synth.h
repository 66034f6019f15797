// The project's own actors and ground-truth sequences (docs/formats.md).
//
// Everything here is made by code the tracker does not share: its own signed-distance body, skinning, cloth, camera
// placement and rasteriser, so that a mistake in the tracker cannot hide in its test data. Same options, same bytes.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace livecap {

inline constexpr double kBuiltinHeightMm = 1700;  // sole to top of the hair

// "skirt" (striped top, checked skirt) and "trousers" (patterned t-shirt, denim).
const std::vector<std::string>& builtin_actor_names();

// The bytes of an actor.glb: one closed connected manifold surface in an A-pose, metres, Y up, +Z front, +X the
// subject's left; skin, texture, `_LABEL` and face markers included. height_mm in [500, 3000]; target_vertices in
// [1000, 60000] counts welded vertices. Throws ConfigError for an unknown name or a number out of range.
std::string make_builtin_actor_glb(const std::string& name, double height_mm = kBuiltinHeightMm,
                                   int target_vertices = 5000);

// What a sequence can be made of: walk, raise (arm raises), turn (360 degrees), squat, jacks (jumping jacks), dance,
// demo (a mix of them), and turntable (in rest pose on a turning plate, a little more than once around).
const std::vector<std::string>& motion_names();

// What can be made difficult in a sequence (docs/formats.md): none, leave, two-people, moving-shadow,
// similar-background, gap.
const std::vector<std::string>& scenario_names();

// Lengths and widths relative to the built-in actor's; the height stays.
struct Physique {
  double legs = 1;       // length of thighs and shanks
  double arms = 1;       // length of upper arms and forearms
  double trunk = 1;      // from hips to neck
  double shoulders = 1;  // width
  double girth = 1;      // of trunk and limbs

  void validate() const;  // throws ConfigError: each within 0.6..1.6
};

struct SynthOptions {
  std::string actor = "skirt";                  // one of builtin_actor_names()
  Physique physique;                            // of the first person
  double height_mm = kBuiltinHeightMm;          // of the actor
  std::vector<std::string> motions = {"demo"};  // played one after the other, see motion_names()
  double crouch_deg = 0;                        // thighs of the first person at rest, forwards; knees twice that
  std::string scenario = "none";                // see scenario_names()
  int width = 540;                              // px, even
  int height = 960;                             // px, even
  double fps = 30;
  int n_frames = 0;  // of the video, empty ones and those a gap leaves out included; 0 = until the motions end (once)
  int empty_frames = 10;           // at the start, nobody in the picture
  double fov_deg = 44;             // of the longer side
  double distance_mm = 3600;       // camera to the actor's place
  double camera_height_mm = 1250;  // above the floor
  double camera_roll_deg = 0.8;    // tilt of the horizon
  double noise = 1.6;              // sensor noise, standard deviation in 8-bit levels
  double gain_drift = 0.015;       // slow change of exposure, relative
  double blur_px = 0.45;           // standard deviation of the lens blur
  bool cloth = true;               // false: the surface is pure skinning
  bool floor = false;              // true: camera.json says where the floor is
  uint64_t seed = 1;               // of the noise and the room's texture

  // Throws ConfigError naming the option of `livecap synth`, or the field where there is none.
  void validate() const;
};

struct SynthReport {
  int n_frames = 0;
  int n_vertices = 0;        // welded
  double cloth_mean_mm = 0;  // distance of cloth vertices from the skinned surface, over frames with a person
  double cloth_p95_mm = 0;
  double render_ms_per_frame = 0;  // picture and mask, one core
};

// Called before each frame is rendered; return false to stop (the files written so far stay valid).
using SynthProgress = std::function<bool(int frame, int n_frames)>;

// Writes actor.glb, video.mp4, camera.json, background.png and truth/{vertices.pc2, joints.json, labels.npy, masks/}
// into `folder` (created when missing). The truth is the first person's; frames with nothing of them in the picture are
// NaN in vertices.pc2 and null in joints.json. Throws ConfigError for bad options, IoError when something cannot be
// written.
SynthReport write_sequence(const SynthOptions& options, const std::filesystem::path& folder,
                           const SynthProgress& progress = {});

}  // namespace livecap
