// Where what is written under a name ends up: a file that is replaced in one step must be neither a link to the file
// meant, nor a pipe or a device, of which nothing but the name would be left.
#pragma once

#include <filesystem>

namespace livecap {

// What a link leads to, also where nothing is there yet; any other path as it is.
std::filesystem::path link_target(std::filesystem::path path);

// A pipe or a device, also behind a link: takes bytes one after another and is written to as it is. Throws IoError for
// what nothing can be written to so: a disk, a socket.
bool is_stream(const std::filesystem::path& path);

}  // namespace livecap
