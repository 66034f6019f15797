// Videos whose frames are not evenly spaced in time, as those of phones and webcams: a file that can say when a frame
// was taken does.
#pragma once

#include <span>
#include <vector>

namespace livecap {

// Seconds from the first frame. Empty where each lies within half a frame of i / fps (rounded time stamps are no
// unevenness), and where the stamps do not grow or are not finite.
std::vector<double> uneven_times_s(std::span<const double> pts_ms, double fps);

}  // namespace livecap
