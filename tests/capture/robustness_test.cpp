// Difficult videos with known truth (docs/accuracy.md, "Robustness"): each has a criterion, most of them relative to
// the same sequence without the difficulty. What was measured stands there and in the properties each test records.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <memory>

#include "capture/capture_run.h"
#include "eval/evaluate.h"
#include "export/pc2.h"
#include "livecap/camera.h"
#include "nn/models.h"

namespace livecap {
namespace {

struct Captured {
  EvalReport eval;
  std::vector<test::CsvRow> rows;
  int n_without_detection = 0;
  const FrameEval& frame(int64_t index) const {
    return *std::find_if(eval.frames.begin(), eval.frames.end(), [&](const auto& f) { return f.index == index; });
  }
};

SynthOptions sequence_of(const std::string& scenario, const std::string& motion, int n_frames) {
  SynthOptions options = test::small_sequence(n_frames, 0);
  options.scenario = scenario;
  options.motions = {motion};
  return options;
}

// Sequences and what was captured of them, made once and kept for the tests that compare.
class Runs {
 public:
  const Captured& of(const SynthOptions& synth, double missed_detections = 0) {
    const std::string name = format("%s_%g", folder(synth).filename().c_str(), missed_detections);
    const auto found = runs_.find(name);
    if (found != runs_.end()) return found->second;
    const auto sequence = folder(synth), out = scratch_ / ("capture_" + name);
    if (!std::filesystem::exists(sequence)) write_sequence(synth, sequence);
    CaptureOptions options = test::capture_of(sequence, out, test::model_path("full"));
    options.missed_detections = missed_detections;
    options.learn_frames = CaptureOptions().learn_frames;
    run_capture(options);
    Captured run{evaluate({out, sequence / "truth", "", ""}), test::frame_rows(out)};
    std::ifstream detections(out / "detections.jsonl");
    for (std::string line; std::getline(detections, line);)
      run.n_without_detection += line.find("\"person\":false") != std::string::npos;
    // Whatever happens in the picture, every frame has its row.
    test::expect_every_frame_once(run.rows, Pc2Reader(sequence / "truth" / "vertices.pc2").n_samples());
    return runs_.emplace(name, std::move(run)).first->second;
  }

  std::filesystem::path folder(const SynthOptions& synth) const {
    return scratch_ / format("%s_%s_%s_%d_%d", synth.scenario.c_str(), synth.actor.c_str(), synth.motions[0].c_str(),
                             synth.width, synth.n_frames);
  }

 private:
  ScratchFolder scratch_;
  std::map<std::string, Captured> runs_;
};

class Robustness : public testing::Test {
 protected:
  static void TearDownTestSuite() { runs_.reset(); }
  Runs& runs() {
    if (!runs_) runs_ = std::make_unique<Runs>();
    return *runs_;
  }

  // Tracked without a break: found once, never lost, invented or found again.
  static void expect_unbroken(const Captured& run) {
    EXPECT_EQ(run.rows.front().status, "initialized");
    for (size_t i = 1; i < run.rows.size(); ++i) EXPECT_EQ(run.rows[i].status, "ok") << i;
  }

  static void record(const std::string& name, const Captured& run) {
    RecordProperty(name, format("IoU %.3f / %.3f, vertices %.1f mm, aligned %.1f mm", run.eval.iou.mean,
                                worst(run.eval, &FrameEval::iou, false), run.eval.vertex_mm.mean,
                                run.eval.vertex_aligned_mm.mean));
  }

  static double worst(const EvalReport& eval, double FrameEval::*value, bool largest) {
    double result = eval.frames.front().*value;
    for (const FrameEval& frame : eval.frames)
      result = largest ? std::max(result, frame.*value) : std::min(result, frame.*value);
    return result;
  }

  static std::unique_ptr<Runs> runs_;
};

std::unique_ptr<Runs> Robustness::runs_;

// Share of the true vertices that are inside the picture; 0 when nobody is there.
std::vector<double> shares_inside(const std::filesystem::path& sequence) {
  Pc2Reader truth(sequence / "truth" / "vertices.pc2");
  const Camera camera = load_camera(sequence / "camera.json");
  std::vector<float> xyz(3 * static_cast<size_t>(truth.n_points()));
  std::vector<double> shares;
  for (int i = 0; i < truth.n_samples(); ++i) {
    truth.read(i, xyz);
    int inside = 0;
    for (size_t k = 0; k + 2 < xyz.size(); k += 3) {
      const double x = camera.fx * xyz[k] / -xyz[k + 2] + camera.cx,
                   y = camera.fy * -xyz[k + 1] / -xyz[k + 2] + camera.cy;
      inside += x > -0.5 && y > -0.5 && x < camera.width - 0.5 && y < camera.height - 0.5;
    }
    shares.push_back(static_cast<double>(inside) / truth.n_points());
  }
  return shares;
}

// Nothing is tracked while nobody is there; five frames after half of the person is back, the person is tracked again,
// without a break, and as well as before.
TEST_F(Robustness, APersonLeavesAndReturns) {
  LIVECAP_MODEL_OR_SKIP(model, "full");
  const SynthOptions synth = sequence_of("leave", "walk", 108);
  const Captured& run = runs().of(synth);
  record("leave", run);
  const std::vector<double> inside = shares_inside(runs().folder(synth));
  EXPECT_EQ(run.eval.n_invented, 0);
  const auto gone = std::find(inside.begin(), inside.end(), 0.0);
  const auto back = std::find_if(gone, inside.end(), [](double share) { return share >= 0.5; });
  ASSERT_NE(back, inside.end());
  const auto first_after =
      std::find_if(run.rows.begin() + (gone - inside.begin()), run.rows.end(),
                   [](const auto& row) { return row.status == "initialized" || row.status == "ok"; });
  ASSERT_NE(first_after, run.rows.end());
  EXPECT_LE(first_after->index, back - inside.begin() + 5);  // after 3
  for (auto row = first_after; row != run.rows.end(); ++row)
    EXPECT_EQ(row->status, row == first_after ? "initialized" : "ok") << row->index;
  for (int i = 0; inside[i] > 0.5; ++i) EXPECT_TRUE(run.rows[i].status == "ok" || i == 0) << i;
  // The last fifteen frames against the first fifteen, in which the skirt swings less: 0.930 to 0.935 and 0.965 to
  // 0.966 of six programs that differ in one number each (PoCL 3.1, 2026-11-22).
  double before = 0, after = 0;
  for (int i = 0; i < 15; ++i) {
    before += run.frame(i).iou / 15;
    after += run.frame(synth.n_frames - 1 - i).iou / 15;
  }
  RecordProperty("iou_before", format("%.4f", before));
  RecordProperty("iou_after", format("%.4f", after));
  RecordProperty("frames_until_found", format("%d", static_cast<int>(first_after->index - (back - inside.begin()))));
  EXPECT_GT(after, before - 0.045);
}

// A passer-by behind the person: the track stays, nothing of the mesh goes to the other one.
TEST_F(Robustness, TwoPeople) {
  LIVECAP_MODEL_OR_SKIP(model, "full");
  const Captured& alone = runs().of(sequence_of("none", "walk", 60));
  const Captured& run = runs().of(sequence_of("two-people", "walk", 60));
  record("alone", alone);
  record("two_people", run);
  expect_unbroken(run);
  // 0.020 below and 0.87; with strangers left in the silhouette 0.042 and 0.77 (PoCL 3.1, 2026-11-25).
  EXPECT_GT(run.eval.iou.mean, alone.eval.iou.mean - 0.033);
  EXPECT_GT(worst(run.eval, &FrameEval::iou, false), 0.80);
  // Six captures of each whose focal lengths differ by 0.002 %: 31.6 to 39.6 mm, 28.8 to 30.6 alone (PoCL 3.1,
  // 2026-11-25); 37.3 and 30.2 on an H100. In some the left arm is wrong from when he is behind it to the end.
  EXPECT_LT(run.eval.vertex_aligned_mm.mean, 1.45 * alone.eval.vertex_aligned_mm.mean);
  // The other one is never nearer than 700 mm.
  EXPECT_LT(worst(run.eval, &FrameEval::vertex_mm, true), 250);
}

TEST_F(Robustness, ALimbLeavesThePicture) {
  LIVECAP_MODEL_OR_SKIP(model, "full");
  SynthOptions synth = sequence_of("none", "jacks", 60);
  const Captured& whole = runs().of(synth);
  synth.width = 160;
  const Captured& run = runs().of(synth);
  record("whole", whole);
  record("limb_out", run);
  expect_unbroken(run);
  EXPECT_GT(run.eval.iou.mean, whole.eval.iou.mean - 0.015);
  EXPECT_GT(worst(run.eval, &FrameEval::iou, false), 0.75);
  // Nine captures of each whose focal lengths differ by 0.002 %: 27.9 to 28.6 mm, 21.1 to 21.9 with room for the arms
  // (PoCL 5.0, 2026-11-25); 28.4 to 29.2 and 21.2 to 21.6 on an H100.
  EXPECT_LT(run.eval.vertex_aligned_mm.mean, 1.45 * whole.eval.vertex_aligned_mm.mean);
}

TEST_F(Robustness, AMovingShadow) {
  LIVECAP_MODEL_OR_SKIP(model, "full");
  const Captured& plain = runs().of(sequence_of("none", "walk", 60));
  const Captured& run = runs().of(sequence_of("moving-shadow", "walk", 60));
  record("plain", plain);
  record("shadow", run);
  expect_unbroken(run);
  EXPECT_GT(run.eval.iou.mean, plain.eval.iou.mean - 0.03);
  EXPECT_GT(worst(run.eval, &FrameEval::iou, false), 0.88);
  // Six captures of each that differ by up to 0.2 % of lambda_silhouette: 0.99 to 1.11 times, 1.065 in the mean (PoCL
  // 3.1, 2026-11-23); 1.15 on an H200; 1.19 with PoCL 3.1, 2026-11-29.
  EXPECT_LT(run.eval.vertex_aligned_mm.mean, 1.3 * plain.eval.vertex_aligned_mm.mean);
}

TEST_F(Robustness, ABackgroundInTheColoursOfTheClothes) {
  LIVECAP_MODEL_OR_SKIP(model, "full");
  // The skirt's contour strays to an arm beside it: against another background its colours hold it back.
  for (const auto& [actor, iou_lost] : {std::pair{"trousers", 0.01}, {"skirt", 0.045}}) {
    SynthOptions synth = sequence_of("none", "walk", 60);
    synth.actor = actor;
    const Captured& plain = runs().of(synth);
    synth.scenario = "similar-background";
    const Captured& run = runs().of(synth);
    record(std::string("plain_") + actor, plain);
    record(std::string("similar_") + actor, run);
    expect_unbroken(run);
    EXPECT_GT(run.eval.iou.mean, plain.eval.iou.mean - iou_lost) << actor;
    EXPECT_GT(worst(run.eval, &FrameEval::iou, false), 0.80) << actor;
    EXPECT_LT(run.eval.vertex_aligned_mm.mean, 1.15 * plain.eval.vertex_aligned_mm.mean) << actor;
  }
}

// One detection in five is missing: the person is tracked on in these frames too, by the silhouette.
TEST_F(Robustness, DetectionsMissingAtRandom) {
  LIVECAP_MODEL_OR_SKIP(model, "full");
  const SynthOptions synth = sequence_of("none", "jacks", 60);
  const Captured& all = runs().of(synth);
  const Captured& run = runs().of(synth, 0.2);
  record("all", all);
  record("missing", run);
  EXPECT_EQ(all.n_without_detection, 0);
  EXPECT_GT(run.n_without_detection, 6);
  EXPECT_LT(run.n_without_detection, 18);
  expect_unbroken(run);
  EXPECT_GT(run.eval.iou.mean, all.eval.iou.mean - 0.01);
  EXPECT_GT(worst(run.eval, &FrameEval::iou, false), 0.90);
  // 1.09 and 1.25 times with two roundings of the network: one arm's depth in a few frames decides.
  EXPECT_LT(run.eval.vertex_aligned_mm.mean, 1.4 * all.eval.vertex_aligned_mm.mean);
}

// Three frames are missing in each second. The frames after that are tracked on, and as well.
TEST_F(Robustness, AGapOfATenthOfASecond) {
  LIVECAP_MODEL_OR_SKIP(model, "full");
  const Captured& all = runs().of(sequence_of("none", "jacks", 60));
  const Captured& run = runs().of(sequence_of("gap", "jacks", 60));
  record("all", all);
  record("gap", run);
  expect_unbroken(run);
  EXPECT_GT(run.eval.iou.mean, all.eval.iou.mean - 0.01);
  EXPECT_LT(run.eval.vertex_aligned_mm.mean, 1.08 * all.eval.vertex_aligned_mm.mean);
  // The five frames after each gap, before which three and six frames are missing.
  for (const auto& [first, missing] : {std::pair{21, 3}, {48, 6}}) {
    for (int row = first; row < first + 5; ++row) {
      EXPECT_GT(run.frame(row).iou, all.frame(row + missing).iou - 0.04) << row;
      EXPECT_LT(run.frame(row).vertex_aligned_mm, all.frame(row + missing).vertex_aligned_mm + 12) << row;
    }
  }
}

}  // namespace
}  // namespace livecap
