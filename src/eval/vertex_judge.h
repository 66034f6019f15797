// The vertex side of evaluate(): fed the judged frames in the order of the video, it fills the vertex fields of the
// report.
#pragma once

#include <vector>

#include "actor/actor.h"
#include "eval/evaluate.h"
#include "eval/motion_metrics.h"
#include "eval/true_mesh.h"
#include "eval/vertex_errors.h"

namespace livecap {

class VertexJudge {
 public:
  // captured and true_mesh must outlive this. fps: of the video.
  VertexJudge(const Actor& captured, const TrueMesh& true_mesh, double fps);

  // A frame with a person. captured: [3*n_vertices]; truth: [3*n] of the true mesh; mm, camera frame; empty: not known.
  void add(const std::vector<float>& captured, const std::vector<float>& truth, FrameEval& frame);
  // A frame without one.
  void skip();
  void finish(EvalReport& report);

 private:
  void judge(const std::vector<float>& captured, const std::vector<float>& paired, const std::vector<float>& truth,
             FrameEval& frame);
  bool is_loose(int vertex) const { return is_loose_garment(captured_.labels[vertex]); }

  const Actor& captured_;
  const TrueMesh& true_mesh_;
  std::vector<meshing::SurfacePoint> true_on_captured_;  // of another mesh
  VertexErrors errors_;
  std::vector<double> surface_;           // distances to it, mm
  std::vector<double> at_true_vertices_;  // of another mesh, mm
  JitterMeter jitter_, jitter_centred_;
};

}  // namespace livecap
