// Which network ran: report.json names its file's digest.
#pragma once

#include <filesystem>
#include <string>

namespace livecap {

// SHA-256 of a file in hexadecimal. Throws IoError.
std::string file_sha256(const std::filesystem::path& path);

}  // namespace livecap
