#include "capture/surface_stage.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "capture/pose_shares.h"
#include "cloth/cloth_graph.h"

namespace livecap {
namespace {

// s. Velocities are differences over at least so long: frames come in bunches, with time stamps that hardly differ.
constexpr double kShortestFrame = 1 / 240.0;
// After a longer gap cloth begins anew: nothing is known of how the body moved.
constexpr double kLongestFrame = 0.1;
constexpr double kUnknownFrame = 1 / 30.0;  // where time does not rise

// Where cloth is simulated, linings move as the cloth that they lie on.
SkinWeights skinning(const Actor& actor, const TrackerOptions& options, const HangingCloth& hanging, float looseness) {
  if (!options.enable_surface || !options.simulate_cloth) return hanging.weights();
  const float held = options.cloth.fabric(looseness).max_held_leg_weight;
  return with_followers(actor, make_cloth_graph(actor, held), hanging.weights(), looseness);
}

}  // namespace

SurfaceStage::SurfaceStage(ocl::DeviceContext& device, const Actor& actor, const Camera& camera,
                           const TrackerOptions& options, DepthRasterizer& rasterizer, SurfaceVisibility& visibility)
    : device_(device),
      actor_(actor),
      camera_(camera),
      options_((options.validate(), options)),
      looseness_(livecap::looseness(actor, options.hanging)),
      hanging_(actor, options.hanging),
      skinner_(device, actor, skinning(actor, options, hanging_, looseness_), actor.skeleton.n_bones() + 1),
      template_skinner_(device, actor),
      rasterizer_(rasterizer),
      visibility_(visibility),
      part_mask_(device, actor.mesh, body_parts_of_vertices(actor.skeleton, actor.skin), camera.width, camera.height),
      solver_(device, actor, camera, options.surface),
      snapper_(device, actor, solver_.domain(), options.snap) {
  for (ocl::Buffer<float>* buffer :
       {&displacement_rest_, &before_displacement_rest_, &zero_, &start_, &skinned_, &normals_, &vertices_, &before_}) {
    *buffer = ocl::Buffer<float>(device, size_t(3) * actor.n_vertices());
    buffer->fill(0);
  }
  if (options.enable_surface && options.simulate_cloth) cloth_.emplace(device, actor, options.cloth, looseness_);
  std::vector<float> share(actor.n_vertices());
  const float hanging_share = std::lerp(options.taut_carried_share, options.loose_carried_share, looseness_);
  for (int i = 0; i < actor.n_vertices(); ++i)
    share[i] = actor.rigidity[i] > options.max_carried_rigidity ? 0.0f
               : hangs(actor, i)                                ? hanging_share
                                                                : options.worn_carried_share;
  carried_share_ = ocl::Buffer<float>(device, share);
  if (!options.enable_surface || options.surface.w_match <= 0 || options.cloth_match_levels.empty()) return;
  std::vector<float> hanging(actor.n_vertices());
  for (int i = 0; i < actor.n_vertices(); ++i) hanging[i] = hangs(actor, i) ? 1.0f : 0.0f;
  if (std::count(hanging.begin(), hanging.end(), 1.0f) == 0) return;
  hangs_ = ocl::Buffer<float>(device, hanging);
  cloth_matcher_.emplace(device, actor, camera, options_for(actor, options).match, kClothMatchProgram);
  if (!cloth_matcher_->usable()) {
    cloth_matcher_.reset();
  } else if (options.behind_share > 0) {
    cloth_behind_.emplace(device, camera, options.behind_share);
  }
  if (cloth_matcher_ && options.anew_share > 0 && options.warp_displacements)
    cloth_anew_.emplace(device, actor.n_vertices(), options.anew_share);
  if (cloth_matcher_ && cloth_ && cloth_->has_cloth() && options.learn_drape)
    drape_.emplace(device, actor, cloth_->cloth(), looseness_, camera, options.drape);
}

void SurfaceStage::reset() {
  n_history_ = 0;
  if (cloth_) cloth_->reset();
  if (drape_) drape_->reset();
  displacement_rest_.fill(0);
  before_displacement_rest_.fill(0);
}

void SurfaceStage::skin_template(const Pose& pose) {
  template_skinner_.set_pose(bone_dual_quats(forward_kinematics(actor_.skeleton, pose)));
  template_skinner_.skin(zero_, vertices_);
}

// What the camera sees of these vertices, and what they are drawn to.
SurfaceInput SurfaceStage::seen_from(const ocl::Buffer<float>& vertices, const DeviceFrame& picture) {
  skinner_.normals(vertices, normals_);
  rasterizer_.render(vertices, camera_);
  visibility_.find_visible_and_contour(vertices, normals_, rasterizer_);
  return {.frame = picture,
          .skinned = skinned_,
          .start = vertices,
          .previous = n_history_ >= 1 ? &start_ : nullptr,
          .before_previous = n_history_ >= 2 ? &before_ : nullptr,
          .visible = visibility_.visible(),
          .contour_flag = visibility_.contour(),
          .normals = normals_,
          .part_image = options_.part_mask ? &part_mask_.part_image() : nullptr,
          .vertex_part = options_.part_mask ? &part_mask_.vertex_part() : nullptr};
}

// From the skinned template with the displacement on it to the vertices. What hangs is matched with the picture at each
// level in turn: at the first from the start, and from the template alone, for the first steps, at each further one
// from where the steps before left it, for one step.
void SurfaceStage::launch(const DeviceFrame& picture, const PixelBox& person) {
  const std::vector<int>& levels = options_.cloth_match_levels;
  const std::span<const int> steps = options_.surface.gaussian_kernels;
  if (cloth_matcher_) cloth_matcher_->set_picture(picture, person, *std::min_element(levels.begin(), levels.end()));
  const size_t n_looks = cloth_matcher_ ? levels.size() : 1;
  const bool anew = cloth_anew_ && n_history_ > 0;  // else nothing was carried on
  if (anew) {
    skinner_.normals(skinned_, normals_);
    rasterizer_.render(skinned_, camera_);
    visibility_.find_visible(skinned_, normals_, rasterizer_);
    cloth_matcher_->match(rasterizer_, skinned_, normals_, visibility_.visible(), hangs_, levels[0]);
    cloth_anew_->keep(cloth_matcher_->matches());
  }
  for (size_t look = 0, done = 0; look < n_looks; ++look) {
    const bool last = look + 1 == n_looks;
    const ocl::Buffer<float>& from = look == 0 ? start_ : vertices_;
    SurfaceInput input = seen_from(from, picture);
    input.continues = look > 0;
    if (look == 0 && options_.part_mask) part_mask_.update(rasterizer_);
    if (cloth_matcher_) {
      cloth_matcher_->match(rasterizer_, from, normals_, visibility_.visible(), hangs_, levels[look]);
      if (look == 0 && anew) cloth_anew_->choose(cloth_matcher_->matches());
      if (cloth_behind_)
        cloth_behind_->match(rasterizer_, start_, hangs_, visibility_.visible(), cloth_matcher_->matches());
      input.matches = &cloth_matcher_->matches();
    }
    const size_t count = look == 0 ? steps.size() - (n_looks - 1) : 1;
    solver_.launch(input, steps.subspan(done, count));
    done += count;
    if (last) solver_.measure(input);
    vertices_.copy_from(solver_.vertices());
    if (last && options_.snapping) snap(input);
  }
}

// solved: what the vertices were found from.
void SurfaceStage::snap(const SurfaceInput& solved) {
  skinner_.normals(vertices_, normals_);
  rasterizer_.render_depth(vertices_, camera_);
  visibility_.find_contour(rasterizer_);
  snapper_.snap(SnapInput{.frame = solved.frame,
                          .contour_flag = visibility_.contour(),
                          .normals = normals_,
                          .part_image = solved.part_image,
                          .vertex_part = solved.vertex_part},
                vertices_);
}

// Puts the template and the last displacements where the pose is; hanging cloth swings there, and drapes as it was
// seen to.
void SurfaceStage::place(const PosedSkeleton& posed, double seconds, const Eigen::Vector3d& up) {
  skinner_.skin(zero_, skinned_);
  skinner_.skin(displacement_rest_, start_);
  if (n_history_ >= 2) skinner_.skin(before_displacement_rest_, before_);
  if (drape_) drape_->keep(skinned_);
  if (cloth_) cloth_->step(posed, seconds, up, skinned_, start_, before_);
  if (drape_) drape_->move(posed, up, skinned_, start_, before_);
}

double SurfaceStage::solve(const Pose& pose, double time_s, const DeviceFrame* picture, const PixelBox& person,
                           const Light& light, const Eigen::Vector3d& up) {
  if (cloth_matcher_) cloth_matcher_->set_light(light);
  const PosedSkeleton posed = forward_kinematics(actor_.skeleton, pose);
  skinner_.set_pose(hanging_.dual_quats(posed, up));
  const double passed = time_s > last_time_s_ ? time_s - last_time_s_ : kUnknownFrame;
  last_time_s_ = time_s;
  if (cloth_ && passed > kLongestFrame) cloth_->reset();
  const double seconds = std::clamp(passed, kShortestFrame, kLongestFrame);
  place(posed, seconds, up);
  if (!picture) {
    if (cloth_) device_.finish();  // gave_up() knows then
    if (cloth_ && cloth_->gave_up()) place(posed, seconds, up);
    vertices_.copy_from(skinned_);
    return 0;
  }
  std::optional<SurfaceResult> surface;
  for (bool whole = false; !whole;) {
    launch(*picture, person);
    if (drape_) drape_->look(visibility_.visible(), skinned_, cloth_matcher_->matches());
    surface = solver_.result();
    const bool cloth_gave_up = cloth_ && cloth_->gave_up();
    if (cloth_gave_up) place(posed, seconds, up);
    whole = !snapper_.gave_up() && surface && !cloth_gave_up;
  }
  if (drape_) drape_->learn(seconds);
  if (surface->status != SurfaceStatus::kOk) vertices_.copy_from(start_);  // and not what a step made of it
  // The temporal terms compare displacements, not positions (docs/paper_map.md): `previous` is the warped start itself.
  if (options_.warp_displacements) {
    std::swap(before_displacement_rest_, displacement_rest_);
    skinner_.unskin_displacement(vertices_, skinned_, carried_share_, displacement_rest_);
  }
  n_history_ = std::min(n_history_ + 1, 2);
  return surface->energies.total();
}

}  // namespace livecap
