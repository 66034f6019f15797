#include "solve/term_check.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "base/text.h"
#include "livecap/error.h"
#include "ocl/buffer.h"
#include "ocl/kernel.h"

namespace livecap {
namespace {

void require_sizes(const Term& term, const TermBatch& batch) {
  if (batch.x.size() != size_t(batch.n) * term.n_unknowns || batch.params.size() != size_t(batch.n) * term.n_params)
    throw LogicError(format("term %s: %d instances need %d + %d values, got %zu + %zu", std::string(term.name).c_str(),
                            batch.n, batch.n * term.n_unknowns, batch.n * term.n_params, batch.x.size(),
                            batch.params.size()));
}

// Instances in the range the terms work in: points 2.5 m away, images 640 px wide, angles of a few radians.
TermBatch example_batch(const Term& term, int n) {
  TermBatch batch;
  batch.n = n;
  for (int i = 0; i < n; ++i) {
    for (int k = 0; k < term.n_unknowns; ++k)
      batch.x.push_back(term.n_unknowns == 1 ? -2.0f + i : (k % 3 == 2 ? 2500.0f : 100.0f) + 7.0f * i + 3.0f * k);
    for (int k = 0; k < term.n_params; ++k) {
      const bool has_camera = term.n_params == 6 && term.n_residuals == 2;
      const bool has_image = term.n_params >= 10;
      float value = term.n_unknowns == 1 ? (k == 0 ? -1.0f : 1.0f) : 0.25f * (k + 1) + 0.125f * i;
      if ((has_camera || has_image) && k < 4) value = k < 2 ? 600.0f : 300.0f;
      batch.params.push_back(value);
    }
  }
  return batch;
}

}  // namespace

TermValues evaluate_on_device(ocl::DeviceContext& device, const Term& term, const TermBatch& batch, size_t local) {
  require_sizes(term, batch);
  ocl::Kernel kernel(device, "tools/term_check.cl", std::string(term.check_kernel));
  ocl::Buffer<float> x(device, batch.x);
  ocl::Buffer<float> params(device, batch.params);
  ocl::Buffer<float> r(device, size_t(batch.n) * term.n_residuals);
  ocl::Buffer<float> J(device, size_t(batch.n) * term.n_residuals * term.n_unknowns);
  kernel.launch(batch.n, local, batch.n, x, params, r, J);
  return {r.read_all(), J.read_all()};
}

TermValuesDouble evaluate_on_host(const Term& term, const TermBatch& batch) {
  require_sizes(term, batch);
  TermValuesDouble out;
  out.r.resize(size_t(batch.n) * term.n_residuals);
  out.J.resize(size_t(batch.n) * term.n_residuals * term.n_unknowns);
  const std::vector<double> x(batch.x.begin(), batch.x.end());
  const std::vector<double> params(batch.params.begin(), batch.params.end());
  for (int i = 0; i < batch.n; ++i)
    term.flat(&x[size_t(i) * term.n_unknowns], &params[size_t(i) * term.n_params], &out.r[size_t(i) * term.n_residuals],
              &out.J[size_t(i) * term.n_residuals * term.n_unknowns]);
  return out;
}

std::vector<ocl::SelfTestResult> solve_self_test(ocl::DeviceContext& device) {
  std::vector<ocl::SelfTestResult> results;
  for (const Term& term : term_table()) {
    ocl::SelfTestResult result{"tools/term_check.cl " + std::string(term.name), true, {}};
    const TermBatch batch = example_batch(term, 5);
    const TermValues got = evaluate_on_device(device, term, batch);
    const TermValuesDouble expected = evaluate_on_host(term, batch);
    const auto compare = [&](const char* what, const std::vector<float>& a, const std::vector<double>& b) {
      double scale = 1;
      for (double value : b) scale = std::max(scale, std::abs(value));
      for (size_t i = 0; i < b.size(); ++i) {
        if (std::abs(a[i] - b[i]) <= 1e-5 * scale) continue;
        result.ok = false;
        result.detail = format("%s[%zu]: expected %g, found %g", what, i, b[i], a[i]);
      }
    };
    compare("r", got.r, expected.r);
    compare("J", got.J, expected.J);
    results.push_back(result);
  }
  return results;
}

}  // namespace livecap
