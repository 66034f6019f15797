#include "capture/components.h"

#include <algorithm>

#include "capture/tracker.h"
#include "livecap/error.h"
#include "solve/term_table.h"

namespace livecap {
namespace {

// The weight of a stage II term by its name in the term table; nullptr when it is not one.
float* surface_weight(SurfaceOptions& options, const std::string& name) {
  if (name == "photo") return &options.w_photo;
  if (name == "surface_silhouette") return &options.w_silhouette;
  if (name == "surface_match") return &options.w_match;
  if (name == "smooth") return &options.w_smooth;
  if (name == "edge") return &options.w_edge;
  if (name == "depth") return &options.w_depth;
  if (name == "velocity") return &options.w_velocity;
  if (name == "acceleration") return &options.w_acceleration;
  return nullptr;
}

}  // namespace

const std::vector<std::string>& component_names() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> list;
    for (const Term& term : term_table()) list.emplace_back(term.name);
    for (const char* name :
         {"face", "warping", "part_mask", "snapping", "cloth", "cloth_behind", "cloth_anew", "drape", "confidence",
          kMaskGating.data(), kFixedLag.data(), kUpright.data(), "balance", "hidden_arms", "pose_solver"})
      list.emplace_back(name);
    return list;
  }();
  return names;
}

void require_component(const std::string& name) {
  const auto& names = component_names();
  if (std::find(names.begin(), names.end(), name) != names.end()) return;
  std::string message = "--without " + name + ": no such term or component; there are:";
  for (const auto& known : names) message += " " + known;
  throw ConfigError(message);
}

void switch_off(const std::string& name, TrackerOptions& options) {
  require_component(name);
  if (set_weight(options.pose.weights, name, 0)) return;
  if (float* weight = surface_weight(options.surface, name)) {
    *weight = 0;
    if (name == "velocity") options.surface.w_worn_velocity = 0;
    return;
  }
  if (name == "face") {
    for (int k = kBodyKeypointCount; k < kKeypointCount; ++k)
      options.pose.keypoint_2d_weights[k] = options.pose.keypoint_3d_weights[k] = 0;
  } else if (name == "warping") {
    options.warp_displacements = false;
  } else if (name == "part_mask") {
    options.part_mask = false;
  } else if (name == "snapping") {
    options.snapping = false;
  } else if (name == "cloth") {
    options.simulate_cloth = false;
  } else if (name == "cloth_behind") {
    options.behind_share = 0;
  } else if (name == "cloth_anew") {
    options.anew_share = 0;
  } else if (name == "drape") {
    options.learn_drape = false;
  } else if (name == "confidence") {
    options.ignore_confidence = true;
  } else if (name == "balance") {
    options.floor.balance = no_balance();
    options.starts.cost_of_imbalance = 0;
  } else if (name == "hidden_arms") {
    options.pose.hidden_share = 0;
    options.starts.strayed_arm_share = 0;
  } else if (name == "pose_solver") {
    options.solve_pose = false;
  }
}

}  // namespace livecap
