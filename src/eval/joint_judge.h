// The joint side of evaluate(): fed the judged frames in the order of the video, it fills the joint fields of the
// report.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "actor/actor.h"
#include "base/detections.h"
#include "eval/body_points.h"
#include "eval/capture_folder.h"
#include "eval/evaluate.h"
#include "eval/joint_names.h"
#include "eval/motion_metrics.h"
#include "eval/pose_metrics.h"
#include "eval/true_mesh.h"

namespace livecap {

// With fewer joints of a known name there is no similarity alignment, and nothing is judged.
inline constexpr size_t kFewestJoints = 3;

// The joints of the captured skeleton.
class JointJudge {
 public:
  // fps: of the video.
  JointJudge(std::vector<JointPair> pairs, double fps);

  // A frame with a person. Positions of all joints, mm, camera frame; empty: not known. A captured joint with NaN
  // counts as missed, and the others are judged without it.
  void add(const std::vector<float>& captured, const std::vector<float>& truth, FrameEval& frame);
  // A frame without one.
  void skip();
  void finish(EvalReport& report);

  // Where the joints of one side are, by the medians; NaN without any.
  struct Place {
    double away_mm, z_mm;  // from the camera, and before it
  };
  Place captured_place() const { return captured_.median(); }
  Place true_place() const { return true_.median(); }

 private:
  void judge(const std::vector<JointPair>& known, const std::vector<float>& captured, const std::vector<float>& truth,
             FrameEval& frame);
  void add_foot(int side, const std::vector<float>& ours, const std::vector<float>& theirs);

  std::vector<JointPair> pairs_;
  double fps_;
  int root_;  // among the pairs; -1: not among them
  std::vector<double> direct_, aligned_, from_root_;
  struct Places {
    std::vector<double> away_mm, z_mm;  // of each known joint
    void add(const std::vector<float>& points);
    Place median() const { return {summarize(away_mm).median, summarize(z_mm).median}; }
  };
  Places captured_, true_;
  size_t missed_similarity_ = 0, missed_root_ = 0;  // joints without a result
  std::vector<std::vector<double>> per_joint_;      // [n_pairs]
  JitterMeter jitter_;
  std::vector<std::vector<float>> captured_foot_[2], true_foot_[2];  // left, right ankle
};

// The joints as points of the body (eval/body_points.h); of the truth's own mesh that is what they are anyway.
class BodyPointJudge {
 public:
  // capture must outlive this.
  BodyPointJudge(const CaptureFolder& capture, const TrueMesh& true_mesh, const std::vector<JointPair>& pairs);

  // A frame with a person: captured_joints() of its row, and the truth as JointJudge has it.
  void add(int64_t row, const std::vector<float>& captured, const std::vector<float>& truth);
  // After JointJudge's.
  void finish(EvalReport& report);

 private:
  const CaptureFolder& capture_;
  std::optional<CarriedJoints> carried_;  // of another mesh
  JointJudge judge_;
};

// The joints that the network saw in the capture's frames (eval/network_baseline.h).
class NetworkJudge {
 public:
  NetworkJudge(const CaptureFolder& capture, const std::vector<std::string>& truth_names);
  void add(const std::vector<float>& truth, FrameEval& frame);
  void finish(EvalReport& report);

 private:
  Actor actor_;  // with the network's anchors
  Camera camera_;
  std::vector<JointPair> pairs_;
  std::map<int64_t, Detections> by_frame_;
  std::vector<double> direct_, aligned_;
};

}  // namespace livecap
