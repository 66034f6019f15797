#include "eval/joint_judge.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "actor/keypoint_offsets.h"
#include "detect/detections_io.h"
#include "eval/network_baseline.h"
#include "image/undistort.h"

namespace livecap {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kMissed = std::numeric_limits<double>::infinity();

double mean_of(const std::vector<double>& values) {
  return values.empty() ? kNaN : summarize(values).mean;
}

void append(std::vector<double>& all, const std::vector<double>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

std::vector<float> pick(const std::vector<float>& points, const std::vector<JointPair>& pairs, int JointPair::*side) {
  std::vector<float> picked;
  for (const JointPair& pair : pairs)
    picked.insert(picked.end(), &points[3 * (pair.*side)], &points[3 * (pair.*side)] + 3);
  return picked;
}

bool all_finite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
}

int index_of(const std::vector<JointPair>& pairs, const std::string& name) {
  const auto found = std::find_if(pairs.begin(), pairs.end(), [&](const JointPair& pair) { return pair.name == name; });
  return found == pairs.end() ? -1 : static_cast<int>(found - pairs.begin());
}

// The pairs of left_<name> and right_<name> that both sides know.
SidePairs side_pairs(const std::vector<JointPair>& pairs, const std::vector<std::string>& names) {
  SidePairs sides;
  for (const std::string& name : names) {
    const int left = index_of(pairs, "left_" + name);
    const int right = index_of(pairs, "right_" + name);
    if (left >= 0 && right >= 0) sides.emplace_back(left, right);
  }
  return sides;
}

}  // namespace

JointJudge::JointJudge(std::vector<JointPair> pairs, double fps)
    : pairs_(std::move(pairs)),
      fps_(fps),
      root_(index_of(pairs_, "root")),
      neck_(index_of(pairs_, "neck")),
      arms_(side_pairs(pairs_, {"elbow", "wrist"})),
      legs_(side_pairs(pairs_, {"knee", "ankle"})),
      per_joint_(pairs_.size()),
      jitter_(fps) {
  for (const auto& [left, right] : arms_) arm_points_.insert(arm_points_.end(), {left, right});
}

void JointJudge::add(const std::vector<float>& captured, const std::vector<float>& truth, FrameEval& frame) {
  if (pairs_.size() < kFewestJoints) return;
  const std::vector<float> theirs = truth.empty() ? std::vector<float>() : pick(truth, pairs_, &JointPair::truth);
  const std::vector<float> ours =
      captured.empty() ? std::vector<float>() : pick(captured, pairs_, &JointPair::captured);
  jitter_.add(ours, theirs);
  for (int side = 0; side < 2; ++side) add_foot(side, ours, theirs);
  if (theirs.empty()) return;
  if (ours.empty()) {
    missed_similarity_ += pairs_.size();
    if (root_ >= 0) missed_root_ += pairs_.size() - 1;
    return;
  }
  const std::vector<double> direct = point_distances(ours, theirs);
  const std::vector<double> aligned = similarity_aligned_distances(ours, theirs);
  frame.joint_mm = mean_of(direct);
  frame.joint_aligned_mm = mean_of(aligned);
  append(direct_, direct);
  append(aligned_, aligned);
  if (root_ >= 0) append(from_root_, root_aligned_distances(ours, theirs, root_));
  for (size_t k = 0; k < pairs_.size(); ++k) per_joint_[k].push_back(aligned[k]);
  frame.arms_exchanged = sides_exchanged(ours, theirs, arms_);
  frame.legs_exchanged = sides_exchanged(ours, theirs, legs_);
  frame.limb_inside = root_ >= 0 && neck_ >= 0 && limb_inside_trunk(ours, theirs, root_, neck_, arm_points_);
}

void JointJudge::skip() {
  jitter_.add({}, {});
  for (int side = 0; side < 2; ++side) add_foot(side, {}, {});
}

void JointJudge::finish(EvalReport& report) {
  report.joint_mm = summarize(direct_);
  report.joint_aligned_mm = summarize(aligned_);
  for (size_t k = 0; k < pairs_.size(); ++k) {
    report.joints_aligned_mm.emplace_back(pairs_[k].name, mean_of(per_joint_[k]));
  }
  aligned_.insert(aligned_.end(), missed_similarity_, kMissed);
  from_root_.insert(from_root_.end(), missed_root_, kMissed);
  report.pck_similarity = {share_within(aligned_), area_under_pck(aligned_)};
  report.pck_root = {share_within(from_root_), area_under_pck(from_root_)};
  report.joint_jitter = jitter_.result();
  report.foot_slide =
      combined(foot_slide(captured_foot_[0], true_foot_[0], fps_), foot_slide(captured_foot_[1], true_foot_[1], fps_));
}

void JointJudge::add_foot(int side, const std::vector<float>& ours, const std::vector<float>& theirs) {
  const int ankle = index_of(pairs_, side == 0 ? "left_ankle" : "right_ankle");
  const auto foot = [&](const std::vector<float>& joints) {
    return joints.empty() || ankle < 0 ? std::vector<float>()
                                       : std::vector<float>(&joints[3 * ankle], &joints[3 * ankle] + 3);
  };
  captured_foot_[side].push_back(foot(ours));
  true_foot_[side].push_back(foot(theirs));
}

NetworkJudge::NetworkJudge(const CaptureFolder& capture, const std::vector<std::string>& truth_names)
    : actor_(capture.actor), camera_(Undistorter(capture.camera).undistorted_camera()) {
  const std::filesystem::path file = capture.path / "detections.jsonl";
  pairs_ = match_joints(network_joint_names(), truth_names);
  if (!std::filesystem::exists(file) || pairs_.size() < kFewestJoints) return;
  use_mediapipe_anchors(actor_);
  for (Detections& detections : detect::load_detections(file)) {
    by_frame_.emplace(detections.frame_index, std::move(detections));
  }
}

void NetworkJudge::add(const std::vector<float>& truth, FrameEval& frame) {
  const auto detections = by_frame_.find(frame.index);
  if (truth.empty() || detections == by_frame_.end()) return;
  const std::vector<float> joints = network_joints(actor_, camera_, detections->second);
  if (joints.empty()) return;
  const std::vector<float> ours = pick(joints, pairs_, &JointPair::captured);
  const std::vector<float> theirs = pick(truth, pairs_, &JointPair::truth);
  if (!all_finite(ours)) return;
  const std::vector<double> aligned = similarity_aligned_distances(ours, theirs);
  frame.network_aligned_mm = mean_of(aligned);
  append(direct_, point_distances(ours, theirs));
  append(aligned_, aligned);
}

void NetworkJudge::finish(EvalReport& report) {
  report.network_joint_mm = summarize(std::move(direct_));
  report.network_joint_aligned_mm = summarize(std::move(aligned_));
}

}  // namespace livecap
