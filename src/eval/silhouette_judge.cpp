#include "eval/silhouette_judge.h"

#include <utility>

#include "eval/mask_raster.h"
#include "eval/truth_folder.h"
#include "image/mask_iou.h"
#include "livecap/error.h"

namespace livecap {

SilhouetteJudge::SilhouetteJudge(const CaptureFolder& capture, const std::vector<ExtraView>& views)
    : capture_(capture), views_(views), of_views_(views.size()) {}

double SilhouetteJudge::iou(const std::vector<float>& vertices_mm, const Camera& camera, const ImageGray& mask) const {
  if (vertices_mm.empty()) return 0;
  return mask_iou(render_silhouette(vertices_mm, capture_.actor.mesh.triangles, camera), mask);
}

void SilhouetteJudge::add(const std::vector<float>& captured, const ImageGray& mask, FrameEval& frame) {
  if (!capture_.vertices) return;
  if (!mask.empty()) {
    frame.iou = iou(captured, capture_.camera, mask);
    ious_.push_back(frame.iou);
  }
  for (size_t v = 0; v < views_.size(); ++v) {
    const ImageGray of_view = read_mask(views_[v].masks, frame.index, views_[v].camera);
    if (!of_view.empty()) of_views_[v].push_back(iou(to_view(views_[v], captured), views_[v].camera, of_view));
  }
}

void SilhouetteJudge::finish(EvalReport& report) {
  report.iou = summarize(std::move(ious_));
  for (size_t v = 0; v < views_.size(); ++v) {
    if (of_views_[v].empty())
      throw IoError(views_[v].masks.string() + ": holds no mask of a captured frame, expected 000000.png ...");
    report.views.push_back({views_[v].name, summarize(std::move(of_views_[v]))});
  }
}

}  // namespace livecap
