// How much of a colour's brightness its red, green and blue are (ITU-R BT.601), for brightness; the colour matrices of
// videos are in image/picture_converter.cpp. On devices: kernels/shared/luminance.h.
#pragma once

namespace livecap {

inline constexpr int kRedPerMille = 299, kGreenPerMille = 587, kBluePerMille = 114;
inline constexpr double kRedLuminance = kRedPerMille / 1000.0, kGreenLuminance = kGreenPerMille / 1000.0,
                        kBlueLuminance = kBluePerMille / 1000.0;

}  // namespace livecap
