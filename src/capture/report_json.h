// report.json: what ran where, with which options, and how it went.
#pragma once

#include <string>

#include "actor/actor.h"
#include "export/capture_glb.h"
#include "livecap/capture.h"
#include "ocl/device.h"

namespace livecap {

// SHA-256 of a file in hexadecimal. Throws IoError.
std::string file_sha256(const std::string& path);

std::string report_json(const CaptureOptions& options, const CaptureReport& report, const ocl::DevicePair& devices,
                        const CaptureGlbReport& glb, const Actor& actor);

}  // namespace livecap
