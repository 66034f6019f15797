// An evaluation as one self-contained HTML file: bars, curves, error on the mesh, frames side by side, tables. No
// scripts, nothing from outside.
#pragma once

#include <string>
#include <vector>

#include "eval/ablation.h"
#include "eval/bars.h"
#include "eval/evaluate.h"

namespace livecap {

struct HtmlReport {
  EvalOptions options;  // of `report`: the pictures are made from its folders
  std::string video;    // empty: what report.json names
  const EvalReport& report;
  const EvalReport* pose_only = nullptr;  // beside it in the curves, and where the surface stage helps on the mesh
  const Ablation* ablation = nullptr;
  std::vector<Bar> bars;
};

// Throws like evaluate().
std::string html_report(const HtmlReport& input);

}  // namespace livecap
