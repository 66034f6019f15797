#include "export/capture_glb.h"

#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <cmath>

#include "base/text.h"
#include "base/timer.h"
#include "export/motion_fixture.h"
#include "export/pc2.h"
#include "livecap/error.h"
#include "support/data_dir.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

// A viewer in a hundred lines: reads the file with tinygltf and evaluates animation, morph targets and linear skinning
// as glTF 2.0 section 3.7 says, sharing nothing with the writer.
class Viewer {
 public:
  explicit Viewer(const std::filesystem::path& path) {
    tinygltf::TinyGLTF loader;
    std::string error, warning;
    EXPECT_TRUE(loader.LoadBinaryFromFile(&model_, &error, &warning, path.string())) << error;
    EXPECT_EQ(error + warning, "");
  }

  const tinygltf::Model& model() const { return model_; }
  const tinygltf::Primitive& primitive() const { return model_.meshes[0].primitives[0]; }

  std::vector<double> values(int accessor_index) const {
    const auto& accessor = model_.accessors[accessor_index];
    const auto& view = model_.bufferViews[accessor.bufferView];
    const int n = tinygltf::GetNumComponentsInType(accessor.type);
    std::vector<double> result;
    for (size_t i = 0; i < accessor.count; ++i) {
      const unsigned char* at =
          model_.buffers[0].data.data() + view.byteOffset + accessor.byteOffset + i * accessor.ByteStride(view);
      for (int k = 0; k < n; ++k) {
        if (accessor.componentType == 5126)
          result.push_back(reinterpret_cast<const float*>(at)[k]);
        else if (accessor.componentType == 5125)
          result.push_back(reinterpret_cast<const uint32_t*>(at)[k]);
        else if (accessor.componentType == 5122)
          result.push_back(reinterpret_cast<const int16_t*>(at)[k] / 32767.0);
        else
          result.push_back(at[k]);
      }
    }
    return result;
  }

  int n_keys() const { return static_cast<int>(model_.accessors[model_.animations[0].samplers[0].input].count); }
  std::vector<double> times() const { return values(model_.animations[0].samplers[0].input); }

  // World positions of all render vertices at key `key`; key -1: the default pose.
  std::vector<Eigen::Vector3d> show(int key) const {
    std::vector<Eigen::Affine3d> local;
    for (const auto& node : model_.nodes) {
      Eigen::Affine3d m = Eigen::Affine3d::Identity();
      if (!node.translation.empty())
        m.translate(Eigen::Vector3d(node.translation[0], node.translation[1], node.translation[2]));
      if (!node.rotation.empty())
        m.rotate(Eigen::Quaterniond(node.rotation[3], node.rotation[0], node.rotation[1], node.rotation[2]));
      local.push_back(m);
    }
    std::vector<double> weights(primitive().targets.size(), 0.0);
    if (key >= 0) {
      for (const auto& channel : model_.animations[0].channels) {
        const auto& sampler = model_.animations[0].samplers[channel.sampler];
        const auto data = values(sampler.output);
        const size_t n = data.size() / n_keys();
        const double* at = data.data() + n * key;
        if (channel.target_path == "weights") weights.assign(at, at + n);
        if (channel.target_path == "translation")
          local[channel.target_node].translation() = Eigen::Vector3d(at[0], at[1], at[2]);
        if (channel.target_path == "rotation")
          local[channel.target_node].linear() = Eigen::Quaterniond(at[3], at[0], at[1], at[2]).toRotationMatrix();
      }
    }
    std::vector<int> parent(model_.nodes.size(), -1);
    for (size_t i = 0; i < model_.nodes.size(); ++i) {
      for (int child : model_.nodes[i].children) parent[child] = static_cast<int>(i);
    }
    const auto& skin = model_.skins[0];
    const auto inverse_bind = values(skin.inverseBindMatrices);
    std::vector<Eigen::Matrix4d> joint_matrices;
    for (size_t j = 0; j < skin.joints.size(); ++j) {
      Eigen::Affine3d world = Eigen::Affine3d::Identity();
      for (int i = skin.joints[j]; i >= 0; i = parent[i]) world = local[i] * world;
      joint_matrices.push_back(world.matrix() * Eigen::Map<const Eigen::Matrix4d>(inverse_bind.data() + 16 * j));
    }
    auto position = values(primitive().attributes.at("POSITION"));
    for (size_t t = 0; t < weights.size(); ++t) {
      if (weights[t] == 0) continue;
      const auto target = values(primitive().targets[t].at("POSITION"));
      for (size_t i = 0; i < position.size(); ++i) position[i] += weights[t] * target[i];
    }
    const auto joints = values(primitive().attributes.at("JOINTS_0"));
    const auto skin_weights = values(primitive().attributes.at("WEIGHTS_0"));
    std::vector<Eigen::Vector3d> result;
    for (size_t v = 0; v < position.size() / 3; ++v) {
      Eigen::Vector4d sum = Eigen::Vector4d::Zero();
      const Eigen::Vector4d p(position[3 * v], position[3 * v + 1], position[3 * v + 2], 1);
      for (int k = 0; k < 4; ++k)
        sum += skin_weights[4 * v + k] * (joint_matrices[static_cast<size_t>(joints[4 * v + k])] * p);
      result.push_back(sum.head<3>());
    }
    return result;
  }

 private:
  tinygltf::Model model_;
};

std::filesystem::path scratch(const char* name) {
  return std::filesystem::path(testing::TempDir()) / name;
}

// A captured surface: every bone carries its vertices rigidly by the strongest influence (not linear skinning), plus
// three travelling waves. Camera mm -> glTF metres by hand.
std::vector<std::vector<float>> wavy_surface(const Actor& actor, const std::vector<Pose>& poses) {
  std::vector<std::vector<float>> frames;
  for (size_t f = 0; f < poses.size(); ++f) {
    const PosedSkeleton posed = forward_kinematics(actor.skeleton, poses[f]);
    std::vector<float> xyz;
    for (int v = 0; v < actor.n_vertices(); ++v) {
      const Eigen::Vector3d rest =
          Eigen::Map<const Eigen::Vector3f>(actor.mesh.positions.data() + 3 * v).cast<double>();
      Eigen::Vector3d bent = rest;
      for (int wave = 1; wave <= 3; ++wave)
        bent += 20.0 / wave * std::sin(0.3 * wave * f + 0.01 * rest.y()) * Eigen::Vector3d(1, 0.2, -0.5);
      const Eigen::Vector3d p = posed.camera_from_rest[actor.skin.bones[4 * v]] * bent;
      for (double x : {p.x(), -p.y(), -p.z()}) xyz.push_back(static_cast<float>(x / 1000));
    }
    frames.push_back(xyz);
  }
  return frames;
}

std::vector<CapturedFrame> tracked(const std::vector<Pose>& poses) {
  std::vector<CapturedFrame> frames;
  for (const Pose& pose : poses) frames.push_back({true, pose});
  return frames;
}

FrameVertices from(const std::vector<std::vector<float>>& surface) {
  return [&surface](int frame, std::span<float> out) {
    std::copy(surface[frame].begin(), surface[frame].end(), out.begin());
  };
}

struct ShownError {
  double mean_mm = 0, max_mm = 0;
};

ShownError shown_error(const Viewer& viewer, const Actor& actor, const std::vector<int>& frames,
                       const std::vector<std::vector<float>>& surface) {
  ShownError error;
  size_t n = 0;
  for (size_t key = 0; key < frames.size(); ++key) {
    const auto shown = viewer.show(static_cast<int>(key));
    EXPECT_EQ(shown.size(), actor.render.template_vertex.size());
    for (size_t i = 0; i < shown.size(); ++i, ++n) {
      const float* truth = surface[frames[key]].data() + 3 * actor.render.template_vertex[i];
      const double mm = 1000 * (shown[i] - Eigen::Vector3d(truth[0], truth[1], truth[2])).norm();
      error.mean_mm += mm;
      error.max_mm = std::max(error.max_mm, mm);
    }
  }
  error.mean_mm /= static_cast<double>(n);
  return error;
}

TEST(CaptureGlb, AViewerShowsTheCapturedSurface) {
  const Actor actor = test::small_actor();
  const std::vector<Pose> poses = test::smooth_motion(actor.skeleton, 24);
  const auto surface = wavy_surface(actor, poses);
  const auto path = scratch("all.glb");
  const CaptureGlbReport report = write_capture_glb(path, actor, tracked(poses), from(surface));
  EXPECT_LE(report.n_morph_targets, 24);
  std::vector<int> keys(poses.size());
  for (size_t i = 0; i < keys.size(); ++i) keys[i] = static_cast<int>(i);
  const Viewer viewer(path);
  EXPECT_EQ(viewer.primitive().targets.size(), static_cast<size_t>(report.n_morph_targets));
  const ShownError error = shown_error(viewer, actor, keys, surface);
  EXPECT_LT(error.mean_mm, test::kMorphMeanMm);
  // The report must say what the viewer shows (it counts template vertices, the viewer counts seams twice).
  EXPECT_NEAR(error.max_mm, report.max_error_mm, test::kGlbReportMm);
}

// Blender cuts the weights of shape keys to [0, 1] and thereby shows a wrong surface when a file has others.
TEST(CaptureGlb, WeightsAreBetweenZeroAndOne) {
  const Actor actor = test::small_actor();
  const std::vector<Pose> poses = test::smooth_motion(actor.skeleton, 24);
  const auto surface = wavy_surface(actor, poses);
  const auto path = scratch("weights.glb");
  write_capture_glb(path, actor, tracked(poses), from(surface));
  const Viewer viewer(path);
  const auto& animation = viewer.model().animations[0];
  size_t n = 0;
  for (const auto& channel : animation.channels) {
    if (channel.target_path != "weights") continue;
    for (double w : viewer.values(animation.samplers[channel.sampler].output)) {
      EXPECT_GE(w, 0);
      EXPECT_LE(w, 1);
      ++n;
    }
  }
  EXPECT_EQ(n, viewer.primitive().targets.size() * poses.size());
}

TEST(CaptureGlb, FewerTargetsShowMoreErrorAndTheReportSaysSo) {
  const Actor actor = test::small_actor();
  const std::vector<Pose> poses = test::smooth_motion(actor.skeleton, 24);
  const auto surface = wavy_surface(actor, poses);
  CaptureGlbOptions options;
  double last = 1e9;
  for (int n : {0, 2, 4, 6}) {
    options.max_morph_targets = n;
    const auto path = scratch("few.glb");
    const CaptureGlbReport report = write_capture_glb(path, actor, tracked(poses), from(surface), options);
    EXPECT_EQ(report.n_morph_targets, n);
    EXPECT_LT(report.mean_error_mm, last);
    last = report.mean_error_mm;
    std::vector<int> keys(poses.size());
    for (size_t i = 0; i < keys.size(); ++i) keys[i] = static_cast<int>(i);
    EXPECT_NEAR(shown_error(Viewer(path), actor, keys, surface).max_mm, report.max_error_mm, test::kGlbReportMm);
  }
  EXPECT_GT(last, 0.1);  // so that the comparison above compares something
}

TEST(CaptureGlb, UntrackedFramesHaveNoKeysAndTimesFollowTheInput) {
  const Actor actor = test::small_actor();
  const std::vector<Pose> poses = test::smooth_motion(actor.skeleton, 8);
  auto surface = wavy_surface(actor, poses);
  std::vector<CapturedFrame> frames = tracked(poses);
  frames[0] = {false, {}};
  frames[3] = {false, {}};
  surface[0].assign(surface[0].size(), NAN);
  surface[5][7] = NAN;  // tracked, but its surface is not usable
  CaptureGlbOptions options;
  options.fps = 10;
  const auto pc2_path = scratch("vertices.pc2");
  Pc2Writer pc2(pc2_path, actor.n_vertices());
  for (const auto& xyz : surface) pc2.append(xyz);
  const auto path = scratch("gaps.glb");
  const CaptureGlbReport report = write_capture_glb(path, actor, frames, pc2_path, options);
  EXPECT_EQ(report.n_frames, 8);
  EXPECT_EQ(report.n_keys, 6);
  EXPECT_TRUE(std::isfinite(report.max_error_mm));
  const Viewer viewer(path);
  const std::vector<double> expected = {0.1, 0.2, 0.4, 0.5, 0.6, 0.7};
  const std::vector<double> times = viewer.times();
  ASSERT_EQ(times.size(), expected.size());
  for (size_t i = 0; i < times.size(); ++i) EXPECT_NEAR(times[i], expected[i], test::kCsvMetres);
  for (const Eigen::Vector3d& x : viewer.show(3)) ASSERT_TRUE(x.allFinite());
  frames.resize(9);
  EXPECT_THROW(write_capture_glb(path, actor, frames, pc2_path, options), IoError);
}

// The default pose of the file is the template itself, and the file is an actor again.
TEST(CaptureGlb, IsTheActorAtRestAndLoadsAsOne) {
  Actor actor = test::small_actor();
  actor.guessed_weights = actor.rough_shape = true;
  const std::vector<Pose> poses = test::smooth_motion(actor.skeleton, 4);
  const auto surface = wavy_surface(actor, poses);
  const auto path = scratch("again.glb");
  write_capture_glb(path, actor, tracked(poses), from(surface));
  const auto rest = Viewer(path).show(-1);
  for (size_t i = 0; i < rest.size(); ++i) {
    const Eigen::Vector3d p =
        Eigen::Map<const Eigen::Vector3f>(actor.mesh.positions.data() + 3 * actor.render.template_vertex[i])
            .cast<double>();
    EXPECT_LT((1000 * rest[i] - p).norm(), test::kMillimetreFloat);
  }
  const Actor again = load_actor(path);
  ASSERT_EQ(again.n_vertices(), actor.n_vertices());
  EXPECT_TRUE(again.guessed_weights && again.rough_shape);
  EXPECT_EQ(again.labels, actor.labels);
  EXPECT_EQ(again.mesh.triangles, actor.mesh.triangles);
  ASSERT_EQ(again.skeleton.n_dofs(), actor.skeleton.n_dofs());
  for (int k = 0; k < actor.skeleton.n_dofs(); ++k) {
    EXPECT_NEAR(again.skeleton.dofs[k].rest_rad, actor.skeleton.dofs[k].rest_rad, test::kDirectionFloat);
    EXPECT_NEAR(again.skeleton.dofs[k].max_rad, actor.skeleton.dofs[k].max_rad, test::kDirectionFloat);
  }
  for (int b = 0; b < actor.skeleton.n_bones(); ++b)
    EXPECT_LT((again.skeleton.bones[b].offset_mm - actor.skeleton.bones[b].offset_mm).norm(),
              2 * test::kMillimetreFloat);
}

// The chest of an actor whose trunk does not bend is a bone of the file that no skin follows.
TEST(CaptureGlb, AStiffTrunkComesBackStiff) {
  Actor actor = test::small_actor();
  const int chest = actor.skeleton.bone_index("chest");
  for (int& bone : actor.skin.bones) bone = bone == chest ? 0 : bone;
  std::erase_if(actor.skeleton.dofs, [&](const Dof& dof) { return dof.bone == chest; });
  const auto path = scratch("stiff.glb");
  write_capture_glb(path, actor, std::vector<CapturedFrame>(3), FrameVertices{});
  EXPECT_EQ(load_actor(path).skeleton.n_dofs(), actor.skeleton.n_dofs());
}

// Of a phone, say.
TEST(CaptureGlb, FramesThatDoNotComeEvenlyAreKeyedWhenTheyWereTaken) {
  const Actor actor = test::small_actor();
  const auto path = scratch("uneven.glb");
  std::vector<CapturedFrame> frames = tracked(test::smooth_motion(actor.skeleton, 3));
  frames[1].tracked = false;
  CaptureGlbOptions options;
  options.times_s = {0, 0.02, 0.5};
  write_capture_glb(path, actor, frames, FrameVertices{}, options);
  const tinygltf::Model model = Viewer(path).model();
  const tinygltf::Accessor& times = model.accessors[model.animations.at(0).samplers.at(0).input];
  EXPECT_EQ(times.count, 2u);
  EXPECT_FLOAT_EQ(static_cast<float>(times.minValues.at(0)), 0);
  EXPECT_FLOAT_EQ(static_cast<float>(times.maxValues.at(0)), 0.5f);
  options.times_s = {0, 0.5, 0.5};
  EXPECT_THROW(write_capture_glb(path, actor, frames, FrameVertices{}, options), ConfigError);
  options.times_s = {0, 0.5};
  EXPECT_THROW(write_capture_glb(path, actor, frames, FrameVertices{}, options), ConfigError);
}

TEST(CaptureGlb, AnEmptyCaptureIsStillAFile) {
  const Actor actor = test::small_actor();
  const auto path = scratch("empty.glb");
  const CaptureGlbReport report = write_capture_glb(path, actor, std::vector<CapturedFrame>(3), FrameVertices{});
  EXPECT_EQ(report.n_keys, 0);
  EXPECT_TRUE(Viewer(path).model().animations.empty());
  EXPECT_THROW(write_capture_glb("/nonexistent/x.glb", actor, std::vector<CapturedFrame>{}, FrameVertices{}), IoError);
  CaptureGlbOptions options;
  options.fps = -1;
  EXPECT_THROW(write_capture_glb(path, actor, std::vector<CapturedFrame>{}, FrameVertices{}, options), ConfigError);
}

// Real cloth: the recorded truth surface over a pose that only follows the root joint.
TEST(CaptureGlb, HoldsAFullSequenceOfRealClothInTime) {
  LIVECAP_DATA_OR_SKIP(path, "skirt_dance");
  const Actor actor = load_actor(path / "actor.glb");
  Pc2Reader truth(path / "truth/vertices.pc2");
  std::vector<CapturedFrame> frames(truth.n_samples());
  std::vector<float> xyz(3 * actor.n_vertices());
  for (int f = 10; f < truth.n_samples(); ++f) {
    truth.read(f, xyz);
    frames[f].tracked = true;
    frames[f].pose = rest_pose(actor.skeleton);
    frames[f].pose.root_rotation = Eigen::AngleAxisd(M_PI, Eigen::Vector3d::UnitX()).toRotationMatrix();
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (size_t i = 0; i < xyz.size(); ++i) mean[i % 3] += xyz[i] / actor.n_vertices();
    frames[f].pose.root_translation_mm = 1000 * Eigen::Vector3d(mean.x(), -mean.y(), -mean.z());
  }
  Timer timer;
  const CaptureGlbReport report = write_capture_glb(scratch("cloth.glb"), actor, frames, path / "truth/vertices.pc2");
  RecordProperty("ms", static_cast<int>(timer.elapsed_ms()));
  RecordProperty("mean_error_um", static_cast<int>(1000 * report.mean_error_mm));
  RecordProperty("max_error_um", static_cast<int>(1000 * report.max_error_mm));
  std::printf("%.0f ms, %d targets, mean %.3f mm, max %.2f mm, %.1f MB\n", timer.elapsed_ms(), report.n_morph_targets,
              report.mean_error_mm, report.max_error_mm, report.bytes / 1e6);
  EXPECT_EQ(report.n_morph_targets, 64);
  EXPECT_EQ(report.n_keys, 150);
  EXPECT_LT(report.mean_error_mm, test::kClothMeanMm);
  const Viewer viewer(scratch("cloth.glb"));
  truth.read(110, xyz);
  const auto shown = viewer.show(100);
  double sum = 0;
  for (size_t i = 0; i < shown.size(); ++i) {
    const float* p = xyz.data() + 3 * actor.render.template_vertex[i];
    sum += 1000 * (shown[i] - Eigen::Vector3d(p[0], p[1], p[2])).norm();
  }
  EXPECT_LT(sum / static_cast<double>(shown.size()), test::kClothMeanMm);
}

}  // namespace
}  // namespace livecap
