#include "acquire/build_actor.h"

#include <algorithm>
#include <cmath>
#include <memory>

#include "acquire/facet_offsets.h"
#include "acquire/hull.h"
#include "acquire/keypoints.h"
#include "acquire/material_labels.h"
#include "acquire/open_skirt.h"
#include "acquire/person_frame.h"
#include "acquire/photograph_scan.h"
#include "acquire/refine.h"
#include "acquire/skin_weights.h"
#include "base/text.h"
#include "base/timer.h"
#include "livecap/error.h"
#include "scan/mesh_volume.h"
#include "scan/scan.h"
#include "texture/surface_views.h"
#include "texture/texture.h"
#include "views/fit_turn.h"
#include "views/run_colmap.h"

namespace livecap::acquire {

namespace {

using Eigen::Vector3d;

constexpr int kScanViews = 32;
constexpr double kSearchGridMm = 30;
constexpr double kScanGridMm = 7;
constexpr double kAssumedHeightMm = 1700;
constexpr double kLowestMm = 800, kTallestMm = 2500;  // of a person
constexpr double kLowOverlap = 0.9;                   // of the surface with the masks; docs/actor_build.md
constexpr size_t kMostTriangles = 1500000;            // thinned one edge at a time

class Builder {
 public:
  Builder(ocl::DeviceContext& network_device, ocl::DeviceContext& device, const BuildOptions& options,
          const BuildProgress& progress)
      : network_device_(network_device),
        device_(device),
        options_(options),
        progress_(progress),
        given_height_mm_(options.height_mm) {}

  BuildResult run() {
    if (!options_.joints.empty()) given_joints_ = read_joints(options_.joints);
    if (!options_.parser.network.empty())
      stage("loading the parser",
            [&] { parser_ = std::make_unique<ParsingNetwork>(network_device_, options_.parser); });
    if (!options_.mesh.empty()) stage("reading the scan", [&] { scan_ = read_scan(options_.mesh, result_.notes); });
    if (!options_.views.images.empty() && options_.colmap) stage("finding the cameras", [&] { run_colmap(); });
    if (!options_.views.images.empty())
      stage("reading pictures", [&] { read_pictures(); });
    else if (!options_.turntable.video.empty())
      stage("watching the turn", [&] { watch_turn(); });
    else
      stage("looking at the scan", [&] { views_ = photograph_scan(scan_, kScanViews); });
    result_.n_views = static_cast<int>(views_.size());
    stage("finding the person", [&] { find_person(); });
    if (parser_) stage("parsing", [&] { parse_views(); });
    if (options_.mesh.empty())
      stage("carving", [&] { carve(); });
    else
      stage("scan", [&] { take_scan(); });
    stage("thinning", [&] { thin(); });
    if (options_.refine && options_.mesh.empty()) stage("refining", [&] { refine(); });
    if (!as_is_) move_along_normals(facet_offsets_mm_, surface());
    stage("joints", [&] { place(); });
    stage("skin weights", [&] { result_.actor.weights = heat_weights(surface(), result_.joints, volume_); });
    stage("texture", [&] { texture(); });
    stage("labels", [&] { label(); });
    finish();
    return std::move(result_);
  }

 private:
  meshing::Surface& surface() { return result_.actor.surface; }
  void note(const std::string& text) { result_.notes.push_back(text); }
  bool tell(int done, int total) { return !progress_ || progress_(stage_, done, total); }

  template <typename Work>
  void stage(const char* name, Work&& work) {
    stage_ = name;
    if (!tell(0, 1)) throw Error("interrupted while " + stage_);
    const Timer timer;
    work();
    result_.stage_s.emplace_back(name, timer.elapsed_ms() / 1000);
  }

  void run_colmap() {
    colmap_ = std::make_unique<ColmapRun>(options_.views.images, result_.notes,
                                          [&](int done, int total) { return tell(done, total); });
    assume_height("COLMAP's world has no unit");
  }

  void read_pictures() {
    ViewFiles files = options_.views;
    if (colmap_) files.cameras = colmap_->model();
    views_ = load_views(files, result_.notes);
  }

  // Without --height.
  void assume_height(const std::string& why) {
    if (given_height_mm_ > 0) return;
    given_height_mm_ = kAssumedHeightMm;
    note(why + format(": %.2f m is assumed (--height)", given_height_mm_ / 1000));
  }

  void watch_turn() {
    TurntableViews turn =
        read_turntable(network_device_, options_.model, options_.turntable, result_.notes, [&](int done, int total) {
          if (!tell(done, total)) throw Error("interrupted while " + stage_);
        });
    views_ = std::move(turn.views);
    turned_rad_ = std::move(turn.angle_rad);
    assume_height("one camera does not tell how tall somebody is");
  }

  void find_person() {
    auto detections = detect_in_views(network_device_, options_.model, views_, [&](int done, int total) {
      if (!tell(done, total)) throw Error("interrupted while " + stage_);
      return true;
    });
    for (size_t i = 0; i < views_.size(); ++i) {
      result_.n_detected += detections[i].person;
      if (!views_[i].mask.empty() || detections[i].mask.empty()) continue;
      views_[i].mask = {detections[i].mask.width, detections[i].mask.height, detections[i].mask.probability};
      ++n_network_masks_;
    }
    if (result_.n_detected < kMinViews)
      throw ConfigError(format("the network sees a person in only %d of %zu pictures; at least %d are needed",
                               result_.n_detected, views_.size(), kMinViews));
    if (n_network_masks_ > 0 && options_.mesh.empty())
      note(format("%d of %zu masks are the network's: the shape is about 1 %% coarser than with exact masks",
                  n_network_masks_, views_.size()));
    if (!turned_rad_.empty()) {
      const TurnFit fit = fit_turn(views_, detections, turned_rad_, result_.notes);
      result_.turn =
          format("turned %.0f degrees: %d points of the clothes followed to %.2f px, beside the axis by %.0f mm",
                 std::abs(fit.turn.angle_rad.back() - fit.turn.angle_rad.front()) * 180 / M_PI, fit.n_tracks,
                 fit.track_px, fit.sway_mm);
    }
    SpaceKeypoints world = triangulate_keypoints(views_, detections);
    if (options_.has_pictures() && leave_out_disagreeing(world, detections)) {
      world = triangulate_keypoints(views_, detections);
      result_.n_views = static_cast<int>(views_.size());
    }
    frame_ = find_person_frame(world, unit_in_mm(options_.unit), given_height_mm_, result_.notes,
                               colmap_ ? vertical_of(views_) : Vector3d(Vector3d::Zero()));
    move_views(frame_, views_);
    keypoints_ = move_keypoints(frame_, world);
    double sum = 0;
    int count = 0;
    for (const SpacePoint& point : keypoints_)
      if (point.found) sum += point.spread_rad * point.spread_rad, ++count;
    result_.keypoint_rad = count > 0 ? std::sqrt(sum / count) : 0;
    if (result_.keypoint_rad > 0.02)
      note(format(
          "the keypoints of the pictures disagree by %.1f degrees: did the person move, or are the cameras wrong?",
          result_.keypoint_rad * 180 / M_PI));
  }

  // Views whose cameras contradict the others'. True when there were some.
  bool leave_out_disagreeing(const SpaceKeypoints& world, std::vector<Detections>& detections) {
    const std::vector<char> agrees = agreeing_views(views_, detections, world);
    const int n_wrong = static_cast<int>(std::count(agrees.begin(), agrees.end(), 0));
    if (n_wrong == 0 || static_cast<int>(views_.size()) - n_wrong < kMinViews) return false;
    std::vector<View> views;
    std::vector<Detections> kept;
    std::string names;
    for (size_t i = 0; i < agrees.size(); ++i) {
      if (agrees[i]) {
        views.push_back(std::move(views_[i]));
        kept.push_back(std::move(detections[i]));
      } else {
        names += (names.empty() ? "" : ", ") + views_[i].name;
      }
    }
    note(format("%d pictures show the person elsewhere than the others do, their cameras are wrong; left out: %s",
                n_wrong, names.c_str()));
    views_ = std::move(views);
    detections = std::move(kept);
    return true;
  }

  void parse_views() {
    for (size_t i = 0; i < views_.size(); ++i) {
      if (!tell(static_cast<int>(i), static_cast<int>(views_.size()))) throw Error("interrupted while " + stage_);
      views_[i].labels = parser_->labels(views_[i].image, views_[i].mask);
    }
    parser_.reset();
  }

  void carve() {
    Vector3d low = Vector3d::Constant(1e9), high = -low;
    for (const SpacePoint& point : keypoints_) {
      if (!point.found) continue;
      low = low.cwiseMin(point.position);
      high = high.cwiseMax(point.position);
    }
    low -= Vector3d(250, 200, 420);
    high += Vector3d(250, 400, 420);
    HullOptions hull;
    hull.n_ignored = n_network_masks_ > 0 ? 2 : 0;
    // Coarsely first: where the body is. A node farther than half a cell's diagonal from the hull has none of it in its
    // cell.
    hull.step_mm = kSearchGridMm;
    volume_ = make_volume(low, high, hull.step_mm);
    carve_hull(device_, views_, hull, volume_);
    if (const auto [near_low, near_high] = bounds_within(volume_, hull.step_mm);
        (near_low.array() < near_high.array()).all()) {
      low = near_low;
      high = near_high;
    }
    hull.step_mm = options_.grid_mm;
    volume_ = make_volume(low, high, hull.step_mm);
    carve_hull(device_, views_, hull, volume_);
    Volume open = volume_;
    const bool skirt = open_skirt(keypoints_, open);
    blur(volume_, 0.8 * options_.grid_mm, 0.35 * options_.grid_mm);
    if (const int dropped = keep_largest_solid(volume_); dropped > 0)
      note(format("%d other solids in the pictures' common view were dropped", dropped));
    if (!skirt) return;
    blur(open, 0.8 * options_.grid_mm, 0.35 * options_.grid_mm);
    keep_largest_solid(open);
    open_volume_ = std::move(open);
  }

  // The scan in the rest frame, as it is when it is closed and clean, else as a solid on a grid.
  void take_scan() {
    fine_ = scan_.surface;
    for (Vector3d& p : fine_.vertices) p = frame_.to_rest(p);
    scan_.surface.vertices = fine_.vertices;
    if (const double dropped = keep_largest_piece(fine_); dropped > 1e-3)
      note(format("%.1f %% of the scan's area is not connected to the rest and is left out", 100 * dropped));
    const bool clean = is_closed_manifold(fine_);
    const bool huge = fine_.triangles.size() > kMostTriangles;
    volume_ = volume_of(fine_, kScanGridMm);
    as_is_ = clean && !huge;
    if (as_is_) return;
    note(clean ? format("the scan has %zu triangles: resampled on a grid of %g mm", fine_.triangles.size(), kScanGridMm)
               : format("the scan is not closed or not manifold: rebuilt as a solid on a grid of %g mm", kScanGridMm));
    if (!clean) blur(volume_, 0.5 * kScanGridMm);
    keep_largest_solid(volume_);
  }

  void thin() {
    const Volume& shape = open_volume_.size() > 0 ? open_volume_ : volume_;
    if (!as_is_) fine_ = surface_of(shape);
    const double density = std::sqrt(5000.0 / options_.target_vertices);
    const meshing::DistanceField field = [&](const Vector3d& p) { return shape.at(p); };
    surface() = meshing::decimate_surface(fine_, options_.target_vertices, 48 * density,
                                          as_is_ ? meshing::DistanceField{} : field, 3 * density);
    fine_ = {};
    // Refining looks for the surface at the vertices: they move only then.
    if (!as_is_) facet_offsets_mm_ = facet_offsets(surface(), shape);
    if (surface().vertices.size() < 200 || !is_closed_manifold(surface()))
      throw ConfigError(
          format("the shape has no closed surface of a person (%zu vertices left)", surface().vertices.size()));
    // The soles are the floor.
    double bottom = 1e9, top = -1e9;
    for (const Vector3d& p : surface().vertices) bottom = std::min(bottom, p.y()), top = std::max(top, p.y());
    double scale = 1;
    if (given_height_mm_ > 0) scale = given_height_mm_ / (top - bottom);
    height_mm_ = scale * (top - bottom);
    if (height_mm_ < kLowestMm || height_mm_ > kTallestMm)
      throw ConfigError(format("the body is %.0f mm tall; --unit or --height", height_mm_));
    PersonFrame down;
    down.scale_mm = scale;
    down.translation_mm = Vector3d(0, -scale * bottom, 0);
    for (Vector3d& p : surface().vertices) p = down.to_rest(p);
    move_views(down, views_);
    keypoints_ = move_keypoints(down, keypoints_);
    for (double& offset : facet_offsets_mm_) offset *= scale;
    volume_.low = down.to_rest(volume_.low);
    volume_.step *= scale;
    for (float& d : volume_.distance) d *= static_cast<float>(scale);
    for (Vector3d& p : scan_.surface.vertices) p = down.to_rest(p);
    frame_.translation_mm = scale * frame_.translation_mm + down.translation_mm;
    frame_.scale_mm *= scale;
  }

  void refine() {
    const RefineResult refined =
        refine_by_color(views_, cover_surface(device_, mesh_of(surface()), views_), {}, surface());
    if (refined.n_evidence * 5 < static_cast<int>(surface().vertices.size()))
      note(format(
          "only %d of %zu vertices have enough texture to see hollows; elsewhere the shape is the silhouettes' hull",
          refined.n_evidence, surface().vertices.size()));
  }

  void place() {
    result_.joints = place_joints(keypoints_, height_mm_, volume_, result_.notes);
    make_symmetric(result_.joints);
    if (!options_.joints.empty()) override_joints(given_joints_, frame_, result_.joints);
    for (const auto& [name, position] : face_markers(keypoints_, given_joints_, frame_)) {
      int best = 0;
      for (size_t i = 1; i < surface().vertices.size(); ++i)
        if ((surface().vertices[i] - position).squaredNorm() < (surface().vertices[best] - position).squaredNorm())
          best = static_cast<int>(i);
      result_.actor.markers.emplace_back(name, best);
    }
  }

  void texture() {
    if (!options_.has_pictures()) {
      texture_from_scan();
      return;
    }
    coverage_ = cover_surface(device_, mesh_of(surface()), views_);
    result_.overlap = mean_overlap(coverage_);
    if (options_.mesh.empty() && result_.overlap < kLowOverlap)
      note(
          format("the built surface covers the masks by %.3f only (IoU, mean over the pictures; good builds have 0.93 "
                 "and more): are all pictures of one person who did not move?",
                 result_.overlap));
    result_.actor.atlas =
        meshing::make_atlas(surface(), std::vector<int>(surface().triangles.size(), 0), {1.0}, options_.texture_size);
    BlendedTexture blended = blend_texture(surface(), result_.actor.atlas, options_.texture_size, views_, coverage_);
    result_.actor.texture = std::move(blended.image);
    result_.seen = std::move(blended.seen);
    if (const auto unseen = std::count(result_.seen.begin(), result_.seen.end(), 0); unseen > 0)
      note(format("%d vertices are seen by no picture; their colour is spread from their neighbours",
                  static_cast<int>(unseen)));
  }

  void texture_from_scan() {
    if (!scan_.has_color()) note("the scan has no colour: every vertex is grey, colour cannot guide the surface");
    result_.actor.atlas =
        meshing::make_atlas(surface(), std::vector<int>(surface().triangles.size(), 0), {1.0}, options_.texture_size);
    if (!scan_.has_color()) {
      const size_t n = static_cast<size_t>(3) * options_.texture_size * options_.texture_size;
      result_.actor.texture = {options_.texture_size, options_.texture_size, std::vector<uint8_t>(n, 153)};
      return;
    }
    // Cells of about three edges of the scan.
    const double cell = 3 * std::sqrt(3e6 / static_cast<double>(scan_.surface.triangles.size()));
    const meshing::NearestSurface near(scan_.surface, std::clamp(cell, 4.0, 40.0));
    result_.actor.texture = meshing::bake_texture(surface(), result_.actor.atlas, options_.texture_size,
                                                  [&](const Vector3d& p, int) { return scan_.color_at(near.find(p)); });
  }

  void label() {
    const bool given = std::any_of(views_.begin(), views_.end(), [](const View& view) { return !view.labels.empty(); });
    if (given && options_.has_pictures() && vote()) return;
    result_.actor.labels =
        guess_labels({surface(), result_.actor.weights, result_.joints, volume_, vertex_colors(), nose_vertex()});
    note(given ? "the materials are guessed from body parts and colours instead"
               : "no label images: materials are guessed from body parts and colours");
  }

  // False when the label images say nothing.
  bool vote() {
    MaterialLabels voted = vote_labels(surface(), views_, coverage_);
    const int n = static_cast<int>(voted.labels.size());
    if (voted.foreign > 0.02)
      note(
          format("%.0f %% of the label images' pixels on the person are above 19: they must hold LIP ids, one byte a "
                 "pixel, not colours",
                 100 * voted.foreign));
    const auto n_seen = std::count(result_.seen.begin(), result_.seen.end(), 1);
    if (voted.foreign > 0.5 || 2 * (n - voted.n_unseen) < n_seen) {
      note(format("the label images say nothing about %d of %d vertices", voted.n_unseen, n));
      return false;
    }
    if (voted.n_unseen > 0)
      note(format("%d vertices have no label in any picture; they have their neighbours'", voted.n_unseen));
    result_.actor.labels = std::move(voted.labels);
    return true;
  }

  // Of the texture, at each vertex.
  std::vector<Vector3d> vertex_colors() const {
    const meshing::Atlas& atlas = result_.actor.atlas;
    const ImageRgb& image = result_.actor.texture;
    std::vector<Vector3d> colors(result_.actor.surface.vertices.size(), Vector3d::Constant(0.5));
    for (size_t i = 0; i < atlas.vertex.size(); ++i) {
      const int x = std::clamp(static_cast<int>(atlas.uvs[i].x() * image.width), 0, image.width - 1),
                y = std::clamp(static_cast<int>(atlas.uvs[i].y() * image.height), 0, image.height - 1);
      const uint8_t* p = &image.pixels[3 * (static_cast<size_t>(y) * image.width + x)];
      colors[atlas.vertex[i]] = Vector3d(p[0], p[1], p[2]) / 255;
    }
    return colors;
  }

  int nose_vertex() const {
    for (const auto& [name, vertex] : result_.actor.markers)
      if (name == "nose") return vertex;
    return -1;
  }

  void finish() {
    result_.actor.name = options_.name;
    result_.actor.guessed_weights = true;
    for (int bone = 0; bone < kBodyBoneCount; ++bone)
      result_.actor.bones.push_back({kBodyBones[bone].name, kBodyBones[bone].parent, result_.joints[bone]});
  }

  ocl::DeviceContext& network_device_;
  ocl::DeviceContext& device_;
  const BuildOptions& options_;
  const BuildProgress& progress_;
  std::string stage_;
  std::unique_ptr<ColmapRun> colmap_;
  std::unique_ptr<ParsingNetwork> parser_;
  std::vector<View> views_;  // in the rest frame once the person is found
  int n_network_masks_ = 0;
  std::vector<double> turned_rad_;  // of a turntable video's views, as the network sees it
  double given_height_mm_;          // 0: the cameras' world has a unit
  GivenJoints given_joints_;
  SpaceKeypoints keypoints_;
  std::vector<double> facet_offsets_mm_;
  Volume open_volume_;  // the hull with an open skirt; none: there is no skirt. `volume_` tells what is under cloth
  PersonFrame frame_;
  Volume volume_;
  Scan scan_;           // moved into the rest frame with the person
  bool as_is_ = false;  // the scan is thinned as it is, without a grid
  meshing::Surface fine_;
  double height_mm_ = 0;
  std::vector<ViewCoverage> coverage_;
  BuildResult result_;
};

}  // namespace

void BuildOptions::validate() const {
  if (!turntable.video.empty()) {
    turntable.validate();
    for (const auto& [option, given] : {std::pair{"--images", !views.images.empty()},
                                        {"--cameras", !views.cameras.empty()},
                                        {"--masks", !views.masks.empty()},
                                        {"--labels", !views.labels.empty()},
                                        {"--mesh", !mesh.empty()},
                                        {"--joints", !joints.empty()}})
      if (given) throw ConfigError(std::string(option) + " does not go with --video, which finds its cameras itself");
  } else if (!turntable.camera.empty() || turntable.fov_deg > 0) {
    throw ConfigError("--camera and --fov belong to --video; the cameras of pictures are given by --cameras");
  }
  if (colmap) {
    if (views.images.empty()) throw ConfigError("--colmap needs --images, the pictures whose cameras it finds");
    for (const auto& [option, given] :
         {std::pair{"--cameras", !views.cameras.empty()}, {"--mesh", !mesh.empty()}, {"--joints", !joints.empty()}})
      if (given) throw ConfigError(std::string(option) + " does not go with --colmap, which makes a world of its own");
  }
  if (!parser.network.empty()) {
    parser.validate();
    if (!has_pictures()) throw ConfigError("--parser needs pictures: --images or --video");
    if (!views.labels.empty()) throw ConfigError("--labels does not go with --parser, which makes the label images");
  }
  if (!has_pictures() && mesh.empty())
    throw ConfigError(
        "--images, --video or --mesh is needed: pictures of the person, a video of them turning, or a scan");
  unit_in_mm(unit);
  if (target_vertices < 500 || target_vertices > 40000)
    throw ConfigError(format("--vertices %d; must be within 500..40000", target_vertices));
  if (!(height_mm == 0 || (height_mm >= kLowestMm && height_mm <= kTallestMm)))
    throw ConfigError(format("--height %g m; must be within 0.8..2.5", height_mm / 1000));
  if (!(grid_mm >= 3 && grid_mm <= 30)) throw ConfigError(format("--grid %g mm; must be within 3..30", grid_mm));
  if (texture_size < 128 || texture_size > 8192)
    throw ConfigError(format("--texture %d; must be within 128..8192", texture_size));
}

BuildResult build_actor(ocl::DeviceContext& network_device, ocl::DeviceContext& device, const BuildOptions& options,
                        const BuildProgress& progress) {
  options.validate();
  return Builder(network_device, device, options, progress).run();
}

}  // namespace livecap::acquire
