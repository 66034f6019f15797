// The energy terms of the method, one row each: the paper's eleven ("Skeletal Pose Estimation" and "Non-rigid Surface
// Registration"), E_match of both, E_shading, E_floor, E_rest and E_depth. A row says what a term's flat function takes
// and gives; everything that holds for all terms (tests, device checks, ablation by name) loops over this table.
//
// Adding a term: kernels/terms/<file>.cl with <file>_row and <file>_flat, a line in src/geometry/reference.h, a line in
// kernels/tools/term_check.cl, and a row here.
#pragma once

#include <span>
#include <string_view>

namespace livecap {

enum class TermStage { kPose, kSurface };

// r[n_residuals], J[n_residuals * n_unknowns] row major, from x[n_unknowns] and params[n_params], in double.
using TermFunction = void (*)(const double* x, const double* params, double* r, double* J);

struct Term {
  std::string_view name;  // unique; what --without takes
  TermStage stage;
  int n_residuals;                // of one instance (one keypoint, one vertex, one directed edge ...)
  int n_unknowns;                 // local unknowns: the points or the angle the residual depends on
  int n_params;                   // constants of one instance
  double paper_weight;            // section "Results"; factor of the squared residual; 0: not in the paper
  TermFunction flat;              // the shared formula in double precision
  std::string_view check_kernel;  // the same on a device, in kernels/tools/term_check.cl
};

std::span<const Term> term_table();

// nullptr when there is no such term.
const Term* find_term(std::string_view name);

// Largest sizes in the table, for fixed-size scratch arrays.
inline constexpr int kMaxTermResiduals = 3;
inline constexpr int kMaxTermUnknowns = 6;
inline constexpr int kMaxTermParams = 19;

}  // namespace livecap
