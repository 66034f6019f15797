// livecap eval --ablate: captures one video again and again, each time without one part of the method, and compares all
// of it with the ground truth (paper, "Ablation Study").
#pragma once

#include <filesystem>

#include "eval/ablation.h"
#include "eval/evaluate.h"
#include "livecap/capture.h"

namespace livecap::tools {

// capture: the full method; `out` is the folder that gets one capture folder per row. truth, views: as in eval. Throws
// what run_capture and evaluate throw, Error when interrupted.
Ablation run_ablation(const CaptureOptions& capture, const EvalOptions& eval);

// Folder of the full method's capture below capture.out.
std::filesystem::path full_capture_folder(const CaptureOptions& capture);

}  // namespace livecap::tools
