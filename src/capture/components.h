// What `--without NAME` can switch off: the energy terms and the components around them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "livecap/camera.h"

namespace livecap {

struct TrackerOptions;

// Components outside the tracker. Without the first the background is subtracted without the network's person mask,
// without the second the surface is fitted to poses as they are solved, two frames earlier (capture/fixed_lag.h),
// without the third bodies alone tell which way is up (image/upright_edges.h).
inline constexpr std::string_view kMaskGating = "mask_gating";
inline constexpr std::string_view kFixedLag = "fixed_lag";
inline constexpr std::string_view kUpright = "upright";

// All names in the order they are documented.
const std::vector<std::string>& component_names();

// Throws ConfigError listing the names when this is not one.
void require_component(const std::string& name);

// Switches the component off. Those outside the tracker change nothing here.
void switch_off(const std::string& name, TrackerOptions& options);

}  // namespace livecap
