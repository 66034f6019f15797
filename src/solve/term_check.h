// Runs a term's flat function on a device over a batch of instances, for the term tests and `livecap devices`.
#pragma once

#include <vector>

#include "ocl/context.h"
#include "solve/term_table.h"

namespace livecap {

// n instances back to back; float because that is what the device computes in.
struct TermBatch {
  int n = 0;
  std::vector<float> x;       // [n*n_unknowns]
  std::vector<float> params;  // [n*n_params]
};

struct TermValues {
  std::vector<float> r;  // [n*n_residuals]
  std::vector<float> J;  // [n*n_residuals*n_unknowns] row major
};

// Throws LogicError when the batch's sizes are not those of the term.
TermValues evaluate_on_device(ocl::DeviceContext& device, const Term& term, const TermBatch& batch, size_t local = 0);

// The same in double on the host.
struct TermValuesDouble {
  std::vector<double> r;
  std::vector<double> J;
};
TermValuesDouble evaluate_on_host(const Term& term, const TermBatch& batch);

// Every term's device value against the host's, on a few fixed instances.
std::vector<ocl::SelfTestResult> solve_self_test(ocl::DeviceContext& device);

}  // namespace livecap
