// report.json: what ran where, with which options, and how it went.
#pragma once

#include <string>

#include "actor/actor.h"
#include "export/capture_glb.h"
#include "livecap/capture.h"
#include "ocl/device.h"

namespace livecap {

// model_sha256: of the network's file; empty when none ran.
std::string report_json(const CaptureOptions& options, const CaptureReport& report, const ocl::DevicePair& devices,
                        const std::string& model_sha256, const CaptureGlbReport& glb, const Actor& actor);

}  // namespace livecap
