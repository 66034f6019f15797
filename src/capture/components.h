// What `--without NAME` can switch off: the energy terms and the components around them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "livecap/camera.h"

namespace livecap {

struct TrackerOptions;

// The one component outside the tracker: without it the background is subtracted without the network's person mask.
inline constexpr std::string_view kMaskGating = "mask_gating";

// All names in the order they are documented.
const std::vector<std::string>& component_names();

// Throws ConfigError listing the names when this is not one.
void require_component(const std::string& name);

// Switches the component off. kMaskGating changes nothing here.
void switch_off(const std::string& name, TrackerOptions& options);

}  // namespace livecap
