// Each bar passes on one side of its number and fails on the other, and never passes without data.
#include "eval/bars.h"

#include <gtest/gtest.h>

namespace livecap {
namespace {

Summary all(double value) {
  return {10, value, value, value, value, value, value};
}

// Exactly on every bar.
EvalReport on_the_bars() {
  EvalReport report;
  report.iou = all(0.95);
  report.iou.min = 0.88;
  report.vertex_aligned_mm = all(20);
  report.loose_aligned_mm = all(70);
  report.joint_mm = all(50);
  report.joint_aligned_mm = all(30);
  report.network_joint_aligned_mm = all(40);
  report.vertex_jitter = {10, 2.6, 1, 2};
  report.joint_jitter = {10, 1.3, 1, 1};
  return report;
}

EvalReport pose_only() {
  EvalReport report;
  report.vertex_aligned_mm = all(20 / 0.85);
  report.loose_aligned_mm = all(100);
  return report;
}

int failures(const EvalReport& report, const EvalReport& pose) {
  int n = 0;
  for (const Bar& bar : judge_bars(report, &pose)) n += !bar.passed();
  return n;
}

TEST(Bars, OnTheBarIsEnough) {
  for (const Bar& bar : judge_bars(on_the_bars(), nullptr)) {
    EXPECT_EQ(bar.passed(), bar.figure.find("pose only") == std::string::npos) << bar.figure << " " << bar.value;
  }
  EXPECT_LE(failures(on_the_bars(), pose_only()), 1);  // 20 / (20 / 0.85) may round either way
}

TEST(Bars, EachCanFail) {
  const int none = failures(on_the_bars(), pose_only());
  const auto worse = [&](auto&& change) {
    EvalReport report = on_the_bars();
    change(report);
    return failures(report, pose_only()) - none;
  };
  EXPECT_EQ(worse([](EvalReport& r) { r.iou.mean = 0.949; }), 1);
  EXPECT_EQ(worse([](EvalReport& r) { r.iou.min = 0.879; }), 1);
  EXPECT_GE(worse([](EvalReport& r) { r.vertex_aligned_mm.mean = 20.1; }), 1);
  EXPECT_EQ(worse([](EvalReport& r) { r.loose_aligned_mm.mean = 70.1; }), 1);
  EXPECT_EQ(worse([](EvalReport& r) { r.joint_aligned_mm.mean = 35.1; }), 2);  // and against the network
  EXPECT_EQ(worse([](EvalReport& r) { r.network_joint_aligned_mm.mean = 39; }), 1);
  EXPECT_EQ(worse([](EvalReport& r) { r.n_lost = 1; }), 1);
  EXPECT_EQ(worse([](EvalReport& r) { r.n_legs_exchanged = 1; }), 1);
  EXPECT_EQ(worse([](EvalReport& r) { r.n_arms_exchanged = 1; }), 1);
  EXPECT_EQ(worse([](EvalReport& r) { r.n_limb_inside = 1; }), 1);
  EXPECT_EQ(worse([](EvalReport& r) { r.vertex_jitter.error = 2.61; }), 1);
  EXPECT_EQ(worse([](EvalReport& r) { r.joint_jitter.error = 1.31; }), 1);
}

TEST(Bars, NothingIsNotGood) {
  for (const Bar& bar : judge_bars(EvalReport(), nullptr)) {
    if (bar.figure == "frames lost") continue;  // of no frames, none
    EXPECT_FALSE(bar.known()) << bar.figure;
    EXPECT_FALSE(bar.passed()) << bar.figure;
  }
}

}  // namespace
}  // namespace livecap
