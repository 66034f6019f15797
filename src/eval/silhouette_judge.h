// The silhouette side of evaluate(): how well the captured surface covers the person of the masks, in the capturing
// camera's pictures and in further ones.
#pragma once

#include <vector>

#include "base/image_rgb.h"
#include "eval/capture_folder.h"
#include "eval/evaluate.h"
#include "eval/extra_view.h"

namespace livecap {

class SilhouetteJudge {
 public:
  // Both must outlive this.
  SilhouetteJudge(const CaptureFolder& capture, const std::vector<ExtraView>& views);

  // A frame with a person. captured: [3*n_vertices] mm, camera frame; empty: no result. mask: of the capturing camera;
  // empty: not known. Throws IoError when a view's mask is not of its camera's size.
  void add(const std::vector<float>& captured, const ImageGray& mask, FrameEval& frame);
  // Throws IoError for a view without any mask.
  void finish(EvalReport& report);

 private:
  double iou(const std::vector<float>& vertices_mm, const Camera& camera, const ImageGray& mask) const;

  const CaptureFolder& capture_;
  const std::vector<ExtraView>& views_;
  std::vector<double> ious_;
  std::vector<std::vector<double>> of_views_;  // [n_views]
};

}  // namespace livecap
