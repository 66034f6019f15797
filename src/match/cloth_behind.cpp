#include "match/cloth_behind.h"

#include "base/round_up.h"
#include "livecap/error.h"
#include "match/layout.h"
#include "match/texture_matcher.h"

namespace livecap {
namespace {

constexpr size_t kLocal = 64;

}  // namespace

ClothBehind::ClothBehind(ocl::DeviceContext& device, const Camera& camera, float share)
    : camera_(pinhole_arg(camera)), share_(share), match_behind_(device, kClothMatchProgram, "match_behind") {}

void ClothBehind::match(const DepthRasterizer& raster, const ocl::Buffer<float>& start, const ocl::Buffer<float>& hangs,
                        const ocl::Buffer<int32_t>& visible, ocl::Buffer<float>& matches) {
  const size_t n = raster.n_vertices();
  if (start.size() != 3 * n || hangs.size() != n || visible.size() != n || matches.size() != LC_MATCH * n)
    throw LogicError("cloth behind: a buffer is not of the rasterised mesh");
  match_behind_.launch(round_up(n, kLocal), kLocal, int(n), raster.width(), raster.height(), share_, camera_, hangs,
                       visible, raster.triangle_ids(), raster.triangles(), raster.projected(), start, matches);
}

}  // namespace livecap
