#include "solve/term_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "ocl/kernel_source.h"
#include "solve/term_check.h"
#include "support/test_device.h"

namespace livecap {
namespace {

TEST(TermTable, HoldsThePapersElevenTermsOnce) {
  std::set<std::string_view> names;
  int n_pose = 0;
  for (const Term& term : term_table()) {
    EXPECT_TRUE(names.insert(term.name).second) << term.name;
    n_pose += term.stage == TermStage::kPose;
    EXPECT_LE(term.n_residuals, kMaxTermResiduals);
    EXPECT_LE(term.n_unknowns, kMaxTermUnknowns);
    EXPECT_LE(term.n_params, kMaxTermParams);
    EXPECT_EQ(find_term(term.name), &term);
  }
  EXPECT_EQ(names.size(), 17u);  // the paper's eleven, E_match of both stages, E_shading, E_floor, E_rest, E_depth
  EXPECT_EQ(n_pose, 9);
  EXPECT_EQ(find_term("gravity"), nullptr);
}

TEST(TermTable, EveryTermFileIsInTheTable) {
  std::set<std::string> checks;
  for (const Term& term : term_table()) checks.emplace(term.check_kernel);
  int n_files = 0;
  for (const std::string& path : ocl::kernel_paths()) {
    if (path.rfind("terms/", 0) != 0) continue;
    ++n_files;
    const std::string stem = path.substr(6, path.size() - 6 - 3);
    EXPECT_TRUE(checks.count("check_" + stem)) << "kernels/" << path << " has no row in the term table";
  }
  EXPECT_EQ(n_files, 15);  // the formulas of silhouette and match serve both stages
}

TEST(TermTable, SelfTestPassesOnEveryDevice) {
  test::on_every_device([](ocl::DeviceContext& device) {
    const auto results = solve_self_test(device);
    EXPECT_EQ(results.size(), term_table().size());
    for (const auto& result : results) EXPECT_TRUE(result.ok) << result.kernel << ": " << result.detail;
  });
}

}  // namespace
}  // namespace livecap
