// actor fit on footage whose every part is known: the people are reshaped, posed and rendered by the code of the
// synthetic sequences, which shares none of that with the fit.
#include "fit/fit_actor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "actor/keypoint_offsets.h"
#include "livecap/error.h"
#include "support/test_device.h"
#include "support/tolerances.h"
#include "synth/actor_model.h"
#include "synth/motion.h"
#include "synth/renderer.h"

namespace livecap {
namespace {

using Eigen::Vector3d;

// The rig's bone that carries each observation keypoint.
int rig_bone(int keypoint) {
  switch (keypoint) {
    case kNeck:
    case kLeftShoulder:
    case kRightShoulder:
      return synth::kSpine2;
    case kPelvis:
    case kLeftHip:
    case kRightHip:
      return synth::kHips;
    case kLeftElbow:
      return synth::kLeftArm;
    case kRightElbow:
      return synth::kRightArm;
    case kLeftWrist:
    case kLeftHand:
      return synth::kLeftForeArm;
    case kRightWrist:
    case kRightHand:
      return synth::kRightForeArm;
    case kLeftKnee:
      return synth::kLeftUpLeg;
    case kRightKnee:
      return synth::kRightUpLeg;
    case kLeftAnkle:
    case kLeftToe:
      return synth::kLeftFoot;
    case kRightAnkle:
    case kRightToe:
      return synth::kRightFoot;
    default:
      return synth::kHead;
  }
}

// A person of 1.7 m with other proportions and colours, filmed for some frames of a motion.
struct Film {
  synth::ActorModel person;
  Actor actor;  // the same as the tracker sees it
  FitFootage footage;
};

Film film(const Physique& physique, int n_frames) {
  Film film;
  film.person = synth::build_actor("trousers", kBuiltinHeightMm, 5000);
  synth::apply_physique(physique, film.person);
  for (size_t i = 0; i < film.person.texture.pixels.size(); i += 3)
    std::swap(film.person.texture.pixels[i], film.person.texture.pixels[i + 2]);  // red and blue exchanged
  film.actor = load_actor_bytes(synth::actor_glb(film.person), "person");
  Actor anchors = film.actor;
  use_mediapipe_anchors(anchors);

  synth::View view;
  view.camera = camera_from_fov(270, 480, 44);
  const Vector3d eye(0, 1250, 3600), forward = (Vector3d(0, 950, 0) - eye).normalized();
  const Vector3d right = forward.cross(Vector3d::UnitY()).normalized();
  view.camera_from_room_rotation << right.transpose(), forward.cross(right).transpose(), forward.transpose();
  view.camera_from_room_translation = -view.camera_from_room_rotation * eye;
  film.footage.camera = view.camera;
  const auto postures = synth::make_motion({"raise", "turn", "squat"}, 30);
  for (int i = 0; i < n_frames; ++i) {
    const auto& posture = postures[static_cast<size_t>(i) * postures.size() / n_frames];
    const synth::BonePose pose = synth::pose_of(posture, film.person.joints, film.person.scale);
    const auto vertices =
        synth::skin_vertices(film.person.surface.vertices, film.person.weights, film.person.joints, pose);
    const synth::PersonLayer layer = synth::render_person(view, {}, film.person, vertices);
    FitFrame frame;
    frame.index = i;
    const int w = view.camera.width, h = view.camera.height;
    frame.mask = {w, h, std::vector<uint8_t>(layer.covered.size())};
    std::vector<synth::Color> linear(layer.covered.size());
    for (size_t p = 0; p < linear.size(); ++p) {
      const float share = static_cast<float>(layer.covered[p]) / synth::kSamples;
      linear[p] = layer.color[p] / synth::kSamples + (1 - share) * synth::Color::Constant(0.4f);
      frame.mask.pixels[p] = 2 * layer.covered[p] >= synth::kSamples ? 255 : 0;
    }
    frame.image = synth::expose(linear, w, h, {0.4, 1, 1, static_cast<uint64_t>(i)});
    frame.silhouette = make_silhouette(frame.mask);
    frame.detections.person = true;
    frame.detections.score = 1;
    std::array<Vector3d, kKeypointCount> points;
    for (int k = 0; k < kKeypointCount; ++k) {
      const int bone = rig_bone(k);
      points[k] = view.to_camera(pose.origins[bone] + pose.rotations[bone] * (anchors.keypoints[k].rest_position_mm -
                                                                              film.person.joints[bone]));
    }
    const Vector3d pelvis = points[kPelvis];
    for (int k = 0; k < kKeypointCount; ++k) {
      KeypointDetection& seen = frame.detections.keypoints[k];
      const Vector3d& p = points[k];
      seen.x_px = static_cast<float>(view.camera.fx * p.x() / p.z() + view.camera.cx + 1.5 * std::sin(7 * i + 3 * k));
      seen.y_px = static_cast<float>(view.camera.fy * p.y() / p.z() + view.camera.cy + 1.5 * std::cos(5 * i + 4 * k));
      seen.x_mm = static_cast<float>(p.x() - pelvis.x());
      seen.y_mm = static_cast<float>(p.y() - pelvis.y());
      seen.z_mm = static_cast<float>(p.z() - pelvis.z());
      seen.confidence = 0.9f;
    }
    film.footage.frames.push_back(std::move(frame));
  }
  film.footage.n_looked_at = film.footage.n_seen = n_frames;
  return film;
}

// The built-in actor itself.
const Film& plain_film() {
  static const Film plain = film({}, 8);
  return plain;
}

FitActorOptions options() {
  FitActorOptions options;
  options.video = "film";
  options.fov_deg = 44;
  return options;
}

// Mean distance of the surface's vertices from those of the same number in another, after the centroids are matched.
double distance_mm(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b) {
  Vector3d shift = Vector3d::Zero();
  for (size_t i = 0; i < a.size(); ++i) shift += (b[i] - a[i]) / static_cast<double>(a.size());
  double sum = 0;
  for (size_t i = 0; i < a.size(); ++i) sum += (a[i] + shift - b[i]).norm();
  return sum / static_cast<double>(a.size());
}

TEST(FitActor, FindsProportionsAndColoursOfAnotherPerson) {
  const Film film = livecap::film({1.1, 0.9, 0.95, 1.08, 1.12}, 14);
  const synth::ActorModel plain = synth::build_actor("trousers", kBuiltinHeightMm, 5000);
  ocl::DeviceContext device(ocl::select_device(test::device_selectors().front()));
  const FitResult result = fit_actor(device, film.footage, options());

  EXPECT_GE(result.n_used, 11);
  EXPECT_GT(result.overlap_after, test::kFittedOverlap);
  EXPECT_LT(1 - result.overlap_after, test::kFittedShare * (1 - result.overlap_before));
  const double before = distance_mm(plain.surface.vertices, film.person.surface.vertices);
  const double after = distance_mm(result.actor.surface.vertices, film.person.surface.vertices);
  EXPECT_LT(after, test::kFittedShare * before) << before;
  double worst = 0;
  for (int bone : {synth::kLeftArm, synth::kLeftForeArm, synth::kLeftHand, synth::kRightHand, synth::kLeftLeg,
                   synth::kLeftFoot, synth::kRightFoot}) {
    const int parent = synth::kBones[bone].parent;
    const auto length = [&](const auto& at) { return (at(bone) - at(parent)).norm(); };
    const double truth = length([&](int b) { return film.person.joints[b]; });
    worst = std::max(worst, std::abs(length([&](int b) { return result.actor.bones[b].position_mm; }) / truth - 1));
  }
  EXPECT_LT(worst, test::kFittedBoneLength);

  // Left and right are alike, the file can be read, and its height is what was asked for.
  const Actor fitted = load_actor_bytes(meshing::actor_glb(result.actor), "fitted");
  ASSERT_EQ(fitted.n_vertices(), film.actor.n_vertices());
  float top = 0;
  for (size_t i = 1; i < fitted.mesh.positions.size(); i += 3) top = std::max(top, fitted.mesh.positions[i]);
  EXPECT_NEAR(top, kBuiltinHeightMm, 1);
  EXPECT_NEAR(
      (result.actor.bones[synth::kLeftLeg].position_mm - result.actor.bones[synth::kLeftUpLeg].position_mm).norm(),
      (result.actor.bones[synth::kRightLeg].position_mm - result.actor.bones[synth::kRightUpLeg].position_mm).norm(),
      test::kMillimetreFloat);

  // Colours: those of the person, not of the built-in actor (light makes them darker, so the channels' order counts).
  int n_right = 0, n_colored = 0;
  for (int i = 0; i < fitted.n_vertices(); ++i) {
    const float* truth = &film.actor.colors[3 * static_cast<size_t>(i)];
    const float* found = &fitted.colors[3 * static_cast<size_t>(i)];
    if (std::abs(truth[0] - truth[2]) < 0.15f) continue;
    ++n_colored;
    n_right += (truth[0] > truth[2]) == (found[0] > found[2]);
  }
  EXPECT_GT(n_right, test::kRightColors * n_colored) << n_colored;
}

TEST(FitActor, LeavesTheBuiltInActorAsItIs) {
  const Film& film = plain_film();
  ocl::DeviceContext device(ocl::select_device(test::device_selectors().front()));
  const FitResult result = fit_actor(device, film.footage, options());
  EXPECT_LT(distance_mm(result.actor.surface.vertices, film.person.surface.vertices), test::kUnchangedActorMm);
  EXPECT_FALSE(result.notes.empty());  // the height was assumed
}

TEST(FitActor, RefusesFootageOfNobody) {
  FitFootage footage = plain_film().footage;
  for (FitFrame& frame : footage.frames) frame.detections.person = false;
  ocl::DeviceContext device(ocl::select_device(test::device_selectors().front()));
  EXPECT_THROW(fit_actor(device, footage, options()), ConfigError);
}

TEST(FitActor, RefusesImpossibleOptions) {
  const auto refused = [](auto&& change) {
    FitActorOptions changed = options();
    change(changed);
    EXPECT_THROW(changed.validate(), ConfigError);
  };
  options().validate();
  refused([](FitActorOptions& o) { o.video.clear(); });
  refused([](FitActorOptions& o) { o.camera = "camera.json"; });
  refused([](FitActorOptions& o) { o.fov_deg = 0; });
  refused([](FitActorOptions& o) { o.fov_deg = -3; });
  refused([](FitActorOptions& o) { o.actor = "nobody"; });
  refused([](FitActorOptions& o) { o.height_mm = 9000; });
  refused([](FitActorOptions& o) { o.background = "a.png", o.background_frames = 3; });
  refused([](FitActorOptions& o) { o.background_frames = -1; });
  refused([](FitActorOptions& o) { o.n_frames = 2; });
}

}  // namespace
}  // namespace livecap
