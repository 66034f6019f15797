// How simulated cloth drapes by what pictures show of it. Limp cloth lies on legs and falls in, stiff cloth stands away
// from both, and nothing tells beforehand which: so cloth's matches tell, in the picture, which share of the way it is
// from its simulated to its skinned place, and to the vertical axis through the hips. Both shares hold for all of it,
// along the line of sight and behind as well. Not of the paper.
#pragma once

#include <Eigen/Core>
#include <array>

#include "actor/actor.h"
#include "cloth/cloth_graph.h"
#include "cloth/layout.h"
#include "geometry/pinhole_arg.h"
#include "geometry/skeleton.h"
#include "livecap/camera.h"
#include "ocl/buffer.h"
#include "ocl/kernel.h"

namespace livecap {

struct DrapeOptions {
  float memory_s = 1;  // what was seen so long ago counts by 1 / e; a frame is at most 0.1 s
  // mm. How far apart the places must be for one frame to count as much as the doubt that cloth is anywhere but where
  // it is simulated.
  float clings_doubt_mm = 40, narrows_doubt_mm = 100;
  float narrows_from = -0.3f, narrows_to = 0.4f;  // of the distance to the axis, at the hem
  // Shares are shrunk by how little they explain, 1 - unexplained / (independent_parts * explained) of them, as if
  // cloth that is seen moved in so many parts independent of each other; none where that is below 0.
  float independent_parts = 12.5f;
  // Degrees by which the thigh that is lifted more is off straight down: skinning, which carries cloth along with it,
  // is trusted below the first, and not at all from the second on.
  float lifted_from_deg = 30, lifted_to_deg = 55;

  void validate() const;  // throws ConfigError
};

// Shares of the way, clings 0..1 and narrows.
struct DrapeShares {
  double clings = 0, narrows = 0;
};

// The normal equations of both shares, from the LC_DRAPE_TOLD sums of look_at_drape, frame by frame.
class DrapeEvidence {
 public:
  explicit DrapeEvidence(const DrapeOptions& options) : options_(options) {}

  // told: how far matches were from where cloth was moved to by `moved`, `seconds` after the last. Sums that are not
  // finite do not count.
  void add(const std::array<float, LC_DRAPE_TOLD>& told, const DrapeShares& moved, double seconds);
  // Nothing told: none.
  DrapeShares shares() const;

 private:
  DrapeOptions options_;
  Eigen::Matrix2d ways_ways_ = Eigen::Matrix2d::Zero();
  Eigen::Vector2d ways_off_ = Eigen::Vector2d::Zero();
  double off_off_ = 0, weight_ = 0;  // weight: of one frame, the largest that is remembered
};

class Drape {
 public:
  // cloth: of the actor, simulated with this looseness (cloth/cloth_simulation.h). Keeps no reference to them; the
  // device must outlive it. Throws ConfigError, and LogicError when nothing hangs.
  Drape(ocl::DeviceContext& device, const Actor& actor, const ClothGraph& cloth, float looseness, const Camera& camera,
        const DrapeOptions& options);

  // In this order; all is enqueued, and the last look of a frame counts. Buffers are [3n] mm, camera frame; LogicError
  // for others.
  // skinned: V^S by skinning alone.
  void keep(const ocl::Buffer<float>& skinned);
  // skinned: V^S with cloth simulated, which is moved. start, start_before: with the displacements from V^S of the last
  // two frames, moved by the shares of these. up: unit, camera frame.
  void move(const PosedSkeleton& posed, const Eigen::Vector3d& up, ocl::Buffer<float>& skinned,
            ocl::Buffer<float>& start, ocl::Buffer<float>& start_before);
  // skinned: as moved; matches: [LC_MATCH*n] of a TextureMatcher.
  void look(const ocl::Buffer<int32_t>& visible, const ocl::Buffer<float>& skinned, const ocl::Buffer<float>& matches);

  // After the next blocking read: what was looked at counts from now on. seconds: since the last frame.
  void learn(double seconds);

  const DrapeShares& shares() const { return shares_; }  // of the next move
  void reset();                                          // forgets

 private:
  DrapeStep step_of(const PosedSkeleton& posed, const Eigen::Vector3d& up) const;

  DrapeOptions options_;
  PinholeArg camera_;
  int n_;
  size_t group_;
  std::array<std::array<int, 2>, 2> thighs_;  // hip and knee
  ocl::Buffer<int32_t> vertices_;
  ocl::Buffer<float> levels_, only_skinned_, ways_, told_;
  ocl::Kernel drape_, look_;
  std::array<float, LC_DRAPE_TOLD> told_last_{};
  DrapeEvidence evidence_;
  DrapeShares shares_;
  std::array<DrapeShares, 2> before_;  // of the last move and the one before
};

}  // namespace livecap
