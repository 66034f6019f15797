#include "eval/joint_judge.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "actor/keypoint_offsets.h"
#include "base/append.h"
#include "detect/detections_io.h"
#include "eval/network_baseline.h"
#include "image/undistort.h"

namespace livecap {
namespace {

constexpr double kMissed = std::numeric_limits<double>::infinity();

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

// The pairs whose captured joint is known in a frame.
std::vector<JointPair> known_pairs(const std::vector<JointPair>& pairs, const std::vector<float>& captured) {
  std::vector<JointPair> known;
  std::copy_if(pairs.begin(), pairs.end(), std::back_inserter(known), [&](const JointPair& pair) {
    const float* point = &captured[3 * pair.captured];
    return std::all_of(point, point + 3, [](float value) { return std::isfinite(value); });
  });
  return known;
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
    : pairs_(std::move(pairs)), fps_(fps), root_(index_of(pairs_, "root")), per_joint_(pairs_.size()), jitter_(fps) {}

void JointJudge::add(const std::vector<float>& captured, const std::vector<float>& truth, FrameEval& frame) {
  if (pairs_.size() < kFewestJoints) return;
  const std::vector<float> theirs = truth.empty() ? std::vector<float>() : pick(truth, pairs_, &JointPair::truth);
  const std::vector<float> ours =
      captured.empty() ? std::vector<float>() : pick(captured, pairs_, &JointPair::captured);
  jitter_.add(ours, theirs);
  for (int side = 0; side < 2; ++side) add_foot(side, ours, theirs);
  if (theirs.empty()) return;
  judge(captured.empty() ? std::vector<JointPair>() : known_pairs(pairs_, captured), captured, truth, frame);
}

void JointJudge::judge(const std::vector<JointPair>& known, const std::vector<float>& captured,
                       const std::vector<float>& truth, FrameEval& frame) {
  const std::vector<float> ours = pick(captured, known, &JointPair::captured);
  const std::vector<float> theirs = pick(truth, known, &JointPair::truth);
  const std::vector<double> direct = point_distances(ours, theirs);
  frame.joint_mm = mean_of(direct);
  append(direct_, direct);
  captured_.add(ours);
  true_.add(theirs);

  const int root = index_of(known, "root"), neck = index_of(known, "neck");
  const std::vector<double> from_root = root >= 0 ? root_aligned_distances(ours, theirs, root) : std::vector<double>();
  append(from_root_, from_root);
  if (root_ >= 0) missed_root_ += pairs_.size() - 1 - from_root.size();

  const SidePairs arms = side_pairs(known, {"elbow", "wrist"}), legs = side_pairs(known, {"knee", "ankle"});
  std::vector<int> arm_points;  // of both arms
  for (const auto& [left, right] : arms) arm_points.insert(arm_points.end(), {left, right});
  frame.arms_exchanged = sides_exchanged(ours, theirs, arms);
  frame.legs_exchanged = sides_exchanged(ours, theirs, legs);
  frame.limb_inside = root >= 0 && neck >= 0 && limb_inside_trunk(ours, theirs, root, neck, arm_points);

  const std::vector<double> aligned =
      known.size() >= kFewestJoints ? similarity_aligned_distances(ours, theirs) : std::vector<double>();
  frame.joint_aligned_mm = mean_of(aligned);
  append(aligned_, aligned);
  missed_similarity_ += pairs_.size() - aligned.size();
  for (size_t k = 0; k < aligned.size(); ++k) per_joint_[index_of(pairs_, known[k].name)].push_back(aligned[k]);
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

void JointJudge::Places::add(const std::vector<float>& points) {
  append(away_mm, point_distances(points, std::vector<float>(points.size(), 0)));
  for (size_t i = 2; i < points.size(); i += 3) z_mm.push_back(points[i]);
}

void JointJudge::add_foot(int side, const std::vector<float>& ours, const std::vector<float>& theirs) {
  const int ankle = index_of(pairs_, side == 0 ? "left_ankle" : "right_ankle");
  const auto foot = [&](const std::vector<float>& joints) {
    if (joints.empty() || ankle < 0) return std::vector<float>();
    const std::vector<float> point(&joints[3 * ankle], &joints[3 * ankle] + 3);
    return all_finite(point) ? point : std::vector<float>();
  };
  captured_foot_[side].push_back(foot(ours));
  true_foot_[side].push_back(foot(theirs));
}

BodyPointJudge::BodyPointJudge(const CaptureFolder& capture, const TrueMesh& true_mesh,
                               const std::vector<JointPair>& pairs)
    : capture_(capture), judge_(pairs, capture.fps) {
  if (true_mesh.is_other()) carried_.emplace(capture.actor, *true_mesh.actor(), true_mesh.overlay(), pairs);
}

void BodyPointJudge::add(int64_t row, const std::vector<float>& captured, const std::vector<float>& truth) {
  if (!carried_) return;
  const std::vector<Eigen::Isometry3d> bones = captured_bones(capture_, row, captured);
  FrameEval unused;
  if (!bones.empty()) judge_.add(carried_->at(captured, bones), truth, unused);
}

void BodyPointJudge::finish(EvalReport& report) {
  EvalReport of_points;
  if (carried_) judge_.finish(of_points);
  const EvalReport& joints = carried_ ? of_points : report;
  report.body_point_mm = joints.joint_mm;
  report.body_point_aligned_mm = joints.joint_aligned_mm;
  report.body_points_aligned_mm = joints.joints_aligned_mm;
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
