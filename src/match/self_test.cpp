// Known answer: a textured square before the camera, and a picture in which it lies 2 px to the right and 1 px higher,
// in three quarters of the light; and as a forearm of a known colour in a picture of one grey.
#include <algorithm>
#include <cmath>

#include "actor/labels.h"
#include "base/text.h"
#include "match/actor_sight.h"
#include "match/cloth_anew.h"
#include "match/cloth_behind.h"
#include "match/skin_shading.h"
#include "match/texture_matcher.h"

namespace livecap {
namespace {

constexpr int kCells = 6;
constexpr int kTextureSize = 64;
constexpr float kSide = 600, kDepth = 2000;  // mm
constexpr int kMovedX = 2, kMovedY = -1;

// Waves of some 12 texels, bent so that no patch looks like its neighbours.
uint8_t texel(int x, int y) {
  return uint8_t(128 + 50 * std::sin(0.5 * x + 1.5 * std::sin(0.11 * y)) +
                 50 * std::sin(0.55 * y + 1.5 * std::sin(0.13 * x)));
}

// A colour in three quarters of the light: what is mirrored (0.04 of linear light) does not care for the surface's
// colour.
double in_less_light(double value) {
  const double linear = value * value / (255.0 * 255.0);
  return value * (1 - 0.25 * linear / (linear + 0.04));
}

Actor square() {
  Actor actor;
  for (int j = 0; j <= kCells; ++j) {
    for (int i = 0; i <= kCells; ++i) {
      const float u = float(i) / kCells, v = float(j) / kCells;
      actor.mesh.positions.insert(actor.mesh.positions.end(), {(u - 0.5f) * kSide, (v - 0.5f) * kSide, kDepth});
      actor.render.uvs.insert(actor.render.uvs.end(), {u, v});
    }
  }
  for (int j = 0; j < kCells; ++j) {
    for (int i = 0; i < kCells; ++i) {
      const int a = j * (kCells + 1) + i, b = a + 1, c = a + kCells + 1, d = c + 1;
      actor.mesh.triangles.insert(actor.mesh.triangles.end(), {a, c, b, b, c, d});
    }
  }
  actor.render.triangles = actor.mesh.triangles;
  actor.texture = {kTextureSize, kTextureSize, {}};
  for (int y = 0; y < kTextureSize; ++y)
    for (int x = 0; x < kTextureSize; ++x) actor.texture.pixels.insert(actor.texture.pixels.end(), 3, texel(x, y));
  return actor;
}

// Every vertex whose surroundings lie in the square is seen, and as bright as grey^2 by color^2.
ocl::SelfTestResult skin_result(ocl::DeviceContext& device, Actor actor, const Camera& camera,
                                const DepthRasterizer& raster, const ocl::Buffer<float>& positions,
                                const ocl::Buffer<float>& normals, const ocl::Buffer<int32_t>& visible) {
  constexpr uint8_t kGrey = 102;  // 0.4 of 255
  constexpr float kColor = 0.5f;
  actor.labels.assign(actor.n_vertices(), lip::kLeftArm);
  actor.colors.assign(3 * size_t(actor.n_vertices()), kColor);
  actor.skin.bones.assign(4 * size_t(actor.n_vertices()), 0);
  actor.skeleton.bones = {{"left_elbow", -1, {0, 0, 0}}};
  DeviceFrame frame(device, camera.width, camera.height);
  frame.signed_distance.fill(-10);
  frame.rgb.fill(kGrey);
  SkinShading shading(device, actor, camera, SkinShadingOptions{});
  shading.measure(frame, raster, positions, normals, visible);
  const std::vector<SkinSample> samples = shading.read();
  double worst = 0;
  for (const SkinSample& s : samples) worst = std::max(worst, std::abs(double(s.brightness) - 0.16 / 0.25));
  const size_t expected = (kCells - 1) * (kCells - 1);
  const bool ok = samples.size() == expected && worst < 1e-5;
  return {"match/skin_shading.cl skin_brightness", ok,
          ok ? "" : format("%zu of %zu vertices seen, brightness off by %g", samples.size(), expected, worst)};
}

// Every vertex whose patch lies in the square is found where the picture has it.
ocl::SelfTestResult match_result(const std::string& name, const Actor& actor, const Camera& camera,
                                 const Matches& matches, int level) {
  int found = 0;
  double worst = 0;
  for (const VertexMatch& match : matches.found) {
    const int i = match.vertex % (kCells + 1), j = match.vertex / (kCells + 1);
    if (std::min(i, j) < 2 || std::max(i, j) > kCells - 2) continue;  // its patch leaves the square
    const float* p = &actor.mesh.positions[3 * size_t(match.vertex)];
    const double u = camera.fx * p[0] / p[2] + camera.cx + kMovedX, v = camera.fy * p[1] / p[2] + camera.cy + kMovedY;
    const double du = match.u_px - u, dv = match.v_px - v;
    worst = std::max(worst, std::hypot(match.a * du + match.b * dv, match.c * dv));
    ++found;
  }
  const double bound = 0.3 * (1 << level);
  const int expected = (kCells - 3) * (kCells - 3);
  const bool ok = found == expected && worst <= bound;
  return {
      name, ok,
      ok ? "" : format("%d of %d vertices found, worst %g px off, at most %g expected", found, expected, worst, bound)};
}

// The picture is in three quarters of the light, whatever light the square is drawn in; its waves move what single
// vertices tell.
ocl::SelfTestResult light_result(const std::string& name, const DeviceFrame& frame, const DepthRasterizer& raster,
                                 const ocl::Buffer<float>& positions, const ocl::Buffer<float>& normals,
                                 const ocl::Buffer<int32_t>& visible, const ocl::Buffer<float>& share,
                                 TextureMatcher& matcher) {
  constexpr size_t kLeastSamples = (kCells - 1) * (kCells - 1);
  constexpr double kLight = 0.75, kTolerance = 0.1;
  matcher.set_light({0.3f, 0, 0, -0.2f});  // 0.5 towards the camera
  matcher.match(raster, positions, normals, visible, share, 0);
  const std::vector<LightSample> samples = matcher.sample_light(frame, raster, positions, normals, visible);
  matcher.set_light({1});
  double sum = 0, weights = 0;
  for (const LightSample& s : samples) {
    sum += double(s.weight) * s.brightness;
    weights += s.weight;
  }
  const double brightness = weights > 0 ? sum / weights : 0;
  const bool ok = samples.size() >= kLeastSamples && std::abs(brightness - kLight) < kTolerance;
  return {name, ok,
          ok ? "" : format("%zu vertices seen, brightness %g, expected %g", samples.size(), brightness, kLight)};
}

// The vertex in the middle is not seen and began 10 mm to the right of its place, the others 6 mm to the left of
// theirs: it goes as far as they went. Where they do not hang it has no match, and one that it has is kept.
ocl::SelfTestResult behind_result(ocl::DeviceContext& device, const Actor& actor, const Camera& camera,
                                  const DepthRasterizer& raster, const ocl::Buffer<float>& normals,
                                  TextureMatcher& matcher, const ocl::Buffer<float>& hangs) {
  constexpr float kShare = 0.25f, kBeganMm = 10, kOthersBeganMm = -6;
  const int n = actor.n_vertices(), middle = n / 2;
  std::vector<int32_t> seen(n, 1);
  std::vector<float> start = actor.mesh.positions, alone(n, 0.0f);
  for (int i = 0; i < n; ++i) start[3 * size_t(i)] += i == middle ? kBeganMm : kOthersBeganMm;
  seen[middle] = 0;
  alone[middle] = 1;
  const ocl::Buffer<int32_t> visible(device, seen);
  const ocl::Buffer<float> positions(device, actor.mesh.positions), began(device, start);
  ClothBehind behind(device, camera, kShare);
  const auto found = [&](const ocl::Buffer<float>& that_hang) {
    matcher.match(raster, positions, normals, visible, hangs, 0);
    behind.match(raster, began, that_hang, visible, matcher.matches());
    const std::vector<float> all = matcher.matches().read_all();
    return std::vector<float>(&all[LC_MATCH * size_t(middle)], &all[LC_MATCH * size_t(middle) + LC_MATCH]);
  };
  const auto keeps_a_match = [&] {
    std::vector<float> all = matcher.matches().read_all();
    all[LC_MATCH * size_t(middle) + LC_MATCH_WEIGHT_PX] = 1;
    matcher.matches().write(all);
    behind.match(raster, began, hangs, visible, matcher.matches());
    return matcher.matches().read_all() == all;
  };
  const float* place = &start[3 * size_t(middle)];
  const std::vector<float> match = found(hangs), none = found(ocl::Buffer<float>(device, alone));
  const double du = match[0] - (camera.fx * (place[0] - kOthersBeganMm) / kDepth + camera.cx + kMovedX);
  const double dv = match[1] - (camera.fy * place[1] / kDepth + camera.cy + kMovedY);
  const bool ok = std::hypot(du, dv) <= 0.3 && match[LC_MATCH_CORRELATION] == kShare && none[LC_MATCH_WEIGHT_PX] == 0 &&
                  keeps_a_match();
  return {"match/match_behind.cl match_behind", ok,
          ok ? ""
             : format("(%g, %g) px off, counts %g, and %g where nothing else hangs", du, dv,
                      match[LC_MATCH_CORRELATION], none[LC_MATCH_WEIGHT_PX])};
}

// Every third match is better anew, every fifth is missing otherwise and every seventh anew; together those anew weigh
// a little less than the others.
bool chooses_anew(ocl::DeviceContext& device, int n_matches) {
  std::vector<float> before(size_t(LC_MATCH) * n_matches, 0.0f), anew = before, expected;
  double weight = 0, weight_anew = 0;
  for (int i = 0; i < n_matches; ++i) {
    float* b = &before[size_t(LC_MATCH) * i];
    float* a = &anew[size_t(LC_MATCH) * i];
    b[0] = float(i), a[0] = -float(i);
    b[LC_MATCH_SEEN_PX] = 3, a[LC_MATCH_SEEN_PX] = 4;
    b[LC_MATCH_CORRELATION] = 0.8f, a[LC_MATCH_CORRELATION] = i % 3 == 0 ? 0.9f : 0.7f;
    b[LC_MATCH_WEIGHT_PX] = i % 5 == 0 ? 0.0f : 2.0f, a[LC_MATCH_WEIGHT_PX] = i % 7 == 0 ? 0.0f : 1.5f;
    weight += b[LC_MATCH_WEIGHT_PX], weight_anew += a[LC_MATCH_WEIGHT_PX];
  }
  expected = before;
  for (int i = 0; i < n_matches; ++i)
    if ((i % 3 == 0 || i % 5 == 0) && i % 7 != 0)
      std::copy_n(&anew[size_t(LC_MATCH) * i], LC_MATCH, &expected[size_t(LC_MATCH) * i]);
  const double share = weight_anew / weight;
  const auto chosen = [&](double least_share) {
    ocl::Buffer<float> matches(device, before);
    ClothAnew choice(device, n_matches, float(least_share));
    choice.keep(ocl::Buffer<float>(device, anew));
    choice.choose(matches);
    return matches.read_all();
  };
  return chosen(0.99 * share) == expected && chosen(1.01 * share) == before;
}

ocl::SelfTestResult anew_result(ocl::DeviceContext& device) {
  const bool ok = chooses_anew(device, 1000) && chooses_anew(device, 5);
  return {"match/match_anew.cl match_anew", ok, ok ? "" : "other matches were chosen"};
}

// All in one launch, where the device does so: the square hangs on one bone that has not moved.
std::vector<ocl::SelfTestResult> sight_results(ocl::DeviceContext& device, Actor actor, const Camera& camera,
                                               const DeviceFrame& frame, const PixelBox& box,
                                               const ocl::Buffer<float>& share) {
  const size_t n = actor.n_vertices();
  actor.skeleton.bones = {{"root", -1, {0, 0, 0}}};
  actor.skin.bones.assign(4 * n, 0);
  actor.skin.weights.assign(4 * n, 0);
  for (size_t i = 0; i < n; ++i) actor.skin.weights[4 * i] = 1;
  actor.labels.assign(n, 0);
  actor.colors.assign(3 * n, 0.5f);
  Skinner skinner(device, actor);
  DepthRasterizer raster(device, actor.mesh, camera.width, camera.height);
  SurfaceVisibility visibility(device, actor.mesh);
  TextureMatcher matcher(device, actor, camera, MatchOptions{});
  SkinShading shading(device, actor, camera, SkinShadingOptions{});
  ActorSight sight(device, camera, skinner, raster, visibility, matcher, shading);
  if (!sight.usable()) return {};
  ocl::Buffer<float> zero(device, 3 * n), skinned(device, 3 * n), normals(device, 3 * n);
  zero.fill(0);
  const ocl::Buffer<float> still(device, std::vector<float>{1, 0, 0, 0, 0, 0, 0, 0}),
      moved(device, std::vector<float>{INFINITY});
  matcher.set_box(frame, box);
  std::vector<ocl::SelfTestResult> results;
  for (int level = 0; level <= LC_MATCH_LEVELS; ++level) {
    const ocl::Buffer<int32_t> state(device, std::vector<int32_t>{0, 0});
    sight.look({.level = level,
                .new_picture = level == 0,
                .shades = false,
                .frame = frame,
                .motions = still,
                .displacement = zero,
                .share = share,
                .candidates = nullptr,
                .skinned = skinned,
                .normals = normals,
                .moved = moved,
                .least_moved_px = 0,
                .state = state});
    if (state.read_all()[1] != 0) return {};  // groups gave up waiting for each other: the launch is not used there
    results.push_back(
        match_result(format("match/see_actor.cl: level %d", level), actor, camera, matcher.read(), level));
  }
  return results;
}

}  // namespace

std::vector<ocl::SelfTestResult> match_self_test(ocl::DeviceContext& device) {
  const Actor actor = square();
  // A texel is two pixels wide.
  const Camera camera{
      .width = 192, .height = 192, .fx = 128 * kDepth / kSide, .fy = 128 * kDepth / kSide, .cx = 95.5, .cy = 95.5};
  ImageRgb picture{camera.width, camera.height, {}};
  Silhouette silhouette{camera.width, camera.height, {}, 0, {}};
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const double u = (x - kMovedX - camera.cx) / 128 + 0.5, v = (y - kMovedY - camera.cy) / 128 + 0.5;
      const bool inside = u >= 0 && u < 1 && v >= 0 && v < 1;
      const double tx = u * kTextureSize - 0.5, ty = v * kTextureSize - 0.5;
      const int x0 = std::clamp(int(std::floor(tx)), 0, kTextureSize - 2);
      const int y0 = std::clamp(int(std::floor(ty)), 0, kTextureSize - 2);
      const double top = texel(x0, y0) + (tx - x0) * (texel(x0 + 1, y0) - texel(x0, y0));
      const double bottom = texel(x0, y0 + 1) + (tx - x0) * (texel(x0 + 1, y0 + 1) - texel(x0, y0 + 1));
      const double light = inside ? in_less_light(top + (ty - y0) * (bottom - top)) : 0;
      picture.pixels.insert(picture.pixels.end(), 3, uint8_t(std::lround(std::clamp(light, 0.0, 255.0))));
      silhouette.signed_distance.push_back(inside ? -2.0f : 2.0f);
    }
  }
  silhouette.box = {32 + kMovedX, 32 + kMovedY, 160 + kMovedX, 160 + kMovedY};
  silhouette.area_px = 128 * 128;
  DeviceFrame frame(device, camera.width, camera.height);
  frame.upload(silhouette, picture);

  DepthRasterizer raster(device, actor.mesh, camera.width, camera.height);
  const ocl::Buffer<float> positions(device, actor.mesh.positions);
  std::vector<float> toward_camera(3 * size_t(actor.n_vertices()), 0.0f);
  for (size_t i = 2; i < toward_camera.size(); i += 3) toward_camera[i] = -1;
  const ocl::Buffer<float> normals(device, toward_camera);
  const ocl::Buffer<int32_t> visible(device, std::vector<int32_t>(actor.n_vertices(), 1));
  const ocl::Buffer<float> share(device, std::vector<float>(actor.n_vertices(), 1.0f));
  raster.render(positions, camera);

  std::vector<ocl::SelfTestResult> results;
  for (const char* program : {kMatchProgram, kClothMatchProgram}) {
    TextureMatcher matcher(device, actor, camera, MatchOptions{}, program);
    matcher.set_picture(frame, silhouette.box);
    for (int level = 0; level <= LC_MATCH_LEVELS; ++level) {
      matcher.match(raster, positions, normals, visible, share, level);
      results.push_back(match_result(format("%s: level %d", program, level), actor, camera, matcher.read(), level));
    }
    results.push_back(
        light_result(format("%s: light", program), frame, raster, positions, normals, visible, share, matcher));
    if (program == kClothMatchProgram)
      results.push_back(behind_result(device, actor, camera, raster, normals, matcher, share));
  }
  results.push_back(anew_result(device));
  results.push_back(skin_result(device, actor, camera, raster, positions, normals, visible));
  for (ocl::SelfTestResult& result : sight_results(device, actor, camera, frame, silhouette.box, share))
    results.push_back(std::move(result));
  return results;
}

}  // namespace livecap
