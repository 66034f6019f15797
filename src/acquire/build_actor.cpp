#include "acquire/build_actor.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "acquire/body_shape.h"
#include "acquire/facet_offsets.h"
#include "acquire/fair_surface.h"
#include "acquire/fit_outlines.h"
#include "acquire/hull.h"
#include "acquire/keypoints.h"
#include "acquire/material_labels.h"
#include "acquire/person_frame.h"
#include "acquire/photograph_scan.h"
#include "acquire/refine.h"
#include "acquire/skin_weights.h"
#include "acquire/surface_color.h"
#include "actor/labels.h"
#include "base/text.h"
#include "base/timer.h"
#include "livecap/error.h"
#include "meshing/nearest_vertex.h"
#include "scan/scan.h"
#include "texture/surface_views.h"
#include "views/fit_turn.h"
#include "views/run_colmap.h"
#include "views/sharpen_masks.h"
#include "views/turn_masks.h"

namespace livecap::acquire {

namespace {

using Eigen::Vector3d;

constexpr int kScanViews = 32;
constexpr int kMasksPerIgnored = 12;  // one of so many of a network's may be overruled at the feet
constexpr double kAssumedHeightMm = 1700;
constexpr double kLowOverlap = 0.9;  // of the surface with the masks; docs/actor_build.md

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
    stage("looking for the person", [&] { look_for_person(); });
    if (!network_masks_.empty() && options_.mesh.empty()) stage("sharpening masks", [&] { sharpen(); });
    stage("finding the person", [&] { find_person(); });
    if (parser_) stage("parsing", [&] { parse_views(); });
    if (options_.mesh.empty())
      stage("carving", [&] { carve(); });
    else
      stage("scan", [&] { take_scan(); });
    stage("thinning", [&] { thin(); });
    if (options_.refine && options_.mesh.empty()) stage("refining", [&] { refine(); });
    if (!shape_.as_is) move_along_normals(facet_offsets_mm_, surface());
    if (options_.mesh.empty()) {
      std::vector<SeenOutline> seen;
      stage("outlines", [&] {
        seen = seen_outlines(views_);
        fit_outlines(device_, views_, seen, lowest_fitted_mm(), surface());
      });
      stage("fairing", [&] { fair_surface(seen, shape_.volume, shape_.solid(), ankles_mm(), surface()); });
      stage("outlines again", [&] { fit_outlines(device_, views_, seen, lowest_fitted_mm(), surface()); });
    }
    stage("joints", [&] { place(); });
    stage("skin weights", [&] { result_.actor.weights = heat_weights(surface(), result_.joints, shape_.volume); });
    if (options_.has_pictures()) stage("visibility", [&] { find_visible(); });
    if (has_label_images()) stage("labels", [&] { vote(); });
    stage("texture", [&] { texture(); });
    if (result_.actor.labels.empty()) stage("guessing labels", [&] { guess(); });
    finish();
    return std::move(result_);
  }

 private:
  meshing::Surface& surface() { return result_.actor.surface; }
  void note(const std::string& text) { result_.notes.push_back(text); }
  bool tell(int done, int total) { return !progress_ || progress_(stage_, done, total); }
  void advance(int done, int total) {
    if (!tell(done, total)) throw Error("interrupted while " + stage_);
  }

  template <typename Work>
  void stage(const char* name, Work&& work) {
    stage_ = name;
    advance(0, 1);
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
    colmap_world_ = is_colmap_model(files.cameras.empty() ? find_view_poses(files.images) : files.cameras);
    if (colmap_world_ && given_height_mm_ == 0 && unit_in_mm(options_.unit) == 0)
      note(
          "the cameras are a COLMAP model, whose world has no unit unless somebody gave it one: that it has one is a "
          "guess (--height)");
  }

  // Without --height.
  void assume_height(const std::string& why) {
    if (given_height_mm_ > 0) return;
    given_height_mm_ = kAssumedHeightMm;
    note(why + format(": %.2f m is assumed (--height)", given_height_mm_ / 1000));
  }

  void watch_turn() {
    TurntableViews turn = read_turntable(network_device_, options_.model, options_.turntable, result_.notes,
                                         [&](int done, int total) { advance(done, total); });
    views_ = std::move(turn.views);
    turned_rad_ = std::move(turn.angle_rad);
    assume_height("one camera does not tell how tall somebody is");
  }

  void look_for_person() {
    detections_ = detect_in_views(network_device_, options_.model, views_, [&](int done, int total) {
      advance(done, total);
      return true;
    });
    for (size_t i = 0; i < views_.size(); ++i) {
      result_.n_detected += detections_[i].person;
      if (!views_[i].mask.empty() || detections_[i].mask.empty()) continue;
      views_[i].mask = {detections_[i].mask.width, detections_[i].mask.height, detections_[i].mask.probability};
      network_masks_.push_back(i);
    }
    if (result_.n_detected < kMinViews)
      throw ConfigError(format("the network sees a person in only %d of %zu pictures; at least %d are needed",
                               result_.n_detected, views_.size(), kMinViews));
    if (!turned_rad_.empty()) {
      if (mask_by_background(device_, views_))
        network_masks_.clear();
      else
        note("what is behind the person changes while they turn: did the camera move?");
    }
  }

  void sharpen() {
    note(format("%zu of %zu masks are the network's: the shape is coarser than with exact masks", network_masks_.size(),
                views_.size()));
    sharpen_masks(views_, network_masks_, [&](int done, int total) { advance(done, total); });
  }

  void find_person() {
    std::vector<Detections> detections = std::move(detections_);
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
      result_.n_detected = static_cast<int>(
          std::count_if(detections.begin(), detections.end(), [](const Detections& seen) { return seen.person; }));
    }
    const bool joints_may_be_given = turned_rad_.empty() && !colmap_;
    require_keypoints(world, given_joints_, joints_may_be_given ? ", or its place in --joints" : "");
    if (given_joints_.unit_mm == 0) take_given(given_joints_, frame_, world);  // it may tell how the person stands
    frame_ = find_person_frame(world, unit_in_mm(options_.unit), given_height_mm_, result_.notes,
                               colmap_world_ ? vertical_of(views_) : Vector3d(Vector3d::Zero()));
    take_given(given_joints_, frame_, world);
    move_views(frame_, views_);
    keypoints_ = move_keypoints(frame_, world);
    double sum = 0;
    int count = 0;
    for (const SpacePoint& point : keypoints_)
      if (point.n_inliers > 0) sum += point.spread_rad * point.spread_rad, ++count;
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
      advance(static_cast<int>(i), static_cast<int>(views_.size()));
      views_[i].labels = parser_->labels(views_[i].image, views_[i].mask);
    }
    parser_.reset();
  }

  void carve() {
    // One mask that was not given may have a hole; of a network's several may lack part of a shoe.
    const int n_rough = static_cast<int>(std::count_if(
        views_.begin(), views_.end(), [](const View& view) { return !view.mask.empty() && !view.exact_mask; }));
    const int n_ignored = std::min(1, n_rough);
    const int n_ignored_feet = network_masks_.empty()
                                   ? n_ignored
                                   : std::clamp(n_rough / kMasksPerIgnored, n_ignored, HullOptions::kMostIgnored);
    shape_ = carve_body(device_, views_, keypoints_, options_.grid_mm, n_ignored, n_ignored_feet, result_.notes);
  }

  void take_scan() {
    for (Vector3d& p : scan_.surface.vertices) p = frame_.to_rest(p);
    if (const double dropped = keep_largest_piece(scan_); dropped > 1e-3)
      note(format("%.1f %% of the scan's area is not connected to the rest and is left out", 100 * dropped));
    shape_ = shape_of_scan(scan_.surface, result_.notes);
  }

  void thin() {
    surface() = thin_shape(shape_, options_.target_vertices, facet_offsets_mm_, result_.notes);
    const PersonFrame down = stand_on_floor(surface(), given_height_mm_, height_mm_);
    for (Vector3d& p : surface().vertices) p = down.to_rest(p);
    move_views(down, views_);
    keypoints_ = move_keypoints(down, keypoints_);
    for (double& offset : facet_offsets_mm_) offset *= down.scale_mm;
    move_volume(down, shape_.volume);
    if (shape_.wears_skirt()) move_volume(down, shape_.open);
    for (Vector3d& p : scan_.surface.vertices) p = down.to_rest(p);
    frame_ = composed(down, frame_);
  }

  // Of pictures shoes stay as the hull has them: captures of bent legs need them so (docs/experiments_actor.md, "An
  // even mesh"). A turn's hull lacks 3 % of them.
  double lowest_fitted_mm() const {
    return turned_rad_.empty() ? ankles_mm() : -std::numeric_limits<double>::infinity();
  }

  double ankles_mm() const { return (keypoints_[kLeftAnkle].position.y() + keypoints_[kRightAnkle].position.y()) / 2; }

  void refine() {
    const RefineResult refined = refine_by_color(views_, cover_surface(device_, mesh_of(surface()), views_), surface());
    if (refined.n_evidence * 5 < static_cast<int>(surface().vertices.size()))
      note(format(
          "only %d of %zu vertices have enough texture to see hollows; elsewhere the shape is the silhouettes' hull",
          refined.n_evidence, surface().vertices.size()));
  }

  void place() {
    result_.joints = place_joints(keypoints_, height_mm_, shape_.volume, result_.notes);
    make_symmetric(result_.joints);
    if (!options_.joints.empty()) override_joints(given_joints_, frame_, result_.joints);
    for (const auto& [name, position] : face_markers(keypoints_, given_joints_, frame_))
      result_.actor.markers.emplace_back(name, meshing::nearest_vertex(surface(), position));
  }

  void find_visible() {
    coverage_ = cover_surface(device_, mesh_of(surface()), views_);
    result_.overlap = mean_overlap(coverage_);
    if (options_.mesh.empty() && result_.overlap < kLowOverlap)
      note(
          format("the built surface covers the masks by %.3f only (IoU, mean over the pictures; good builds have 0.93 "
                 "and more): are all pictures of one person who did not move?",
                 result_.overlap));
  }

  bool has_label_images() const {
    return options_.has_pictures() &&
           std::any_of(views_.begin(), views_.end(), [](const View& view) { return !view.labels.empty(); });
  }

  // No labels when the label images say nothing.
  void vote() {
    MaterialLabels voted = vote_labels(surface(), views_, coverage_);
    const int n = static_cast<int>(voted.labels.size());
    if (voted.foreign > 0.02)
      note(
          format("%.0f %% of the label images' pixels on the person are above %d: they must hold LIP ids, one byte a "
                 "pixel, not colours",
                 100 * voted.foreign, kLabelCount - 1));
    int n_visible = 0;
    for (int i = 0; i < n; ++i) {
      bool visible = false;
      for (size_t v = 0; v < views_.size(); ++v)
        visible |= !views_[v].labels.empty() && coverage_[v].facing[i] > kEdgeOn;
      n_visible += visible;
    }
    if (voted.foreign > 0.5 || 2 * (n - voted.n_unseen) < n_visible) {
      note(format("the label images say nothing about %d of %d vertices", voted.n_unseen, n));
      return;
    }
    if (voted.n_unseen > 0)
      note(format("%d vertices have no label in enough pictures; they have the nearest one along the surface",
                  voted.n_unseen));
    result_.actor.labels = std::move(voted.labels);
  }

  void texture() {
    result_.actor.atlas = body_atlas(surface(), result_.actor.weights, options_.texture_size);
    if (!options_.has_pictures()) {
      result_.actor.texture =
          texture_from_scan(surface(), result_.actor.atlas, options_.texture_size, scan_, result_.notes);
      return;
    }
    const LightFrame light_frame = turned_rad_.empty() ? LightFrame::kPerson : LightFrame::kCamera;
    BlendedTexture blended = texture_from_views(surface(), result_.actor.atlas, options_.texture_size, views_,
                                                coverage_, result_.actor.labels, light_frame, result_.notes);
    result_.actor.texture = std::move(blended.image);
    result_.seen = std::move(blended.seen);
  }

  void guess() {
    result_.actor.labels = guess_labels({surface(), result_.actor.weights, result_.joints, shape_.volume,
                                         vertex_colors(surface(), result_.actor.atlas, result_.actor.texture),
                                         result_.actor.marker_vertex("nose"), well_seen(coverage_)});
    note(has_label_images() ? "the materials are guessed from body parts and colours instead"
                            : "no label images: materials are guessed from body parts and colours");
  }

  void finish() {
    result_.actor.name = options_.name;
    result_.actor.guessed_weights = true;
    result_.actor.rough_shape = options_.mesh.empty() && !turned_rad_.empty();
    for (int bone = 0; bone < kBodyBoneCount; ++bone)
      result_.actor.bones.push_back({kBodyBones[bone].name, kBodyBones[bone].parent, result_.joints[bone]});
  }

  ocl::DeviceContext& network_device_;
  ocl::DeviceContext& device_;
  const BuildOptions& options_;
  const BuildProgress& progress_;
  std::string stage_;
  std::unique_ptr<ColmapRun> colmap_;
  bool colmap_world_ = false;  // whose axes and unit mean nothing, unless somebody aligned it
  std::unique_ptr<ParsingNetwork> parser_;
  std::vector<View> views_;             // in the rest frame once the person is found
  std::vector<Detections> detections_;  // in the views, until the person is found
  std::vector<size_t> network_masks_;   // views whose mask is a network's, before some are left out
  std::vector<double> turned_rad_;      // of a turntable video's views, as the network sees it
  double given_height_mm_;              // 0: the cameras' world has a unit
  GivenJoints given_joints_;
  SpaceKeypoints keypoints_;
  std::vector<double> facet_offsets_mm_;
  PersonFrame frame_;
  BodyShape shape_;
  Scan scan_;  // moved into the rest frame with the person
  double height_mm_ = 0;
  std::vector<ViewCoverage> coverage_;
  BuildResult result_;
};

}  // namespace

BuildResult build_actor(ocl::DeviceContext& network_device, ocl::DeviceContext& device, const BuildOptions& options,
                        const BuildProgress& progress) {
  options.validate();
  return Builder(network_device, device, options, progress).run();
}

}  // namespace livecap::acquire
