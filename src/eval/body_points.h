// The joints of a capture with another actor than the truth's, as points of the body: where the true skeleton's joints,
// fixed to the captured bones, are. Against these, the truth tells how well the bones were captured; against the
// captured skeleton's own joints it also tells how far those lie from the true ones at rest. Joints regressed from a
// captured mesh are such points too.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "actor/actor.h"
#include "eval/capture_folder.h"
#include "eval/joint_names.h"
#include "eval/other_mesh.h"

namespace livecap {

// The pose of a row of a capture, in the camera's frame: its joint angles, and the root from the rigid motion that lays
// the skeleton's joints on the row's (joints_mm: [3*n], camera frame). None when the row has no result or the capture
// lacks a column that is needed.
std::optional<Pose> captured_pose(const CaptureFolder& capture, int64_t row, const std::vector<float>& joints_mm);

// The rotation and translation of every bone in it: camera_from_rest, [n_bones]; empty where there is no pose.
std::vector<Eigen::Isometry3d> captured_bones(const CaptureFolder& capture, int64_t row,
                                              const std::vector<float>& joints_mm);

class CarriedJoints {
 public:
  // Every pair's true joint belongs to the captured bone of the pair's name, or to that of the keypoint, and has the
  // place in it that it has when both actors rest on top of each other. Pairs whose name either actor does not have
  // keep the captured joint.
  CarriedJoints(const Actor& actor, const Actor& truth, const RestOverlay& overlay,
                const std::vector<JointPair>& pairs);

  // joints_mm: of a row, all of the capture's; bones: its captured_bones(). -> the same with the pairs' exchanged.
  std::vector<float> at(std::vector<float> joints_mm, const std::vector<Eigen::Isometry3d>& bones) const;

 private:
  struct Point {
    int joint;  // index among the capture's
    int bone;
    Eigen::Vector3d rest_mm;  // in the captured actor's rest frame
  };
  std::vector<Point> points_;
};

}  // namespace livecap
