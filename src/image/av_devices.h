// FFmpeg's devices, webcams and windows, loaded when the first is asked for: libavdevice loads seventy libraries of
// desktops and sound, which nobody else needs.
#pragma once

#include <string>

namespace livecap {

// Makes them known to FFmpeg. who: what needs them, for the message. Throws ConfigError when libavdevice is not
// installed.
void register_av_devices(const std::string& who);

}  // namespace livecap
