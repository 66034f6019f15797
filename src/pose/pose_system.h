// The pose stage's residuals F and Jacobian J on the device, and their normal equations (paper, "Data Parallel GPU
// Optimization", "Pose Estimation"): per step one small upload, the row kernels of kernels/pose, one blocking read; on
// GPUs that can all steps of a solve for that much.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <vector>

#include "actor/actor.h"
#include "geometry/pinhole_arg.h"
#include "geometry/seen_vertices.h"
#include "geometry/shaded_vertex.h"
#include "geometry/vertex_match.h"
#include "image/device_frame.h"
#include "livecap/camera.h"
#include "ocl/buffer.h"
#include "ocl/groups_together.h"
#include "ocl/kernel.h"
#include "pose/floor.h"
#include "pose/held_arms.h"
#include "pose/layout.h"
#include "pose/pose_options.h"
#include "pose/posed_step.h"
#include "pose/row_inputs.h"
#include "pose/targets.h"
#include "solve/dense_solver.h"

namespace livecap {

struct PoseNormalEquations {
  Eigen::MatrixXd JtJ;  // [n_unknowns, n_unknowns]
  Eigen::VectorXd JtF;  // [n_unknowns]
  double energy = 0;    // F^T F
};

// Gauss-Newton steps from a state on.
struct PoseSteps {
  SolveStatus status = SolveStatus::kOk;
  PoseState state;                  // where they ended, or the last one failed
  std::vector<double> step_energy;  // F^T F before each
  std::vector<float> residuals;     // at `state`; empty unless status is kOk
};

class PoseSystem {
 public:
  // Keeps no reference to its arguments. Throws LogicError when the actor's arrays do not fit together.
  PoseSystem(ocl::DeviceContext& device, const Actor& actor, const Camera& camera, const PoseOptions& options)
      : PoseSystem(device, actor, actor.skin, camera, options) {}
  // The same mesh and bones with other weights.
  PoseSystem(ocl::DeviceContext& device, const Actor& actor, const SkinWeights& skin, const Camera& camera,
             const PoseOptions& options);

  // Constants of the next frame. frame: nullptr, or alive until the next call.
  // Throws LogicError for a contour vertex out of range or a frame of another size than the camera's.
  void set_frame(const KeypointTargets& targets, const DeviceFrame* frame, std::span<const int32_t> contour_vertices,
                 std::span<const VertexMatch> matches = {}, std::span<const ShadedVertex> shaded = {});

  // The same for take_steps(), with vertices that the device chooses from `seen`, whose buffers live until the next
  // call. Only where chooses().
  void set_seen_frame(const KeypointTargets& targets, const DeviceFrame* frame, const SeenVertices& seen);
  bool chooses() const { return chooses_ && groups_.work(); }
  // What the device chose, for all but take_steps(). Blocking.
  void read_choice();

  // stands: of each of soles() how sure it is to rest on the floor, 0..1. floor nullptr: none is known, as before the
  // first call. Holds until the next call.
  void set_floor(const Floor* floor, std::span<const double> stands);

  // What E_rest draws each angle to, [n_dofs]; before the first call the actor's own rest. Holds until the next call.
  void set_rest(std::span<const RestAngle> rest);

  // Rounds of steps that are launched one after the other, each from where the one before ended; the host reads once.
  // Only where chooses(). For each round, from 0 on, at most LC_POSE_MOST_ROUNDS: what set_seen_frame() and
  // set_floor() say, without doubt and, but of the first, without stands. soles_before: see PoseInputs; empty: unknown.
  void set_round(int round, const KeypointTargets& targets, const SeenVertices& seen, const Floor* floor,
                 std::span<const double> stands, std::span<const float> soles_before);
  // Of rounds that were set.
  void begin_rounds(int n_rounds, const PoseState& start, const DeviceFrame* frame);
  // [8*n_bones], camera frame: see motions().
  void set_motions(std::span<const float> dual_quats) { motions_.write_later(dual_quats); }
  // PoseInput::match_px, of all that is launched until the next call.
  void set_match_px(double px) { match_px_ = px; }
  struct Round {
    int round = 0;
    int n_steps = 0;
    double settled_px = 0;
    double doubt_3d_mm = 0;
    float least_moved_px = -INFINITY;  // nothing is done where the round before moved no keypoint so far
    bool tells = true;                 // whether it may be the last; others tell no residuals
  };
  // With vertices that the device chooses from `seen`.
  void launch_round(const Round& round, const SeenVertices& seen);
  // What came of the last round that was not left out. Blocking. Nothing where the device could not.
  struct Rounds {
    int round = 0;
    PoseSteps steps;
    double moved_px = 0;                            // furthest that a keypoint went in it
    std::array<double, kKeypointCount> weights_3d;  // of the targets, doubted
  };
  std::optional<Rounds> read_rounds();
  // Of the rounds: how far the last one moved a keypoint, its bones' motions, and for launches of groups that wait
  // for each other between two rounds their state (kernels/shared/all_arrived.h).
  const ocl::Buffer<float>& moved() const { return moved_; }
  const ocl::Buffer<float>& motions() const { return motions_; }
  const ocl::Buffer<int32_t>& look_state() const { return look_state_; }
  // After a look that no round follows: the next one waits from the beginning.
  void forget_look() { look_state_.fill(0); }

  PoseNormalEquations assemble(const PoseState& state);
  // Weighted, [n_rows]: 8 per keypoint (2D 2, 3D 3, temporal 3), n_dofs joint limits, n_dofs rest angles, one per point
  // of the soles, one per contour vertex (0 where it is not inside the picture), two per match, one per shaded vertex.
  std::vector<float> residuals(const PoseState& state);
  // n_steps, fewer where one moves no keypoint by settled_px (0: never), in one launch with one read. Nothing where the
  // device cannot, or for more than LC_POSE_MOST_STEPS: then assemble, solve and ask for the residuals.
  std::optional<PoseSteps> take_steps(const PoseState& start, int n_steps, double settled_px);
  // J as the device filled it, [n_rows, n_unknowns].
  Eigen::MatrixXf jacobian(const PoseState& state);

  int n_unknowns() const { return layout_.n_unknowns; }
  int n_rows() const { return n_point_rows_ + n_contour() + 2 * n_matches() + n_shaded(); }
  int n_point_rows() const { return n_point_rows_; }
  const std::vector<SolePoint>& soles() const { return points_.soles; }
  int n_contour() const { return inputs_.n_contour(); }
  int n_matches() const { return inputs_.n_matches(); }
  int n_shaded() const { return inputs_.n_shaded(); }
  // Root of the weight of one contour row: lambda_silhouette times contour vertices per used vertex.
  float contour_root() const { return inputs_.contour_root(); }
  // Where the device chose the matches: what they fall short of perfect ones in weight, and what those would weigh.
  double missed_weight() const { return inputs_.missed_weight(); }
  double seen_weight() const { return inputs_.seen_weight(); }

 private:
  void upload(const PoseState& state);
  void launch_records();
  void launch_rows();
  void launch_choice(size_t n_slices, float least_moved_px = -INFINITY);
  void launch_gauss_newton(size_t n_groups, const PoseStepsArg& steps);
  PoseStepsArg steps_arg(int n_steps, double settled_px);
  PoseSteps steps_read();
  int told(int place) const;
  size_t n_parts() const;
  void launch_normal_equations(bool write_rows);
  void read_results(size_t n_rows);
  void set_picture(const DeviceFrame* frame);
  std::vector<float> residuals_read() const;
  PoseContour contour_arg() const;

  PosePoints points_;
  PoseOptions options_;
  int width_ = 0;
  int height_ = 0;
  PinholeArg pinhole_{};
  PoseLayout layout_{};
  int n_vertices_ = 0;
  int n_point_rows_ = 0;
  bool is_cpu_ = true;
  int lanes_ = 1;
  int n_tiles_ = 0;
  const DeviceFrame* frame_ = nullptr;
  PoseRowInputs inputs_;
  bool inputs_changed_ = true;        // since they were uploaded
  std::optional<SeenVertices> seen_;  // what the device is to choose from
  bool rests_ = false;                // whether soles_before of the rounds are known
  double match_px_ = 1;
  size_t most_rows_ = 0;
  std::vector<float> limits_host_;  // what limits_ holds
  std::vector<float> step_host_;
  std::vector<float> gram_host_;
  std::vector<float> results_host_;
  bool takes_steps_ = false;  // whether the device has what chain and solve there need
  bool chooses_ = false;      // likewise, for choose.cl
  ocl::GroupsTogether groups_;
  uint32_t tag_ = 1;  // of the next step's sums (kernels/shared/tagged.h); wraps around

  ocl::Buffer<float> step_;  // as the host makes it
  ocl::Buffer<float> inputs_on_device_;
  ocl::Buffer<double> chain_;
  ocl::Buffer<int32_t> links_;
  ocl::Buffer<float> limits_;
  ocl::Buffer<float> moves_;
  ocl::Buffer<float> rest_;          // [3*n_vertices]
  ocl::Buffer<float> rest_normals_;  // [3*n_vertices]
  ocl::Buffer<int32_t> bones_;       // [4*n_vertices]
  ocl::Buffer<float> weights_;       // [4*n_vertices]
  ocl::Buffer<float> point_records_;
  ocl::Buffer<float> contour_records_;
  ocl::Buffer<float> point_residuals_;
  ocl::Buffer<float> contour_residuals_;
  ocl::Buffer<float> match_records_;
  ocl::Buffer<float> match_residuals_;
  ocl::Buffer<float> shading_records_;
  ocl::Buffer<float> shading_residuals_;
  ocl::Buffer<float> J_;
  ocl::Buffer<float> gram_;
  ocl::Buffer<uint64_t> parts_, sums_;  // of gram_ and their sums, tagged, GPUs
  ocl::Buffer<float> results_;          // GPUs
  ocl::Buffer<float> moved_, motions_;  // GPUs, see the rounds
  ocl::Buffer<double> kept_;            // likewise
  ocl::Buffer<int32_t> look_state_;     // likewise
  size_t n_slices_ = 1;                 // of choose.cl, and what they tell each other and wait with
  ocl::Buffer<int64_t> choice_told_;
  ocl::Buffer<int32_t> choice_state_;
  ocl::Kernel point_records_kernel_;
  ocl::Kernel contour_records_kernel_;
  ocl::Kernel match_records_kernel_;
  ocl::Kernel shading_records_kernel_;
  ocl::Kernel fill_points_kernel_;
  ocl::Kernel fill_skinned_kernel_;
  ocl::Kernel gram_kernel_;
  ocl::Kernel gauss_newton_kernel_;  // GPUs, with sum_parts_kernel_
  ocl::Kernel sum_parts_kernel_;
  ocl::Kernel choose_kernel_;  // where chooses_
};

}  // namespace livecap
