// Videos whose frames are not evenly spaced in time, as those of phones and webcams: a file that can say when a frame
// was taken does.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace livecap {

// Seconds from the first frame. Empty where each lies within half a frame of i / fps (rounded time stamps are no
// unevenness), and where the stamps do not grow or are not finite.
std::vector<double> uneven_times_s(std::span<const double> pts_ms, double fps);

// The warning of such frames. source: what has them; timed, even: the files made of it that tell their times and that
// have one rate.
std::string uneven_warning(const std::string& source, double fps, const std::string& timed, const std::string& even);

}  // namespace livecap
