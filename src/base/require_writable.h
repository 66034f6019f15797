// That a file can be written is known before the work whose result it gets.
#pragma once

#include <filesystem>

namespace livecap {

// Throws IoError where `file` is a folder, or lies in none that is there and may be written to; of a link, what it
// leads to.
void require_writable(const std::filesystem::path& file);

}  // namespace livecap
