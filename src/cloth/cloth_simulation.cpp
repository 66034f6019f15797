#include "cloth/cloth_simulation.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <ranges>
#include <string>
#include <utility>

#include "base/log.h"
#include "base/round_up.h"
#include "cloth/hanging_cloth.h"
#include "cloth/layout.h"
#include "geometry/segment.h"
#include "livecap/error.h"

namespace livecap {
namespace {

using Vector3 = Eigen::Vector3d;

static_assert(sizeof(ClothStep) == 40, "as the kernel has it");

constexpr const char *kProgram = "cloth/cloth.cl", *kKernel = "simulate_cloth";
constexpr double kSettlingFrame = 1 / 30.0;  // s
constexpr double kLongestStep = 0.1;         // s, for which a frame's springs are to be stable
constexpr float kMostSmoothing = 500;        // mm
constexpr int kMostSmoothings = 50;          // of a mesh finer than any picture shows
constexpr double kSmoothing = 0.5;           // how far a displacement goes to the mean of those around at a time
constexpr int kEnds = 6, kRadii = 2;         // values of a limb

// The limbs of both legs in their order: thigh, shin, and what lies between the middle of the hips and the hip.
struct Limb {
  Vector3 from, to;  // mm
  float radius_from, radius_to;
};

Vector3 origin(const PosedSkeleton& posed, int bone) {
  return posed.camera_from_bone[bone].translation();
}

double distance_to(const Limb& limb, const Vector3& point) {
  return (point - limb.from - segment_parameter(point, limb.from, limb.to) * (limb.to - limb.from)).norm();
}

std::vector<Limb> limbs_of(const PosedSkeleton& posed, const std::array<std::array<int, 3>, 2>& legs,
                           const std::array<float, 4>& radii_mm) {
  const auto [hips, thigh, knee, ankle] = radii_mm;
  const Vector3 middle = (origin(posed, legs[0][0]) + origin(posed, legs[1][0])) / 2;
  std::vector<Limb> limbs;
  for (const auto& leg : legs) {
    limbs.push_back({origin(posed, leg[0]), origin(posed, leg[1]), thigh, knee});
    limbs.push_back({origin(posed, leg[1]), origin(posed, leg[2]), knee, ankle});
    limbs.push_back({middle, origin(posed, leg[0]), hips, hips});
  }
  return limbs;
}

Eigen::Vector3f moved(const Eigen::Isometry3d& by, const float* point) {
  return (by * Eigen::Map<const Eigen::Vector3f>(point).cast<double>()).cast<float>();
}

// Semi-implicit Euler.
bool is_stable(const ClothOptions::Fabric& fabric) {
  const double small = kLongestStep / fabric.steps;
  return fabric.stiffness * small * small < 4;
}

}  // namespace

void ClothOptions::validate() const {
  const auto require = [](bool fits, const char* field, double value, const char* range) {
    if (!fits)
      throw ConfigError(std::string("cloth: ") + field + " is " + std::to_string(value) + ", must be " + range);
  };
  const auto rate = [&](float value, const char* field) {
    require(value >= 0 && std::isfinite(value), field, value, "at least 0");
  };
  for (const Fabric& fabric : {taut, loose}) {
    require(fabric.steps >= 1, "steps", fabric.steps, "at least 1");
    rate(fabric.stiffness, "stiffness");
    rate(fabric.damping, "damping");
    require(fabric.max_held_leg_weight >= 0 && fabric.max_held_leg_weight < 1, "max_held_leg_weight",
            fabric.max_held_leg_weight, "at least 0 and below 1");
    require(is_stable(fabric), "stiffness", fabric.stiffness, "less, or there must be more steps");
  }
  rate(gravity, "gravity");
  require(spring_reach > 0 && std::isfinite(spring_reach), "spring_reach", spring_reach, "above 0 and finite");
  rate(air_drag, "air_drag");
  rate(bending_share, "bending_share");
  require(relaxation > 0 && relaxation < 2, "relaxation", relaxation, "above 0 and below 2");
  require(smoothing_mm >= 0 && smoothing_mm <= kMostSmoothing, "smoothing_mm", smoothing_mm, "from 0 to 500");
  require(settling_frames >= 0, "settling_frames", settling_frames, "at least 0");
  for (const float radius : limb_radii)
    require(radius >= 0 && radius < 1, "a limb's radius", radius, "at least 0 and below 1");
}

ClothOptions::Fabric ClothOptions::fabric(float looseness) const {
  return {std::lerp(taut.stiffness, loose.stiffness, looseness), std::lerp(taut.damping, loose.damping, looseness),
          int(std::lround(std::lerp(float(taut.steps), float(loose.steps), looseness))),
          std::lerp(taut.max_held_leg_weight, loose.max_held_leg_weight, looseness)};
}

ClothSimulation::ClothSimulation(ocl::DeviceContext& device, const Actor& actor, const ClothOptions& options,
                                 float looseness)
    : device_(&device), options_(options), fabric_((options.validate(), options.fabric(looseness))) {
  if (!is_stable(fabric_)) throw ConfigError("cloth: between taut and loose it is too stiff for its steps");
  ClothGraph cloth = make_cloth_graph(actor, fabric_.max_held_leg_weight);
  const Skeleton& skeleton = actor.skeleton;
  const char* sides[] = {"left_", "right_"};
  for (int k = 0; k < 2; ++k)
    for (int j = 0; j < 3; ++j)
      legs_[k][j] = skeleton.bone_index(std::string(sides[k]) + std::array{"hip", "knee", "ankle"}[j]);
  const bool has_legs =
      std::all_of(legs_.begin(), legs_.end(), [](auto& leg) { return *std::min_element(leg.begin(), leg.end()) >= 0; });
  if (cloth.n_particles() == 0 || !has_legs) {
    const auto n = std::views::iota(0, actor.n_vertices());
    if (std::any_of(n.begin(), n.end(), [&](int i) { return hangs(actor, i); }))
      log_info("the hanging cloth of " + actor.name +
               " is not simulated: it hangs from nothing above the hips, or the skeleton has no legs");
    return;
  }
  cloth_ = std::move(cloth);
  graph_ = make_sell_graph(cloth_.links);
  set_up_links(device, actor, looseness);
  set_up_limbs(device, actor);
  for (ocl::Buffer<float>* planes : {&before_, &target_, &x_, &v_, &ahead_}) {
    *planes = ocl::Buffer<float>(device, size_t(planes == &ahead_ ? 6 : 3) * graph_.stride);
    planes->fill(0);
  }
  group_ = LC_CLOTH_GROUP(device.is_cpu());
  const size_t n_items = LC_CLOTH_PARTS * size_t(graph_.n_rows);
  groups_ = ocl::GroupsTogether(device, device.is_cpu() ? 1 : round_up(n_items, group_) / group_);
  simulate_ = {device, kProgram, kKernel};
}

void ClothSimulation::set_up_links(ocl::DeviceContext& device, const Actor& actor, float looseness) {
  const int n = cloth_.n_particles();
  const auto share = [&](int at) { return cloth_.across[at] ? options_.bending_share : 1.0f; };
  std::vector<double> shares(n, 0);
  for (int i = 0; i < n; ++i)
    for (int at = cloth_.links.offsets[i]; at < cloth_.links.offsets[i + 1]; ++at) shares[i] += share(at);
  const auto link = [&](int i, int j) {
    const auto begin = cloth_.links.neighbors.begin();
    return int(std::lower_bound(begin + cloth_.links.offsets[i], begin + cloth_.links.offsets[i + 1], j) - begin);
  };
  // Of a link that is too long the free ends move, half each or the only one by all.
  const auto pull = [&](int i, int j) {
    if (cloth_.held[i] || shares[i] == 0) return 0.0;
    return options_.relaxation * share(link(i, j)) / shares[i] / (cloth_.held[j] ? 1 : 2);
  };
  const auto place = [&](int i) {
    return Eigen::Map<const Eigen::Vector3f>(actor.mesh.positions.data() + 3 * cloth_.vertices[i]);
  };
  pulls_ = {device, graph_.per_entry(pull)};
  smoothing_shares_ = {
      device, graph_.per_entry([&](int i, int) { return cloth_.held[i] ? 0 : kSmoothing / graph_.degree[i]; })};
  const std::vector<float> lengths = graph_.per_entry([&](int i, int j) { return (place(i) - place(j)).norm(); });
  const double mean_mm = std::accumulate(lengths.begin(), lengths.end(), 0.0) / double(cloth_.links.neighbors.size());
  if (mean_mm > 0) n_smoothings_ = int(std::min(std::pow(options_.smoothing_mm / mean_mm, 2), double(kMostSmoothings)));
  lengths_ = {device, lengths};
  slice_offsets_ = {device, graph_.slice_offsets};
  neighbors_ = {device, graph_.neighbors};

  std::vector<int32_t> vertices(graph_.n_rows, cloth_.vertices[0]);
  std::vector<float> is_free(graph_.n_rows, 0.0f);
  std::vector<int32_t> moved, particles;
  std::vector<float> weights;
  for (int r = 0; r < n; ++r) {
    const int i = graph_.order[r];
    vertices[r] = cloth_.vertices[i];
    is_free[r] = cloth_.held[i] ? 0.0f : 1.0f;
    if (cloth_.held[i]) continue;
    moved.push_back(cloth_.vertices[i]);
    particles.insert(particles.end(), 4, r);
    weights.insert(weights.end(), {1, 0, 0, 0});
  }
  moved.insert(moved.end(), cloth_.followers.begin(), cloth_.followers.end());
  for (const int p : cloth_.followed) particles.push_back(graph_.row[p]);
  for (size_t k = 0; k < cloth_.followed_weights.size(); ++k)
    weights.push_back(std::lerp(cloth_.follower_shares[k / 4], 1.0f, looseness) * cloth_.followed_weights[k]);
  n_moved_ = int(moved.size());
  vertices_ = {device, vertices};
  is_free_ = {device, is_free};
  moved_ = {device, moved};
  particles_ = {device, particles};
  weights_ = {device, weights};
}

// In the rest pose nothing is pushed: a limb is for a particle no thicker than it is far away then.
void ClothSimulation::set_up_limbs(ocl::DeviceContext& device, const Actor& actor) {
  const PosedSkeleton rest = forward_kinematics(actor.skeleton, rest_pose(actor.skeleton));
  thigh_mm_ = float((origin(rest, legs_[0][1]) - origin(rest, legs_[0][0])).norm());
  base_ = actor.skeleton.bones[legs_[0][0]].parent;
  rest_mm_ = actor.mesh.positions;
  limbs_rest_ = limbs_at(rest);
  hung_ = ocl::Buffer<float>(device, rest_mm_.size());
  std::vector<float> reach(size_t(LC_CLOTH_LIMBS) * graph_.stride, 0.0f);
  const std::vector<Limb> limbs = limbs_of(rest, legs_, {});
  for (int r = 0; r < graph_.n; ++r) {
    const int i = graph_.order[r];
    const float* p = actor.mesh.positions.data() + 3 * cloth_.vertices[i];
    for (size_t k = 0; k < limbs.size(); ++k)
      if (!cloth_.held[i]) reach[k * graph_.stride + r] = float(distance_to(limbs[k], Vector3(p[0], p[1], p[2])));
  }
  reach_ = {device, reach};
  limbs_ = ocl::Buffer<float>(device, LC_CLOTH_LIMBS * LC_CLOTH_LIMB_SIZE);
}

// [LC_CLOTH_LIMBS][kEnds + kRadii].
std::vector<float> ClothSimulation::limbs_at(const PosedSkeleton& posed) const {
  std::array<float, 4> radii = options_.limb_radii;
  for (float& radius : radii) radius *= thigh_mm_;
  std::vector<float> values;
  for (const Limb& limb : limbs_of(posed, legs_, radii)) {
    for (const Vector3& end : {limb.from, limb.to})
      for (int a = 0; a < 3; ++a) values.push_back(float(end[a]));
    values.insert(values.end(), {limb.radius_from, limb.radius_to});
  }
  return values;
}

ClothStep ClothSimulation::step_of(double seconds, const Eigen::Vector3d& up) const {
  const double small = seconds / fabric_.steps;
  const Vector3 falls = -options_.gravity * small * up;
  return {float(small),
          float(1 / small),
          float(1 / seconds),
          float(fabric_.stiffness * small),
          options_.spring_reach,
          float(1 - std::exp(-fabric_.damping * small)),
          float(std::exp(-options_.air_drag * small)),
          float(falls.x()),
          float(falls.y()),
          float(falls.z())};
}

// For the next frame: from where they were in the one before.
void ClothSimulation::set_limbs(const std::vector<float>& now) {
  std::vector<float> limbs;
  for (int k = 0; k < LC_CLOTH_LIMBS; ++k) {
    const auto of = (kEnds + kRadii) * k;
    limbs.insert(limbs.end(), limbs_before_.begin() + of, limbs_before_.begin() + of + kEnds);
    limbs.insert(limbs.end(), now.begin() + of, now.begin() + of + kEnds + kRadii);
  }
  limbs_.write_later(limbs);
  limbs_before_ = now;
}

void ClothSimulation::step(const PosedSkeleton& posed, double seconds, const Eigen::Vector3d& up,
                           ocl::Buffer<float>& skinned, ocl::Buffer<float>& start, ocl::Buffer<float>& start_before) {
  if (!has_cloth()) return;
  if (!(seconds > 0)) throw LogicError("cloth: a frame takes " + std::to_string(seconds) + " s");
  const std::vector<float> now = limbs_at(posed);
  const auto frame = [&](double frame_seconds, bool settles, ocl::Buffer<float>& places) {
    const int n_moved = settles ? 0 : n_moved_, n_smoothings = settles ? 0 : n_smoothings_;
    simulate_.launch(groups_.n() * group_, group_, first_ ? 1 : 0, fabric_.steps, n_smoothings, graph_.n_rows,
                     graph_.stride, n_moved, groups_.arrived(), step_of(frame_seconds, up), slice_offsets_, neighbors_,
                     pulls_, lengths_, smoothing_shares_, vertices_, is_free_, limbs_, reach_, moved_, particles_,
                     weights_, before_, target_, x_, v_, ahead_, places, start, start_before, groups_.state());
    groups_.launched(fabric_.steps + n_smoothings + 2);
    first_ = false;
  };
  // Cloth that starts on bent legs may be on the wrong side of a knee, and bunch there. So it starts as in the rest
  // pose, where the hips are, and the legs bend meanwhile.
  if (first_ && options_.settling_frames > 0) {
    const Eigen::Isometry3d& hips = posed.camera_from_rest[base_];
    std::vector<float> hung = rest_mm_, straight = limbs_rest_;
    for (size_t i = 0; i < hung.size(); i += 3) Eigen::Map<Eigen::Vector3f>{&hung[i]} = moved(hips, &rest_mm_[i]);
    for (size_t limb = 0; limb < straight.size(); limb += kEnds + kRadii)
      for (size_t i = limb; i < limb + kEnds; i += 3)
        Eigen::Map<Eigen::Vector3f>{&straight[i]} = moved(hips, &limbs_rest_[i]);
    hung_.write_later(hung);
    limbs_before_ = straight;
    set_limbs(straight);
    frame(kSettlingFrame, true, hung_);
    for (int k = 1; k <= options_.settling_frames; ++k) {
      const float share = float(k) / float(options_.settling_frames);
      std::vector<float> bent = straight;
      for (size_t i = 0; i < bent.size(); ++i) bent[i] = std::lerp(straight[i], now[i], share);
      set_limbs(bent);
      frame(kSettlingFrame, true, skinned);
    }
  }
  if (first_) limbs_before_ = now;
  set_limbs(now);
  frame(seconds, false, skinned);
  if (groups_.n() > 1) groups_.read_later();
}

bool ClothSimulation::gave_up() {
  if (!has_cloth() || !groups_.gave_up("cloth")) return false;
  groups_ = ocl::GroupsTogether(*device_, 1);
  group_ =
      std::min<size_t>(LC_CLOTH_GROUP_ALONE, device_->info().max_work_group_size / LC_CLOTH_PARTS * LC_CLOTH_PARTS);
  simulate_ = {*device_, kProgram, kKernel, "-D LC_CLOTH_GPU_GROUP=" + std::to_string(group_)};
  reset();
  return true;
}

}  // namespace livecap
