// Pictures of one run, numbered from 0.
#pragma once

#include <filesystem>
#include <system_error>

#include "base/text.h"

namespace livecap::synth {

// name: of a file by its number, as format() takes it. Removes those from n on that an earlier, longer run left in the
// folder, which would count as this run's.
inline void remove_numbered_from(int n, const std::filesystem::path& folder, const char* name) {
  std::error_code ignored;
  while (std::filesystem::remove(folder / format(name, n), ignored)) ++n;
}

}  // namespace livecap::synth
