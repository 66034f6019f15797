#include "eval/vertex_judge.h"

#include <utility>

#include "base/append.h"
#include "eval/metrics.h"
#include "eval/other_mesh.h"

namespace livecap {
VertexJudge::VertexJudge(const Actor& captured, const TrueMesh& true_mesh, double fps)
    : captured_(captured), true_mesh_(true_mesh), jitter_(fps), jitter_centred_(fps, true) {
  if (true_mesh.is_other()) true_on_captured_ = true_vertices_on(captured, *true_mesh.actor(), true_mesh.overlay());
}

void VertexJudge::add(const std::vector<float>& captured, const std::vector<float>& truth, FrameEval& frame) {
  const std::vector<float> paired = true_mesh_.of_captured(truth);
  jitter_.add(captured, paired);
  jitter_centred_.add(captured, paired);
  if (!captured.empty() && !truth.empty()) judge(captured, paired, truth, frame);
}

void VertexJudge::judge(const std::vector<float>& captured, const std::vector<float>& paired,
                        const std::vector<float>& truth, FrameEval& frame) {
  if (true_mesh_.is_other())
    append(at_true_vertices_,
           translation_aligned_distances(resample(true_on_captured_, captured_.mesh.triangles, captured), truth));
  if (true_mesh_.actor())
    append(surface_, surface_distances(captured, paired, truth, true_mesh_.actor()->mesh.triangles));

  const std::vector<double> direct = point_distances(captured, paired);
  const std::vector<double> aligned = translation_aligned_distances(captured, paired);
  frame.vertex_mm = mean_of(direct);
  frame.vertex_aligned_mm = mean_of(aligned);
  std::vector<double> loose;
  for (size_t i = 0; i < aligned.size(); ++i)
    if (is_loose(static_cast<int>(i))) loose.push_back(aligned[i]);
  frame.loose_aligned_mm = mean_of(std::move(loose));
  errors_.add(direct, aligned);
}

void VertexJudge::skip() {
  jitter_.add({}, {});
  jitter_centred_.add({}, {});
}

void VertexJudge::finish(EvalReport& report) {
  report.other_mesh = true_mesh_.is_other();
  report.surface_mm = summarize(std::move(surface_));
  report.vertex_jitter = jitter_.result();
  report.vertex_jitter_centred = jitter_centred_.result();
  if (errors_.n_frames() == 0) return;
  const auto loose = [this](int vertex) { return is_loose(vertex); };
  report.vertex_mm = errors_.direct();
  report.vertex_aligned_mm = errors_.aligned();
  report.true_vertex_aligned_mm =
      report.other_mesh ? summarize(std::move(at_true_vertices_)) : report.vertex_aligned_mm;
  report.loose_mm = errors_.direct(loose);
  report.loose_aligned_mm = errors_.aligned(loose);
  report.labels = errors_by_label(errors_, captured_.labels);
  report.vertex_mean_mm = errors_.mean_aligned();
}

}  // namespace livecap
