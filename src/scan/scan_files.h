// Readers of scan.h's formats. Private to scan.cpp.
#pragma once

#include "scan/scan.h"

namespace livecap {

// texture: as read_scan's.
Scan read_obj(const std::filesystem::path& path, std::vector<std::string>& notes, const std::filesystem::path& texture);
Scan read_ply(const std::filesystem::path& path, std::vector<std::string>& notes);
Scan read_glb_scan(const std::filesystem::path& path, std::vector<std::string>& notes);

}  // namespace livecap
