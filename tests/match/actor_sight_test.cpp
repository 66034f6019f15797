// What see_actor.cl sees in one launch: of a textured wall with another in front of it, whose every pixel this file
// works out by itself in double precision, and what the kernels see that are launched one after the other.
#include "match/actor_sight.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>

#include "livecap/error.h"
#include "support/gpu_bodies.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

constexpr int kCells = 20, kTexture = 256, kArm = 14, kClothes = 5;
constexpr double kHalf = 300, kDepth = 2000;                                            // mm, of the wall
constexpr double kLeft = -190, kRight = -70, kTop = -160, kBottom = -60, kNear = 1700;  // of what is before it
constexpr double kSkinFrom = 0.7;                                                       // of the wall's width on
constexpr double kMovedX = 1.3, kMovedY = -0.8;                                         // px, of the picture
constexpr uint8_t kGrey = 102;

double texel(double x, double y) {
  return 128 + 30 * std::sin(0.5 * x + 1.5 * std::sin(0.11 * y)) + 30 * std::sin(0.55 * y + 1.5 * std::sin(0.13 * x)) +
         30 * std::sin(0.17 * x + std::sin(0.05 * y)) + 30 * std::sin(0.15 * y + std::sin(0.06 * x));
}

// Luminance of the wall, 0..255; (u, v) in 0..1.
double wall_light(double u, double v) {
  return u < kSkinFrom ? texel(u * kTexture - 0.5, v * kTexture - 0.5) : kGrey;
}

// How the wall (bone 1) and what is before it (bone 0) came from rest.
PosedSkeleton motions() {
  PosedSkeleton posed;
  for (const double sign : {1.0, -1.0}) {
    Eigen::Isometry3d motion(Eigen::AngleAxisd(0.7 * sign, Eigen::Vector3d(0.2, 0.9, -0.4).normalized()));
    motion.translation() = Eigen::Vector3d(120 * sign, -80, 900);
    posed.camera_from_rest.push_back(motion);
  }
  return posed;
}

struct Scene {
  Camera camera{.width = 321, .height = 281, .fx = 800, .fy = 805, .cx = 159.5, .cy = 139.5};
  PosedSkeleton posed = motions();
  Actor actor;
  std::vector<Eigen::Vector3d> points;  // camera frame

  Scene() {
    for (int j = 0; j <= kCells; ++j)
      for (int i = 0; i <= kCells; ++i) {
        const double u = double(i) / kCells, v = double(j) / kCells;
        add({(2 * u - 1) * kHalf, (2 * v - 1) * kHalf, kDepth}, 1, u, v);
      }
    for (const double y : {kTop, kBottom})
      for (const double x : {kLeft, kRight}) add({x, y, kNear}, 0, 0, 0);
    for (int j = 0; j < kCells; ++j)
      for (int i = 0; i < kCells; ++i) {
        const int a = j * (kCells + 1) + i, c = a + kCells + 1;
        actor.mesh.triangles.insert(actor.mesh.triangles.end(), {a, c, a + 1, a + 1, c, c + 1});
      }
    const int a = (kCells + 1) * (kCells + 1);
    actor.mesh.triangles.insert(actor.mesh.triangles.end(), {a, a + 2, a + 1, a + 1, a + 2, a + 3});
    actor.render.triangles = actor.mesh.triangles;
    actor.skeleton.bones = {{"pelvis", -1, {0, 0, 0}}, {"left_elbow", 0, {0, 0, 0}}};
    actor.texture = {kTexture, kTexture, {}};
    for (int y = 0; y < kTexture; ++y)
      for (int x = 0; x < kTexture; ++x)
        actor.texture.pixels.insert(actor.texture.pixels.end(), 3,
                                    uint8_t(std::lround(wall_light((x + 0.5) / kTexture, (y + 0.5) / kTexture))));
  }
  void add(const Eigen::Vector3d& point, int bone, double u, double v) {
    points.push_back(point);
    const Eigen::Vector3d rest = posed.camera_from_rest[bone].inverse() * point;
    for (const double value : rest) actor.mesh.positions.push_back(float(value));
    actor.skin.bones.insert(actor.skin.bones.end(), {bone, 0, 0, 0});
    actor.skin.weights.insert(actor.skin.weights.end(), {1, 0, 0, 0});
    actor.render.uvs.insert(actor.render.uvs.end(), {float(u), float(v)});
    actor.labels.push_back(bone == 1 && u > kSkinFrom ? kArm : kClothes);
    actor.colors.insert(actor.colors.end(), 3, 0.5f);
  }
  // What the camera shows: the wall moved a little, with nothing before it.
  void take_picture(DeviceFrame& frame) const {
    ImageRgb picture{camera.width, camera.height, {}};
    ImageGray mask{camera.width, camera.height, {}};
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const double u = ((x - kMovedX - camera.cx) / camera.fx * kDepth / kHalf + 1) / 2;
        const double v = ((y - kMovedY - camera.cy) / camera.fy * kDepth / kHalf + 1) / 2;
        const bool inside = u > 0 && u < 1 && v > 0 && v < 1;
        picture.pixels.insert(picture.pixels.end(), 3, inside ? uint8_t(std::lround(wall_light(u, v))) : 40);
        mask.pixels.push_back(inside ? 255 : 0);
      }
    frame.upload(make_silhouette(mask), picture);
  }
  Eigen::Vector2d pixel(const Eigen::Vector3d& p) const {
    return {camera.fx * p.x() / p.z() + camera.cx, camera.fy * p.y() / p.z() + camera.cy};
  }
  // How far inside what is before the wall a pixel lies, px; below 0 outside.
  double px_behind(const Eigen::Vector2d& at) const {
    const Eigen::Vector2d first = pixel({kLeft, kTop, kNear}), last = pixel({kRight, kBottom, kNear});
    return std::min((at - first).minCoeff(), (last - at).minCoeff());
  }
  double px_inside(const Eigen::Vector2d& at) const {
    const Eigen::Vector2d first = pixel({-kHalf, -kHalf, kDepth}), last = pixel({kHalf, kHalf, kDepth});
    return std::min((at - first).minCoeff(), (last - at).minCoeff());
  }
};

// Everything that a look writes to, or the kernels one by one.
struct Sight {
  Skinner skinner;
  DepthRasterizer raster;
  SurfaceVisibility visibility;
  TextureMatcher matcher;
  SkinShading shading;
  DeviceFrame frame;
  ocl::Buffer<float> zero, skinned, normals, share, moved, dual_quats;
  ocl::Buffer<int32_t> state;
  ActorSight sight;

  Sight(ocl::DeviceContext& device, const Scene& scene)
      : skinner(device, scene.actor),
        raster(device, scene.actor.mesh, scene.camera.width, scene.camera.height),
        visibility(device, scene.actor.mesh),
        matcher(device, scene.actor, scene.camera, MatchOptions{}),
        shading(device, scene.actor, scene.camera, SkinShadingOptions{}),
        frame(device, scene.camera.width, scene.camera.height),
        zero(device, scene.actor.mesh.positions.size()),
        skinned(device, zero.size()),
        normals(device, zero.size()),
        share(device, std::vector<float>(scene.points.size(), 1.0f)),
        moved(device, std::vector<float>{5}),
        dual_quats(device, bone_dual_quats(scene.posed)),
        state(device, std::vector<int32_t>{0, 0}),
        sight(device, scene.camera, skinner, raster, visibility, matcher, shading) {
    for (ocl::Buffer<float>* buffer : {&zero, &skinned, &normals}) buffer->fill(0);
    scene.take_picture(frame);
    matcher.set_box(frame, frame_box(scene));
  }
  static PixelBox frame_box(const Scene& scene) {
    const Eigen::Vector2d first = scene.pixel({-kHalf, -kHalf, kDepth}), last = scene.pixel({kHalf, kHalf, kDepth});
    return {int(first.x()), int(first.y()), int(last.x()) + 3, int(last.y()) + 1};
  }
  void look(int level, bool new_picture, float least_moved_px = -INFINITY) {
    state.fill(0);
    sight.look({.level = level,
                .new_picture = new_picture,
                .shades = true,
                .frame = frame,
                .motions = dual_quats,
                .displacement = zero,
                .share = share,
                .candidates = nullptr,
                .skinned = skinned,
                .normals = normals,
                .moved = moved,
                .least_moved_px = least_moved_px,
                .state = state});
  }
  std::vector<LightSample> sample_light() {
    return matcher.sample_light(frame, raster, skinned, normals, visibility.visible());
  }
  void one_by_one(const Scene& scene, int level) {
    skinner.set_pose(bone_dual_quats(scene.posed));
    skinner.skin(zero, skinned);
    raster.render(skinned, scene.camera);
    skinner.normals(skinned, normals);
    visibility.find_visible_and_contour(skinned, normals, raster);
    matcher.set_picture(frame, frame_box(scene));
    matcher.match(raster, skinned, normals, visibility.visible(), share, level);
    shading.measure(frame, raster, skinned, normals, visibility.visible());
  }
};

// See kernels/raster/depth_and_id.h.
std::vector<float> depths_of(const std::vector<uint64_t>& drawn) {
  std::vector<float> depths;
  for (const uint64_t word : drawn) depths.push_back(std::bit_cast<float>(uint32_t(word >> 32)));
  return depths;
}

std::vector<int32_t> triangles_of(const std::vector<uint64_t>& drawn) {
  std::vector<int32_t> triangles;
  for (const uint64_t word : drawn) triangles.push_back(int32_t(uint32_t(word)));
  return triangles;
}

void expect_surface(const Scene& scene, const Sight& seen) {
  const std::vector<float> skinned = seen.skinned.read_all(), normals = seen.normals.read_all();
  const std::vector<int32_t> visible = seen.visibility.visible().read_all(),
                             contour = seen.visibility.contour().read_all();
  int n_hidden = 0;
  for (size_t i = 0; i < scene.points.size(); ++i) {
    SCOPED_TRACE(i);
    const bool is_wall = scene.points[i].z() == kDepth;
    const Eigen::Vector2d at = scene.pixel(scene.points[i]);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(skinned[3 * i + k], scene.points[i][k], test::kSightMm);
      EXPECT_NEAR(normals[3 * i + k], k == 2 ? -1 : 0, test::kSight);
    }
    if (!is_wall || std::abs(scene.px_behind(at)) > 3) EXPECT_EQ(visible[i], !is_wall || scene.px_behind(at) < 0);
    EXPECT_EQ(contour[i], is_wall && scene.px_inside(at) < 1);
    n_hidden += !visible[i];
  }
  EXPECT_GT(n_hidden, 8);
}

void expect_pixels(const Scene& scene, const Sight& seen) {
  const std::vector<uint64_t> drawn = seen.sight.drawn().read_all();
  const std::vector<float> depth = depths_of(drawn);
  const std::vector<int32_t> ids = triangles_of(drawn);
  for (int y = 0; y < scene.camera.height; ++y)
    for (int x = 0; x < scene.camera.width; ++x) {
      const double behind = scene.px_behind({x, y}), inside = scene.px_inside({x, y});
      if (std::min(std::abs(behind), std::abs(inside)) < 0.1) continue;
      const size_t p = size_t(y) * scene.camera.width + x;
      const double expected = behind > 0 ? kNear : inside > 0 ? kDepth : INFINITY;
      if (std::isinf(expected)) {
        ASSERT_EQ(depth[p], expected) << x << " " << y;
        ASSERT_EQ(ids[p], -1) << x << " " << y;
        continue;
      }
      ASSERT_NEAR(depth[p], expected, test::kSightMm) << x << " " << y;
      const double u = ((x - scene.camera.cx) / scene.camera.fx * kDepth / kHalf + 1) / 2 * kCells;
      const double v = ((y - scene.camera.cy) / scene.camera.fy * kDepth / kHalf + 1) / 2 * kCells;
      const double fu = u - std::floor(u), fv = v - std::floor(v);
      if (behind > 0) {
        ASSERT_GE(ids[p], 2 * kCells * kCells) << x << " " << y;
      } else if (std::abs(fu + fv - 1) > 0.1 && std::abs(fu - 0.5) < 0.45 && std::abs(fv - 0.5) < 0.45) {
        ASSERT_EQ(ids[p], 2 * (int(v) * kCells + int(u)) + (fu + fv > 1)) << x << " " << y;
      }
    }
}

void expect_matches(const Scene& scene, Sight& seen, int level) {
  const std::vector<float> matches = seen.matcher.matches().read_all();
  const std::vector<int32_t> visible = seen.visibility.visible().read_all();
  const double margin_px = 12 << level, cell_mm2 = std::pow(2 * kHalf / kCells, 2);
  int n_matched = 0, n_asked = 0;
  for (size_t i = 0; i < scene.points.size(); ++i) {
    SCOPED_TRACE(i);
    const float* m = &matches[size_t(LC_MATCH) * i];
    const Eigen::Vector3d& p = scene.points[i];
    const Eigen::Vector2d at = scene.pixel(p);
    if (!visible[i]) EXPECT_EQ(m[LC_MATCH_SEEN_PX], 0);
    if (!visible[i] || p.z() != kDepth || scene.px_inside(at) < margin_px || scene.px_behind(at) > -margin_px) continue;
    EXPECT_NEAR(m[LC_MATCH_SEEN_PX],
                cell_mm2 * p.z() / p.norm() * std::pow((scene.camera.fx + scene.camera.fy) / 2 / p.z(), 2),
                test::kSightMm);
    if (at.x() > scene.pixel({(2 * kSkinFrom - 1) * kHalf, 0, kDepth}).x() - margin_px) continue;
    ++n_asked;
    if (!(m[LC_MATCH_WEIGHT_PX] > 0)) continue;
    ++n_matched;
    const double du = m[0] - at.x() - kMovedX, dv = m[1] - at.y() - kMovedY;
    EXPECT_LT(std::hypot(m[2] * du + m[3] * dv, m[4] * dv), 0.3 * (1 << level));
  }
  EXPECT_GT(n_asked, 20);
  EXPECT_GE(n_matched, n_asked - 1);
}

void expect_skin(Sight& seen) {
  size_t n = 0;
  const std::vector<SkinSample> samples = seen.shading.read();
  for (const SkinSample& s : samples) {
    EXPECT_NEAR(s.brightness, 0.16 / 0.25, test::kSight);  // (102 / 255)^2 by 0.5^2
    EXPECT_NEAR((s.normal - Eigen::Vector3f(0, 0, -1)).norm(), 0, test::kSight);
  }
  // Whose 5 x 5 pixels lie on triangles of skin alone: not those at its edges.
  for (int j = 1; j < kCells; ++j)
    for (int i = 0; i < kCells; ++i) n += double(i - 1) / kCells > kSkinFrom;
  EXPECT_EQ(samples.size(), n);
  EXPECT_GT(n, 50u);
}

TEST(ActorSight, SeesWhatIsThere) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    const Scene scene;
    Sight seen(device, scene);
    ASSERT_TRUE(seen.sight.usable());
    for (const int level : {0, 2, 1, 0}) {
      SCOPED_TRACE(level);
      seen.look(level, level == 0);  // the others look at the picture of the first
      expect_matches(scene, seen, level);
    }
    expect_surface(scene, seen);
    expect_pixels(scene, seen);
    expect_skin(seen);
  });
}

// To the bit: camera_block() is halve_picture, and all the others are themselves.
TEST(ActorSight, SeesWhatIsSeenOneByOne) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    const Scene scene;
    Sight at_once(device, scene), one_by_one(device, scene);
    for (Sight* sight : {&at_once, &one_by_one}) sight->matcher.set_light({0.5f, 0, 0, -0.25f});
    for (int level = LC_MATCH_LEVELS; level >= 0; --level) {
      SCOPED_TRACE(level);
      at_once.look(level, level == LC_MATCH_LEVELS);
      one_by_one.one_by_one(scene, level);
      EXPECT_EQ(at_once.matcher.matches().read_all(), one_by_one.matcher.matches().read_all());
    }
    const std::vector<LightSample> lit = at_once.sample_light(), expected_light = one_by_one.sample_light();
    EXPECT_GT(lit.size(), scene.points.size() / 2);
    ASSERT_EQ(lit.size(), expected_light.size());
    for (size_t i = 0; i < lit.size(); ++i) EXPECT_EQ(lit[i].brightness, expected_light[i].brightness);
    EXPECT_EQ(at_once.skinned.read_all(), one_by_one.skinned.read_all());
    EXPECT_EQ(at_once.normals.read_all(), one_by_one.normals.read_all());
    const std::vector<uint64_t> drawn = at_once.sight.drawn().read_all();
    EXPECT_EQ(depths_of(drawn), one_by_one.raster.depth().read_all());
    EXPECT_EQ(triangles_of(drawn), one_by_one.raster.triangle_ids().read_all());
    EXPECT_EQ(at_once.visibility.visible().read_all(), one_by_one.visibility.visible().read_all());
    EXPECT_EQ(at_once.visibility.contour().read_all(), one_by_one.visibility.contour().read_all());
    const std::vector<SkinSample> got = at_once.shading.read(), expected = one_by_one.shading.read();
    ASSERT_EQ(got.size(), expected.size());
    for (size_t i = 0; i < got.size(); ++i) EXPECT_EQ(got[i].brightness, expected[i].brightness);
  });
}

TEST(ActorSight, DoesNothingAfterARoundThatMovedTooLittle) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    const Scene scene;
    Sight seen(device, scene);
    seen.look(0, true, 5.5f);  // it moved 5 px
    for (const float value : seen.skinned.read_all()) ASSERT_EQ(value, 0);
    seen.look(0, true, 4.5f);
    expect_surface(scene, seen);
  });
}

TEST(ActorSight, RefusesALevelThatIsNot) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    const Scene scene;
    Sight seen(device, scene);
    for (const int level : {-1, LC_MATCH_LEVELS + 1}) EXPECT_THROW(seen.look(level, true), LogicError) << level;
  });
}

// Groups that cannot wait for each other say so, and match nothing.
TEST(ActorSight, IsGivenUpWhereGroupsCannotWait) {
  test::on_every_gpu_body(
      [](ocl::DeviceContext& device) {
        const Scene scene;
        Sight seen(device, scene);
        seen.look(0, true);
        if (seen.state.read_all()[1] == 0) return expect_surface(scene, seen);  // they can
        for (const float value : seen.matcher.matches().read_all()) ASSERT_EQ(value, 0);
      },
      3);
}

// On a GPU `livecap devices` asks it at every level.
TEST(ActorSight, HasKnownAnswers) {
  test::on_every_gpu_body([](ocl::DeviceContext& device) {
    int n = 0;
    for (const ocl::SelfTestResult& result : match_self_test(device)) {
      EXPECT_TRUE(result.ok) << result.kernel << ": " << result.detail;
      n += result.kernel.find("see_actor") != std::string::npos;
    }
    EXPECT_EQ(n, LC_MATCH_LEVELS + 1);
  });
}

}  // namespace
}  // namespace livecap
