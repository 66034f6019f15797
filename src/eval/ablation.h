// What each part of the method is worth: the same video captured several times, one table.
#pragma once

#include <string>
#include <vector>

#include "eval/evaluate.h"

namespace livecap {

// Captures of the table that differ by their draws only (docs/evaluation.md#draws), or the network alone.
struct AblationRow {
  std::string name;               // "without snapping"
  std::string group;              // rows of one group stand together under its name
  std::string options;            // what to give `livecap capture`, for the reader
  std::string paper;              // what the paper says about it; empty: nothing
  std::vector<EvalReport> draws;  // one at least
};

struct Ablation {
  std::string video;
  std::vector<AblationRow> rows;
  size_t full = 0;       // the row everything is compared with
  size_t pose_only = 0;  // the row of the skinned pose
};

// How much worse than the full method a row is: its mean vertex error over the full one's, minus 1; and the standard
// error of that, paired by draw. NaN without either; the latter also with one draw or another number of them.
struct VertexChange {
  double change = 0;
  double standard_error = 0;
};
VertexChange vertex_change(const AblationRow& row, const AblationRow& full);

// Mean vertex error of a row's draws (translation-aligned, mm) and the standard deviation of that of one draw; the
// latter is NaN with one draw, both without true vertices.
struct DrawnError {
  double mean_mm = 0;
  double deviation_mm = 0;
};
DrawnError vertex_error(const AblationRow& row);

std::string ablation_text(const Ablation& ablation);
std::string ablation_json(const Ablation& ablation);
std::string ablation_html(const Ablation& ablation);

}  // namespace livecap
