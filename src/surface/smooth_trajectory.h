// Offline smoothing of the vertex trajectories with [0.15, 0.7, 0.15] over time (`--smooth`; never in live mode).
#pragma once

#include <span>
#include <vector>

namespace livecap {

// out = 0.15 previous + 0.7 current + 0.15 next, element by element. An empty `previous` or `next` (the ends of a
// sequence) is replaced by `current`. All other spans have one size, any unit; out may be current. Throws LogicError.
void smooth_frame(std::span<const float> previous, std::span<const float> current, std::span<const float> next,
                  std::span<float> out);

// The same for a whole sequence in place: frames[t] is one frame's values.
void smooth_trajectory(std::vector<std::vector<float>>& frames);

}  // namespace livecap
