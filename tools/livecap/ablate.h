// livecap eval --ablate: captures one video again and again, each time without one part of the method, and compares all
// of it with the ground truth (paper, "Ablation Study").
#pragma once

#include <filesystem>

#include "eval/ablation.h"
#include "eval/evaluate.h"
#include "livecap/capture.h"

namespace livecap::tools {

// capture: the full method; `out` is the folder that gets the capture folders. eval: truth and views. draws: captures
// of each row, which differ by CaptureOptions::draw. keep: not only the full method's first. Throws what run_capture
// and evaluate throw, Error when interrupted.
Ablation run_ablation(const CaptureOptions& capture, const EvalOptions& eval, int draws, bool keep);

// Folder of the full method's first capture below capture.out.
std::filesystem::path full_capture_folder(const CaptureOptions& capture);

}  // namespace livecap::tools
