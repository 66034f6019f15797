// What the second stage is for: the deforming surface is nearer to the truth than the skinned pose.
#include <gtest/gtest.h>

#include "capture/capture_run.h"
#include "eval/evaluate.h"
#include "nn/models.h"

namespace livecap {
namespace {

TEST(Components, TheSurfaceStageBeatsThePoseAlone) {
  LIVECAP_MODEL_OR_SKIP(model, "full");
  const test::ScratchFolder scratch;
  SynthOptions synth;
  synth.n_frames = 50;
  write_sequence(synth, scratch / "sequence");
  EvalReport evaluated[2];
  for (const bool surface : {false, true}) {
    const auto out = scratch / (surface ? "full" : "pose");
    CaptureOptions options = test::capture_of(scratch / "sequence", out, model);
    options.surface = surface;
    run_capture(options);
    EvalReport& report = evaluated[surface];
    report = evaluate({out, scratch / "sequence/truth", "", "", {}});
    EXPECT_EQ(report.n_person, 40);
    EXPECT_EQ(report.n_lost, 0);
    RecordProperty(surface ? "vertex_mm_full" : "vertex_mm_pose", format("%.2f", report.vertex_mm.mean));
    RecordProperty(surface ? "iou_full" : "iou_pose", format("%.4f", report.iou.mean));
  }
  EXPECT_LT(evaluated[1].vertex_mm.mean, evaluated[0].vertex_mm.mean);
  EXPECT_LT(evaluated[1].vertex_aligned_mm.mean, evaluated[0].vertex_aligned_mm.mean);
  EXPECT_GT(evaluated[1].iou.mean, evaluated[0].iou.mean);
}

}  // namespace
}  // namespace livecap
