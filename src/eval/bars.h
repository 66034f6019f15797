// The figures a capture is held to (docs/evaluation.md), and whether it meets them.
#pragma once

#include <string>
#include <vector>

#include "eval/evaluate.h"

namespace livecap {

struct Bar {
  std::string figure;     // "silhouette IoU, mean"
  bool at_least = false;  // false: the value must be at most the bar
  double bar = 0;
  double value = 0;  // NaN: cannot be told from what there is
  int digits = 2;    // worth printing
  std::string unit;  // " mm" or empty

  bool known() const;
  bool passed() const;  // false while unknown
};

// pose_only: the same video captured with --no-surface; nullptr: the bars that need it stay unknown.
std::vector<Bar> judge_bars(const EvalReport& report, const EvalReport* pose_only = nullptr);

// "0.958" or "23.1 mm"; "unknown".
std::string bar_value_text(const Bar& bar);
// "at least 0.95".
std::string bar_text(const Bar& bar);
// One line each: met, missed or unknown.
std::string bars_text(const std::vector<Bar>& bars);
// A JSON list of {figure, bar, value, passed}.
std::string bars_json(const std::vector<Bar>& bars);

}  // namespace livecap
