#include "synth/actor_model.h"

#include "actor/height_range.h"
#include "base/text.h"
#include "livecap/error.h"
#include "meshing/nearest_vertex.h"
#include "synth/paint.h"
#include "synth/synth.h"

namespace livecap {

const std::vector<std::string>& builtin_actor_names() {
  static const std::vector<std::string> names = {"skirt", "trousers"};
  return names;
}

std::string make_builtin_actor_glb(const std::string& name, double height_mm, int target_vertices) {
  return synth::actor_glb(synth::build_actor(name, height_mm, target_vertices));
}

namespace synth {

namespace {

constexpr int kTextureSize = 1024;
constexpr double kGridStep = 15;  // mm

// Charts are kept apart by these groups: head, top, arms, bottom, legs, shoes.
constexpr int kGroupOfPart[kPartCount] = {0, 0, 0, 1, 2, 2, 3, 4, 5};
const std::vector<double> kGroupDensity = {2.4, 1.0, 1.0, 1.0, 0.8, 1.0};

}  // namespace

ActorModel build_actor(const std::string& name, double height_mm, int target_vertices) {
  const BodyShape shape(outfit_from_name(name));
  if (!(kActorHeightMm.contains(height_mm)))
    throw ConfigError(format("--height %g m: must be between 0.5 and 3 metres", height_mm / 1000));
  if (target_vertices < 1000 || target_vertices > 60000)
    throw ConfigError(format("target_vertices is %d; it must be within 1000..60000", target_vertices));

  const meshing::DistanceField field = [&](const Vec3& p) { return shape.distance(p); };
  const double density = std::sqrt(5000.0 / target_vertices);
  const Surface fine = meshing::extract_surface(field, {-850, -30, -330}, {850, 1740, 330},
                                                std::min(kGridStep * density, 1.15 * kGridStep));
  ActorModel actor;
  actor.name = name;
  actor.surface = meshing::decimate_surface(fine, target_vertices, 48 * density, field);

  const auto& vertices = actor.surface.vertices;
  for (const Vec3& p : vertices) {
    actor.parts.push_back(shape.part(p));
    actor.labels.push_back(static_cast<uint8_t>(shape.label(actor.parts.back(), p)));
  }
  actor.weights = make_skin_weights(shape, actor.surface, actor.parts);

  std::vector<int> group;
  for (const auto& t : actor.surface.triangles)
    group.push_back(kGroupOfPart[shape.part((vertices[t[0]] + vertices[t[1]] + vertices[t[2]]) / 3)]);
  actor.atlas = meshing::make_atlas(actor.surface, group, kGroupDensity, kTextureSize);
  actor.texture = meshing::bake_texture(
      actor.surface, actor.atlas, kTextureSize,
      [&](const meshing::SurfacePoint& point) { return paint(shape, shape.part(point.position), point.position); });

  const FaceFeatures features = face_features(shape);
  actor.left_eye = meshing::nearest_vertex(actor.surface, features.left_eye);
  actor.right_eye = meshing::nearest_vertex(actor.surface, features.right_eye);
  actor.nose = meshing::nearest_vertex(actor.surface, features.nose);
  actor.chin = meshing::nearest_vertex(actor.surface, features.chin);

  double top = 0, bottom = 0;
  for (const Vec3& p : vertices) top = std::max(top, p.y()), bottom = std::min(bottom, p.y());
  actor.scale = height_mm / (top - bottom);
  for (Vec3& p : actor.surface.vertices) p = actor.scale * (p - Vec3(0, bottom, 0));
  for (int bone = 0; bone < kBoneCount; ++bone)
    actor.joints[bone] = actor.scale * (shape.joints()[bone] - Vec3(0, bottom, 0));
  return actor;
}

meshing::ActorFile actor_file(const ActorModel& actor) {
  meshing::ActorFile file{actor.name, actor.surface, {}, actor.weights, actor.labels, actor.atlas, actor.texture, {}};
  for (int bone = 0; bone < kBoneCount; ++bone)
    file.bones.push_back({kBones[bone].name, kBones[bone].parent, actor.joints[bone]});
  file.markers = {
      {"left_eye", actor.left_eye}, {"right_eye", actor.right_eye}, {"nose", actor.nose}, {"chin", actor.chin}};
  return file;
}

std::string actor_glb(const ActorModel& actor) {
  return meshing::actor_glb(actor_file(actor));
}

}  // namespace synth
}  // namespace livecap
