#include "fit/fit_actor.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "actor/bone_names.h"
#include "actor/height_range.h"
#include "actor/keypoint_offsets.h"
#include "base/fov_range.h"
#include "base/text.h"
#include "livecap/error.h"
#include "meshing/atlas.h"
#include "synth/actor_model.h"
#include "synth/synth.h"

namespace livecap {

namespace {

using Eigen::Vector3d;

constexpr int kRounds = 2;  // of posing and fitting
constexpr int kLeastPosed = 3;
constexpr double kLargeScale = 1.5;  // of a proportion: rather a mistake than a person

// The bone of LiveCap-32 that each of the rig's bones belongs to.
int livecap_bone(const std::string& name) {
  static const std::pair<const char*, int> table[] = {{"Spine2", kRigChest},
                                                      {"Neck", kRigNeck},
                                                      {"Head", kRigNeck},
                                                      {"LeftShoulder", kRigLeftClavicle},
                                                      {"LeftArm", kRigLeftShoulder},
                                                      {"LeftForeArm", kRigLeftElbow},
                                                      {"LeftHand", kRigLeftElbow},
                                                      {"RightShoulder", kRigRightClavicle},
                                                      {"RightArm", kRigRightShoulder},
                                                      {"RightForeArm", kRigRightElbow},
                                                      {"RightHand", kRigRightElbow},
                                                      {"LeftUpLeg", kRigLeftHip},
                                                      {"LeftLeg", kRigLeftKnee},
                                                      {"LeftFoot", kRigLeftAnkle},
                                                      {"LeftToeBase", kRigLeftAnkle},
                                                      {"RightUpLeg", kRigRightHip},
                                                      {"RightLeg", kRigRightKnee},
                                                      {"RightFoot", kRigRightAnkle},
                                                      {"RightToeBase", kRigRightAnkle}};
  for (const auto& [known, bone] : table)
    if (name == known) return bone;
  return kRigRoot;
}

// The file as the tracker sees it.
Actor load(const meshing::ActorFile& file) {
  Actor actor = load_actor_bytes(meshing::actor_glb(file), "builtin:" + file.name);
  if (actor.n_vertices() != static_cast<int>(file.surface.vertices.size()))
    throw LogicError("actor fit: the built-in actor's vertices were welded");
  use_mediapipe_anchors(actor);
  return actor;
}

// The file with these proportions, soles on the floor, of this height. Returns the scale that took.
double reshape(const Actor& actor, const Proportions& proportions, double height_mm, meshing::ActorFile& file) {
  const Reshaper reshaper(actor);
  const Shape shape = reshaper.shape(proportions);
  double top = -1e9, bottom = 1e9;
  for (int i = 0; i < actor.n_vertices(); ++i) {
    file.surface.vertices[i] = reshaper.vertex(shape, i);
    top = std::max(top, file.surface.vertices[i].y()), bottom = std::min(bottom, file.surface.vertices[i].y());
  }
  for (meshing::RigBone& bone : file.bones)
    bone.position_mm = reshaper.attached(shape, livecap_bone(bone.name), bone.position_mm);
  const double scale = height_mm / (top - bottom);
  for (Vector3d& p : file.surface.vertices) p = scale * (p - Vector3d(0, bottom, 0));
  for (meshing::RigBone& bone : file.bones) bone.position_mm = scale * (bone.position_mm - Vector3d(0, bottom, 0));
  return scale;
}

int pose_all(FramePoser& poser, std::vector<FitFrame>& frames, const std::string& stage, const FitProgress& progress) {
  int n_posed = 0, done = 0;
  for (FitFrame& frame : frames) {
    poser.solve(frame);
    n_posed += frame.posed;
    if (progress && !progress(stage, ++done, static_cast<int>(frames.size()))) throw Error("interrupted");
  }
  return n_posed;
}

// Mean over the frames that count in both comparisons.
double mean_overlap(FramePoser& poser, const std::vector<FitFrame>& frames, const std::vector<char>& counts) {
  double sum = 0;
  int n = 0;
  for (size_t i = 0; i < frames.size(); ++i)
    if (counts[i] && frames[i].posed) sum += poser.overlap(frames[i]), ++n;
  return n > 0 ? sum / n : 0;
}

}  // namespace

void FitActorOptions::validate() const {
  if (video.empty()) throw ConfigError("actor fit: --video is needed");
  if (camera.empty() == (fov_deg == 0)) throw ConfigError("actor fit: give either --camera or --fov");
  if (fov_deg != 0) require_within("--fov", fov_deg, kFovDeg, "degrees");
  if (!background.empty() && background_frames > 0)
    throw ConfigError("actor fit: give either --background or --background-frames");
  if (background_frames < 0)
    throw ConfigError(format("--background-frames %d: must not be negative", background_frames));
  synth::outfit_from_name(actor);
  require_person_height(height_mm);
  if (max_frames < 1) throw ConfigError(format("--frames is %d; it must be positive", max_frames));
  require_within("--fit-frames", n_frames, kFitFrames);
}

FitResult fit_actor(ocl::DeviceContext& device, FitFootage footage, const FitActorOptions& options,
                    const FitProgress& progress) {
  FitResult result;
  result.n_looked_at = footage.n_looked_at;
  result.n_seen = footage.n_seen;
  result.notes = std::move(footage.notes);
  const double height_mm = options.height_mm > 0 ? options.height_mm : kBuiltinHeightMm;
  if (options.height_mm <= 0)
    result.notes.push_back(
        format("one camera does not tell how tall somebody is: %.2f m is assumed (--height)", height_mm / 1000));
  std::vector<FitFrame>& frames = footage.frames;
  result.actor = synth::actor_file(synth::build_actor(options.actor, height_mm, 5000));
  auto actor = std::make_unique<Actor>(load(result.actor));
  auto poser = std::make_unique<FramePoser>(device, *actor, footage.camera);
  result.n_used = pose_all(*poser, frames, "poses", progress);
  if (result.n_used < kLeastPosed)
    throw ConfigError(options.video + format(": the pose can be told in %d of %zu frames; at least %d are needed",
                                             result.n_used, frames.size(), kLeastPosed));
  std::vector<char> posed_before;
  for (const FitFrame& frame : frames) posed_before.push_back(frame.posed);
  const auto before = std::make_pair(std::move(actor), std::move(poser));
  std::vector<Pose> poses_before;
  for (const FitFrame& frame : frames) poses_before.push_back(frame.pose);
  Proportions total = Proportions::Zero();
  FramePoser* current = before.second.get();
  const Actor* shaped = before.first.get();
  for (int round = 0; round < kRounds; ++round) {
    const Proportions found = fit_proportions(*current, *shaped, footage.camera, frames);
    const double scale = reshape(*shaped, found, height_mm, result.actor);
    total += found + Proportions::Constant(std::log(scale));
    poser.reset();
    actor = std::make_unique<Actor>(load(result.actor));
    poser = std::make_unique<FramePoser>(device, *actor, footage.camera);
    current = poser.get(), shaped = actor.get();
    pose_all(*current, frames, format("poses, round %d", round + 2), progress);
  }
  std::vector<char> counts(frames.size());
  for (size_t i = 0; i < frames.size(); ++i) counts[i] = posed_before[i] && frames[i].posed;
  result.n_used = static_cast<int>(std::count(counts.begin(), counts.end(), 1));
  if (result.n_used < kLeastPosed)
    throw ConfigError(options.video +
                      ": the fitted actor's pose cannot be told any more; is it one person, seen whole?");
  result.overlap_after = mean_overlap(*current, frames, counts);

  const std::vector<Vector3d> colors = colors_from_frames(*current, result.actor.surface, frames, result.seen_share);
  const meshing::Surface& surface = result.actor.surface;
  result.actor.texture = meshing::bake_texture(
      surface, result.actor.atlas, result.actor.texture.width, [&](const meshing::SurfacePoint& point) {
        const auto& [a, b, c] = point.weights;
        const auto& t = surface.triangles[point.triangle];
        return Vector3d(a * colors[t[0]] + b * colors[t[1]] + c * colors[t[2]]);
      });
  if (result.seen_share < 0.55)
    result.notes.push_back(
        format("only %.0f %% of the surface is seen; the rest has the colours of the other side or of "
               "what is near: let the person turn around once",
               100 * result.seen_share));
  for (size_t i = 0; i < frames.size(); ++i) std::swap(frames[i].pose, poses_before[i]);
  for (size_t i = 0; i < frames.size(); ++i) frames[i].posed = counts[i];
  result.overlap_before = mean_overlap(*before.second, frames, counts);
  for (int k = 0; k < kProportionCount; ++k) {
    result.scales[k] = std::exp(total[k]);
    if (result.scales[k] > kLargeScale || result.scales[k] < 1 / kLargeScale)
      result.notes.push_back(
          format("%s changed by %+.0f %%: look whether that is so", kProportionNames[k], 100 * (result.scales[k] - 1)));
  }
  if (result.overlap_after < result.overlap_before)
    result.notes.push_back(format("the fitted actor covers the person less well than the built-in one (%.3f, %.3f)",
                                  result.overlap_after, result.overlap_before));
  return result;
}

}  // namespace livecap
