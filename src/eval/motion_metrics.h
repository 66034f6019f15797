// Scores of motion over time: jitter, sliding feet, losses. Fed frame by frame in the order of the video.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace livecap {

// Mean lengths of accelerations over points and frames, m/s^2.
struct Jitter {
  int64_t n = 0;        // points times frames
  double error = 0;     // of the difference of both accelerations: the mean acceleration error (Kanazawa et al., 2019)
  double captured = 0;  // of the capture's own
  double truth = 0;     // of the truth's own
};

// The mean error over the truth's own acceleration; NaN where either is not known.
double error_over_truth(const Jitter& jitter);

// Acceleration of p at frame t: (p[t-1] - 2 p[t] + p[t+1]) fps^2, wherever three frames on end are known.
class JitterMeter {
 public:
  // fps: frames per second, > 0 (LogicError). centred: of the points relative to their centroid, per frame.
  explicit JitterMeter(double fps, bool centred = false);

  // The next frame's points, [3*n] mm, n the same in all frames (LogicError). An empty list: not known, which breaks
  // the sequence; NaN: this point is not known, which breaks its sequence alone.
  void add(std::span<const float> estimate, std::span<const float> truth);

  Jitter result() const;

 private:
  struct Points {
    std::vector<float> estimate;
    std::vector<float> truth;
  };

  double fps_;
  bool centred_;
  Points last_, before_last_;  // empty: not known
  Jitter sum_;                 // the means are sums here
};

// Feet that ought to stand.
struct FootSlide {
  int64_t n = 0;              // steps from frame to frame that were judged
  double mm_per_s = 0;        // mean horizontal speed of the captured foot
  double truth_mm_per_s = 0;  // of the true one, which is not quite still either
};

// The true foot stands at frame t when it stays within this distance of its place at t ...
inline constexpr double kPlantedMm = 15;
// ... in all frames up to this time before and after.
inline constexpr double kPlantedS = 1.0 / 15;

// One foot: [n_frames] of [3] mm, camera frame; empty where it is not known. Judged are the steps between two frames at
// which the true foot stands; horizontal are x and z of the camera. A foot held still in the air stands too. Throws
// LogicError when the lists differ in length or fps is not positive.
FootSlide foot_slide(const std::vector<std::vector<float>>& estimate, const std::vector<std::vector<float>>& truth,
                     double fps);

// The mean of several feet, weighted by their steps.
FootSlide combined(const FootSlide& a, const FootSlide& b);

struct Losses {
  int64_t lost = 0;           // frames with a person that are not tracked
  int64_t n_losses = 0;       // times a tracked person was lost
  int64_t n_recovered = 0;    // of these: tracked again before the person left
  int64_t longest = 0;        // frames of the longest loss
  int64_t longest_entry = 0;  // most frames between a person's appearance and the first tracked one
};

// One entry per frame. Throws LogicError when the lists differ in length.
Losses count_losses(const std::vector<bool>& person, const std::vector<bool>& tracked);

}  // namespace livecap
