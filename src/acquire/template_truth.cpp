#include "acquire/template_truth.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <nlohmann/json.hpp>

#include "actor/posed_vertices.h"
#include "base/joined.h"
#include "base/text.h"
#include "export/export_frame.h"
#include "export/pc2.h"
#include "livecap/error.h"

namespace livecap::acquire {

namespace {

using Eigen::Vector3d;

constexpr int kMostFrames = 100000;  // an hour and a half at 20 frames a second

SkeletoolCamera chosen_camera(const MotionFiles& files) {
  const std::vector<SkeletoolCamera> cameras = load_skeletool_cameras(files.cameras);
  std::vector<std::string> names;
  for (const SkeletoolCamera& camera : cameras) {
    if (camera.name == files.camera) return camera;
    names.push_back(camera.name);
  }
  if (files.camera.empty() && cameras.size() == 1) return cameras[0];
  throw ConfigError((files.camera.empty() ? "--camera: name one of " : "--camera " + files.camera + ": not one of ") +
                    files.cameras.string() + "'s: " + joined(names));
}

// The imported vertex that each vertex of the loaded template is: loading welds those that are equal in floats.
std::vector<int> imported_vertices(const ImportedTemplate& imported, const Actor& actor) {
  std::vector<int> source(actor.n_vertices(), -1);
  for (size_t i = 0; i < actor.render.template_vertex.size(); ++i)
    if (int& vertex = source[actor.render.template_vertex[i]]; vertex < 0) vertex = imported.actor.atlas.vertex[i];
  return source;
}

// The skeleton's pose in one frame of the motion, camera frame.
Pose camera_pose(const ImportedTemplate& imported, const TemplateMotion& motion, size_t index) {
  Pose pose = imported.skeleton.pose(motion.motion.parameters[index]);
  if (!motion.camera) return pose;
  pose.root_rotation = motion.camera->camera_from_world.linear() * pose.root_rotation;
  pose.root_translation_mm = motion.camera->camera_from_world * pose.root_translation_mm;
  return pose;
}

bool is_outside(const Vector3d& p, const std::optional<SkeletoolCamera>& view) {
  if (p.z() <= 0 || !view) return p.z() <= 0;
  const Camera& camera = view->camera;
  const double x = camera.cx + camera.fx * p.x() / p.z(), y = camera.cy + camera.fy * p.y() / p.z();
  return x < 0 || y < 0 || x > camera.width - 1 || y > camera.height - 1;
}

nlohmann::json joints_row(const PosedSkeleton& posed, const RigBones& rig) {
  constexpr double kPerMetre = 1e6;  // a micrometre is enough
  nlohmann::json row = nlohmann::json::array();
  for (int bone : rig) {
    if (bone < 0) continue;
    const Vector3d p = gltf_from_camera(Vector3d(posed.camera_from_bone[bone].translation()));
    row.push_back({std::round(p.x() * kPerMetre) / kPerMetre, std::round(p.y() * kPerMetre) / kPerMetre,
                   std::round(p.z() * kPerMetre) / kPerMetre});
  }
  return row;
}

}  // namespace

TemplateMotion read_template_motion(const MotionFiles& files, const SkeletoolSkeleton& skeleton) {
  TemplateMotion result;
  result.motion = load_skeletool_motion(files.motion, skeleton.n_parameters());
  if (!files.cameras.empty()) result.camera = chosen_camera(files);
  const int own_first = result.motion.frames.front(), last = result.motion.frames.back();
  result.first = files.first < 0 ? own_first : files.first;
  if (result.first > last)
    throw ConfigError(format("--first %d: ", result.first) + files.motion.string() +
                      format(" has frames %d to %d", own_first, last));
  if (last - result.first >= kMostFrames)
    throw IoError(files.motion.string() + format(": ends at frame %d, %d behind the first; at most %d frames", last,
                                                 last - result.first, kMostFrames));
  result.n_frames = last - result.first + 1;
  return result;
}

std::vector<std::filesystem::path> template_truth_files(const std::filesystem::path& folder,
                                                        const TemplateMotion& motion) {
  std::vector<std::filesystem::path> files = {folder / "joints.json", folder / "vertices.pc2"};
  if (motion.camera) files.push_back(folder / "camera.json");
  return files;
}

TruthSummary write_template_truth(const ImportedTemplate& imported, const Actor& actor, const TemplateMotion& motion,
                                  const std::filesystem::path& folder,
                                  const std::function<bool(int done, int total)>& progress) {
  const std::vector<int> source = imported_vertices(imported, actor);
  const Eigen::Isometry3d world_from_rest = imported.rest_from_world.inverse();
  std::vector<Vector3d> bound;  // where the skin binds them
  for (int vertex : source) bound.push_back(world_from_rest * imported.actor.surface.vertices[vertex]);

  nlohmann::json joints;
  for (int joint = 0; joint < kRigJointCount; ++joint)
    if (imported.rig[joint] >= 0) joints["names"].push_back(kRigJointNames[joint]);
  Pc2Writer vertices(folder / "vertices.pc2", actor.n_vertices());
  TruthSummary summary;
  size_t next = 0;
  while (motion.motion.frames[next] < motion.first) ++next;
  for (int frame = 0; frame < motion.n_frames; ++frame) {
    if (progress && !progress(frame, motion.n_frames)) throw Error("interrupted while writing the truth");
    std::vector<float> points(3 * source.size(), std::numeric_limits<float>::quiet_NaN());
    if (motion.motion.frames[next] != motion.first + frame) {
      joints["frames"].push_back(nullptr);
      vertices.append(points);
      continue;
    }
    const PosedSkeleton posed = forward_kinematics(imported.skeleton.skeleton, camera_pose(imported, motion, next++));
    joints["frames"].push_back(joints_row(posed, imported.rig));
    const std::vector<float> dual_quats = bone_dual_quats(posed);
    for (size_t i = 0; i < source.size(); ++i)
      Eigen::Vector3f::Map(&points[3 * i]) =
          gltf_from_camera(posed_point(dual_quats, imported.skin, source[i], bound[i])).cast<float>();
    vertices.append(points);
    ++summary.n_known;
    summary.n_outside += is_outside(posed.camera_from_bone[imported.rig[kRigRoot]].translation(), motion.camera);
  }
  write_file_atomically(folder / "joints.json", joints.dump());
  if (motion.camera) save_camera(motion.camera->camera, folder / "camera.json");
  return summary;
}

}  // namespace livecap::acquire
