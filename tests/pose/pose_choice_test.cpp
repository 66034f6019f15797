// What a GPU chooses of contour vertices, matches and skin (kernels/pose/choose.cl) against what the host chooses of
// the same: a solve must come to the same bits with either.
#include <gtest/gtest.h>

#include <bit>
#include <map>
#include <random>

#include "match/layout.h"
#include "pose/pose_solver.h"
#include "pose/row_inputs.h"
#include "support/gpu_bodies.h"
#include "support/pose_reference.h"
#include "support/pose_scene.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

constexpr float kMatchAreaPx = 25, kLimbAreaPx = 60;

// What the picture's kernels may leave of an actor's vertices, on the host and on the device.
struct Picture {
  std::vector<int32_t> contour_flags, skin_vertices, skin_limbs;
  std::vector<float> match_values, skin_values;
  std::array<SeenSkin::Light, 2> lights;
  ocl::Buffer<int32_t> contour, vertices, limbs;
  ocl::Buffer<float> matches, skin;

  // share: of the vertices that are seen.
  Picture(ocl::DeviceContext& device, int n_vertices, const Camera& camera, double share, bool knows_light) {
    std::mt19937 rng{7};
    std::uniform_real_distribution<float> in_0_1(0, 1);
    for (int i = 0; i < n_vertices; ++i) {
      contour_flags.push_back(in_0_1(rng) < share);
      const float weight = in_0_1(rng) < share ? std::pow(in_0_1(rng), 4) * 80 : 0;
      const float px = in_0_1(rng) < share ? weight + in_0_1(rng) : weight;
      const float root[] = {0.5f + in_0_1(rng), in_0_1(rng) - 0.5f, 0.5f + in_0_1(rng)};
      for (const float value :
           {camera.width * in_0_1(rng), camera.height * in_0_1(rng), root[0], root[1], root[2], weight, 0.9f, px})
        match_values.push_back(value);
      if (i % 3 == 1) continue;
      const int limb = i % 5;  // of eight; on arms and legs
      skin_vertices.push_back(i);
      skin_limbs.push_back(2 * limb + limb % 2);
      const bool is_seen = in_0_1(rng) < share;
      const float seen_px = (in_0_1(rng) < 0.1f ? -9 : 9) * in_0_1(rng);  // negative: of another colour
      for (const float value : {0.0f, 0.0f, -1.0f, 0.2f + in_0_1(rng), is_seen ? seen_px : 0.0f, 1.0f, 1.0f})
        skin_values.push_back(value);
    }
    for (SeenSkin::Light& light : lights) {
      light.is_known = knows_light || &light == &lights[1];
      for (float& value : light.light) value = in_0_1(rng);
      light.deviation = 0.03 + 0.1 * in_0_1(rng);
    }
    contour = {device, contour_flags};
    vertices = {device, skin_vertices};
    limbs = {device, skin_limbs};
    matches = {device, match_values};
    skin = {device, skin_values};
  }

  SeenVertices seen() const {
    return {&contour, &matches, kMatchAreaPx, {&skin, &vertices, &limbs, kLimbAreaPx, lights}};
  }
  std::vector<int32_t> contour_found() const {
    std::vector<int32_t> found;
    for (int i = 0; i < int(contour_flags.size()); ++i)
      if (contour_flags[i]) found.push_back(i);
    return found;
  }
  std::vector<VertexMatch> matches_found() const {
    std::vector<VertexMatch> found;
    for (int i = 0; i < int(contour_flags.size()); ++i) {
      const float* m = &match_values[size_t(LC_MATCH) * i];
      if (m[5] > 0) found.push_back({i, m[0], m[1], m[2], m[3], m[4], m[5] / kMatchAreaPx});
    }
    return found;
  }
  double missed_weight() const {
    double px = 0;
    for (size_t i = 0; i < match_values.size(); i += LC_MATCH) px += double(match_values[i + 7]) - match_values[i + 5];
    return px / kMatchAreaPx;
  }
  double seen_weight() const {
    double px = 0;
    for (size_t i = 0; i < match_values.size(); i += LC_MATCH) px += match_values[i + 7];
    return px / kMatchAreaPx;
  }
  std::vector<ShadedVertex> shaded_found() const {
    std::map<int, double> limb_px;
    const auto px = [&](size_t i) { return skin_values[LC_SKIN * i + 4]; };
    for (size_t i = 0; i < skin_limbs.size(); ++i) limb_px[skin_limbs[i] / 2] += std::max(0.0f, px(i));
    std::vector<ShadedVertex> found;
    for (size_t i = 0; i < skin_limbs.size(); ++i) {
      const SeenSkin::Light& light = lights[skin_limbs[i] % 2];
      if (!(px(i) > 0) || !light.is_known) continue;
      found.push_back({skin_vertices[i], light.light, float(skin_values[LC_SKIN * i + 3] / light.deviation),
                       float(px(i) / std::max(limb_px[skin_limbs[i] / 2], double(kLimbAreaPx)))});
    }
    return found;
  }
};

// So often, one body in another.
Actor copies_of_test_actor(int n) {
  Actor actor = test::make_test_actor(0.7);
  const Actor one = actor;
  const auto append = [](auto& to, const auto& from) { to.insert(to.end(), from.begin(), from.end()); };
  for (int k = 1; k < n; ++k) {
    for (const int32_t corner : one.mesh.triangles) actor.mesh.triangles.push_back(corner + k * one.n_vertices());
    append(actor.mesh.positions, one.mesh.positions);
    append(actor.skin.bones, one.skin.bones);
    append(actor.skin.weights, one.skin.weights);
  }
  return actor;
}

struct ChoiceScene {
  Actor actor;
  Camera camera = test::portrait_camera();
  PoseOptions options;
  std::mt19937 rng{23};
  Pose truth = test::random_true_pose(actor, rng, 0.6);
  Detections detections = test::exact_detections(actor, camera, truth, 0.9);
  PoseState start{test::disturbed(truth, rng, 0.15, 40), {20, -40, 3100}};
  DeviceFrame frame;

  ChoiceScene(ocl::DeviceContext& device, int n_copies)
      : actor(copies_of_test_actor(n_copies)), frame(device, camera.width, camera.height) {
    frame.signed_distance.write(test::smooth_distance(camera));
  }
  KeypointTargets targets() const { return make_targets(actor, detections, nullptr, options); }
};

// All there is; some of it thinned; most of it thinned, with weights above a share; nothing; more than the kernel looks
// at in one go.
struct Case {
  const char* name;
  double share;
  int most_contour, most_matches, most_shaded;
  int n_copies = 1;
};
constexpr Case kCases[] = {{"all", 0.3, 4000, 4000, 4000}, {"some", 0.6, 300, 301, 200},
                           {"few", 0.9, 63, 33, 17},       {"one", 0.9, 1, 1, 1},
                           {"none", 0, 512, 768, 256},     {"many", 0.4, 512, 4000, 256, 19}};

TEST(PoseChoice, IsTheHosts) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    for (const Case& c : kCases) {
      for (const bool knows_light : {true, false}) {
        SCOPED_TRACE(c.name);
        ChoiceScene scene(device, c.n_copies);
        scene.options.max_contour_vertices = c.most_contour;
        scene.options.max_matches = c.most_matches;
        scene.options.max_shaded = c.most_shaded;
        const Picture picture(device, scene.actor.n_vertices(), scene.camera, c.share, knows_light);
        if (c.n_copies > 1) ASSERT_GT(scene.actor.n_vertices(), 2 * LC_POSE_CHOICE_GROUP);
        PoseSystem system(device, scene.actor, scene.camera, scene.options);
        system.set_frame(scene.targets(), &scene.frame, picture.contour_found(), picture.matches_found(),
                         picture.shaded_found());
        const int n_contour = system.n_contour(), n_matches = system.n_matches(), n_shaded = system.n_shaded();
        const Eigen::MatrixXf J = system.jacobian(scene.start);
        const std::optional<PoseSteps> expected = system.take_steps(scene.start, 2, 0);
        ASSERT_TRUE(expected.has_value());

        ASSERT_TRUE(system.chooses());
        system.set_frame(scene.targets(), &scene.frame, {});  // a device that chooses nothing finds nothing
        system.residuals(scene.start);
        system.set_seen_frame(scene.targets(), &scene.frame, picture.seen());
        const std::optional<PoseSteps> got = system.take_steps(scene.start, 2, 0);
        ASSERT_TRUE(got.has_value());
        EXPECT_EQ(system.n_contour(), n_contour);
        EXPECT_EQ(system.n_matches(), n_matches);
        EXPECT_EQ(system.n_shaded(), n_shaded);
        EXPECT_NEAR(system.missed_weight(), picture.missed_weight(),
                    test::kPoseJacobian * (1 + picture.missed_weight()));
        EXPECT_NEAR(system.seen_weight(), picture.seen_weight(), test::kPoseJacobian * (1 + picture.seen_weight()));
        EXPECT_EQ(got->step_energy, expected->step_energy);
        EXPECT_EQ(state_values(got->state), state_values(expected->state));
        EXPECT_EQ(got->residuals, expected->residuals);
        system.read_choice();
        EXPECT_EQ(system.n_contour(), n_contour);
        EXPECT_TRUE(system.jacobian(scene.start) == J);
      }
    }
  });
}

TEST(PoseChoice, IsTheHostsWhereWorkGroupsAreSmall) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    ocl::DeviceInfo info = device.info();
    info.max_work_group_size = LC_POSE_CHOICE_GROUP / 2;
    ocl::DeviceContext small(info);
    const ChoiceScene scene(small, 1);
    EXPECT_FALSE(PoseSystem(small, scene.actor, scene.camera, scene.options).chooses());
  });
}

// Where a wait is given up, and where nothing is detected.
TEST(PoseChoice, IsReadWhereTheHostNeedsIt) {
  test::on_every_gpu_body(
      [](ocl::DeviceContext& device) {
        const ChoiceScene scene(device, 1);
        const Picture picture(device, scene.actor.n_vertices(), scene.camera, 0.3, true);
        const std::vector<int32_t> contour = picture.contour_found();
        const std::vector<VertexMatch> matches = picture.matches_found();
        const std::vector<ShadedVertex> shaded = picture.shaded_found();
        const SeenVertices seen = picture.seen();
        for (const bool detected : {true, false}) {
          PoseSolver solver(device, scene.actor, scene.camera, scene.options);
          PoseInput input{.detections = detected ? scene.detections : Detections{},
                          .initial = scene.start.pose,
                          .frame = &scene.frame};
          ASSERT_TRUE(solver.chooses());
          input.seen = &seen;
          const PoseResult got = solver.solve(input);
          input.seen = nullptr;
          input.contour_vertices = contour;
          input.matches = matches;
          input.shaded = shaded;
          const PoseResult expected = solver.solve(input);
          EXPECT_EQ(got.status, expected.status);
          EXPECT_EQ(got.step_energy, expected.step_energy);
          EXPECT_EQ(got.pose.angles_rad, expected.pose.angles_rad);
          EXPECT_EQ(got.energy.silhouette, expected.energy.silhouette);
        }
      },
      7);  // two of each kind choose
}

// Slices that give up their waits have read of the others whatever was in memory: nothing of that may become a count or
// a vertex of the rows.
TEST(PoseChoice, IsOfVerticesWhereAWaitIsGivenUp) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    constexpr int kSlices = 2;
    const ChoiceScene scene(device, 1);
    const int n = scene.actor.n_vertices();
    const Picture picture(device, n, scene.camera, 0.6, true);
    PoseOptions options = scene.options;
    options.max_contour_vertices = options.max_matches = options.max_shaded = 64;
    PoseRowInputs inputs({}, options, n);
    inputs.set_choice(picture.seen());
    const PoseInputs at = inputs.places();
    const PoseChoice choice{{n, n, int(picture.vertices.size())}, {64, 64, 64}, kLimbAreaPx};
    ocl::Kernel choose(device, "pose/choose.cl", "pose_choose");
    const ocl::Buffer<float> moved(device, std::vector{1.0f});
    std::mt19937_64 rng{5};
    for (int round = 0; round < 20; ++round) {
      std::vector<int64_t> told(LC_POSE_CHOICE_TOLD * kSlices);
      for (int64_t& value : told) value = int64_t(rng()) >> rng() % 64;
      const ocl::Buffer<int64_t> told_on_device(device, told);
      const ocl::Buffer<int32_t> state(device, std::vector<int32_t>(6));
      ocl::Buffer<float> chosen(device, inputs.words());
      choose.launch(3 * kSlices * LC_POSE_CHOICE_GROUP, LC_POSE_CHOICE_GROUP, at, choice, 0.0f, moved, picture.contour,
                    picture.matches, picture.skin, picture.vertices, picture.limbs, chosen, told_on_device, state,
                    ocl::LocalMemory{2 * sizeof(int64_t) * LC_POSE_CHOICE_GROUP},
                    ocl::LocalMemory{sizeof(double) * LC_SKIN_LIMBS});
      const std::vector<float> words = chosen.read_all();
      const auto whole = [&](int place) { return std::bit_cast<int32_t>(words[place]); };
      for (int kind = 0; kind < 3; ++kind) {
        EXPECT_GE(whole(at.counts + kind), 0);
        EXPECT_LE(whole(at.counts + kind), 64);
      }
      for (const int first : {at.contour_vertices, at.match_vertices, at.shaded_vertices}) {
        for (int i = first; i < first + 64; ++i) {
          EXPECT_GE(whole(i), 0);
          EXPECT_LT(whole(i), n);
        }
      }
    }
  });
}

}  // namespace
}  // namespace livecap
