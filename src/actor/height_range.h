// How tall actors may be, and people whom one is made of.
#pragma once

#include "base/value_range.h"

namespace livecap {

inline constexpr ValueRange kActorHeightMm{500, 3000};
inline constexpr ValueRange kPersonHeightMm{800, 2500};

// height_mm: 0 is not given. Throws ConfigError.
inline void require_person_height(double height_mm) {
  if (height_mm == 0) return;
  require_within("--height", height_mm / 1000, {kPersonHeightMm.least / 1000, kPersonHeightMm.most / 1000}, "metres");
}

}  // namespace livecap
