// What each part of the method is worth: the same video captured several times, one table.
#pragma once

#include <string>
#include <vector>

#include "eval/evaluate.h"

namespace livecap {

// A capture of the table, or the network alone.
struct AblationRow {
  std::string name;     // "without snapping"
  std::string group;    // rows of one group stand together under its name
  std::string options;  // what to give `livecap capture`, for the reader
  std::string paper;    // what the paper says about it; empty: nothing
  EvalReport report;
};

struct Ablation {
  std::string video;
  std::vector<AblationRow> rows;
  size_t full = 0;       // the row everything is compared with
  size_t pose_only = 0;  // the row of the skinned pose
};

// How much worse than the full method a row is: its mean over the full one's, minus 1. NaN without either.
double relative_change(const Summary& row, const Summary& full);

std::string ablation_text(const Ablation& ablation);
std::string ablation_json(const Ablation& ablation);
std::string ablation_html(const Ablation& ablation);

}  // namespace livecap
