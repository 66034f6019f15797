// Stage I, skeletal pose: a few Gauss-Newton steps on E_2D + E_3D + E_silhouette + E_temporal + E_anatomic (paper,
// "Skeletal Pose Estimation").
//
//   PoseSolver solver(device, actor, camera, options);
//   Pose start = has_history ? predict_pose(...) : *initialize_pose(...);
//   PoseResult result = solver.solve({.detections = detections, .initial = start, .previous = &last, ...});
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>
#include <span>
#include <vector>

#include "pose/initialize.h"
#include "pose/pose_options.h"
#include "pose/pose_system.h"
#include "solve/dense_solver.h"

namespace livecap {

struct PoseInput {
  const Detections& detections;
  const Pose& initial;                             // where to start; returned when the solve fails
  const Pose* previous = nullptr;                  // last frame's result; nullptr: no temporal term
  bool holds_arms = true;                          // false: nobody was detected, so that no arm is hidden
  const DeviceFrame* frame = nullptr;              // nullptr (nobody segmented): no silhouette term
  std::span<const int32_t> contour_vertices = {};  // B of the frame, template vertex indices
  std::span<const VertexMatch> matches = {};       // where the picture shows vertices of the skinned template
  std::span<const ShadedVertex> shaded = {};       // how bright it shows skin
  double match_px = 1;                             // factor of PoseOptions::match_huber_px
  const SeenVertices* seen = nullptr;              // instead of these three, where PoseSolver::chooses()
  const Floor* floor = nullptr;                    // nullptr: none is known
  double share_3d = 1;                             // factor of lambda_3D
  double arms_3d = 1;                              // factor of lambda_i of E_3D of elbows, wrists and hands
  double legs_3d = 1;                              // likewise of knees, ankles and toes
  double doubt_3d_mm = 0;  // see doubt_far_detections(), at `initial`; 0: detections are not doubted
  int n_steps = 0;         // 0: PoseOptions::steps
  double settled_px = 0;   // no further step after one that moves no keypoint so far in the picture
};

// Weighted, as in the paper's E_pose.
struct PoseEnergies {
  double keypoint_2d = 0;
  double keypoint_3d = 0;  // with doubt: of doubted_cost()
  double silhouette = 0;
  double match = 0;
  double shading = 0;
  double floor = 0;
  double temporal = 0;
  double anatomic = 0;
  double rest = 0;
  double doubted_temporal = 0;  // not in total(): temporal by doubted_cost(), see PoseOptions::temporal_doubt_mm
  double total() const {
    return keypoint_2d + keypoint_3d + silhouette + match + shading + floor + temporal + anatomic + rest;
  }
  // A cost that temporal is part of, with doubted_temporal instead.
  double with_doubt(double cost) const { return cost - temporal + doubted_temporal; }
};

struct PoseResult {
  Pose pose;  // PoseInput::initial unless status is kOk
  SolveStatus status = SolveStatus::kOk;
  PoseEnergies energy;                                   // at `pose`
  Eigen::Vector3d t_prime_mm = Eigen::Vector3d::Zero();  // camera_from_root of the 3D detections
  std::vector<double> step_energy;                       // total before each step
  double keypoint_error_px = 0;                          // mean 2D error, weighted as in E_2D; 0 without detections
  double moved_px = 0;                                   // furthest that a keypoint went in the picture
  double missed_weight = 0;  // that the matches of PoseInput::seen fall short of perfect ones in
  double seen_weight = 0;    // that perfect ones would have
};

// The step of a system as Gauss-Newton takes it: damped and not further than PoseOptions::max_step_rad.
DenseSolution damped_step(const PoseNormalEquations& equations, const PoseOptions& options);

class PoseSolver {
 public:
  // camera: of undistorted pictures. device and actor must outlive the solver.
  // Throws ConfigError for bad options, LogicError for an inconsistent actor, OclError.
  PoseSolver(ocl::DeviceContext& device, const Actor& actor, const Camera& camera, const PoseOptions& options)
      : PoseSolver(device, actor, actor.skin, camera, options) {}
  // The same mesh and bones with other weights.
  PoseSolver(ocl::DeviceContext& device, const Actor& actor, const SkinWeights& skin, const Camera& camera,
             const PoseOptions& options);

  // What a solve needs but what the picture shows of vertices: may be made while that is looked for. previous, floor,
  // initial, detections, share_3d, arms_3d, legs_3d and doubt_3d_mm of the input count.
  struct Prepared {
    KeypointTargets targets;
    std::array<double, kKeypointCount> undoubted_3d;  // their weight_3d before doubt
    double doubt_3d_mm = 0;
    std::vector<double> stands;                                // of the soles; empty without a floor
    std::array<Eigen::Vector3d, kKeypointCount> keypoints_mm;  // of the initial pose
  };
  Prepared prepare(const PoseInput& input) const;

  // Bit-identical for identical inputs on one device, unless its work-groups gave up waiting for each other in one of
  // the runs (ocl/groups_together.h): then within float rounding. Throws LogicError for inputs of wrong size.
  PoseResult solve(const PoseInput& input) { return solve(input, prepare(input)); }
  PoseResult solve(const PoseInput& input, const Prepared& prepared);

  // Solves that start where the one before ended, launched one after the other on a device that chooses(); what each
  // of them sees is launched by the caller in between, for the pose that motions() holds.
  struct Round {
    const PoseInput* input;     // initial: of the first one; no vertices
    double least_moved_px = 0;  // left out where the one before moved no keypoint so far
  };
  // First motions() are set to those of the first pose: what the first solve sees is launched before this prepares it.
  void start_rounds(const Pose& initial);
  // False where there is nothing to launch, or more steps than the device takes at once: solve() then tells why. The
  // rounds' inputs must outlive finish_rounds(). seen: of all rounds; not what is seen but what is known of it.
  bool begin_rounds(std::span<const Round> rounds, const SeenVertices& known);
  void launch_round(int round, const SeenVertices& seen);
  // What came of the last round that was not left out. Blocking. Nothing where the device could not.
  std::optional<PoseResult> finish_rounds();
  const PoseSystem& system() const { return system_; }

  // Whether the device chooses from what it has seen; false for ever once it could not.
  bool chooses() const { return system_.chooses(); }

  const PoseOptions& options() const { return options_; }

 private:
  using KeypointPositions = std::array<Eigen::Vector3d, kKeypointCount>;
  KeypointPositions keypoints(const Pose& pose) const;
  void weigh_3d(Prepared& prepared, const PoseInput& input) const;
  int steps_of(const PoseInput& input) const;
  std::vector<RestAngle> rest_of(const PoseInput& input) const;
  PoseSteps take_steps(const PoseState& start, int n_steps, double settled_px);
  void take(const PoseSteps& steps, const Prepared& prepared, PoseResult& result) const;
  void measure(const PoseState& state, std::span<const float> residuals, const Prepared& prepared,
               PoseResult& result) const;

  const Actor& actor_;
  Camera camera_;
  PoseOptions options_;
  PoseSystem system_;
  std::vector<Round> rounds_;
  std::vector<Prepared> prepared_;  // of each
};

// Known-answer tests of kernels/pose against double precision on the host.
std::vector<ocl::SelfTestResult> pose_self_test(ocl::DeviceContext& device);

}  // namespace livecap
