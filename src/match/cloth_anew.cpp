#include "match/cloth_anew.h"

#include "livecap/error.h"
#include "match/layout.h"
#include "match/texture_matcher.h"

namespace livecap {
namespace {

constexpr size_t kGroup = 64;  // of GPUs

}  // namespace

ClothAnew::ClothAnew(ocl::DeviceContext& device, int n_vertices, float share)
    : n_vertices_(n_vertices),
      share_(share),
      group_(device.is_cpu() ? 1 : kGroup),
      anew_(device, size_t(LC_MATCH) * n_vertices),
      match_anew_(device, kClothMatchProgram, "match_anew") {}

void ClothAnew::keep(const ocl::Buffer<float>& matches) {
  if (matches.size() != anew_.size()) throw LogicError("cloth anew: matches of another mesh");
  anew_.copy_from(matches);
}

void ClothAnew::choose(ocl::Buffer<float>& matches) {
  if (matches.size() != anew_.size()) throw LogicError("cloth anew: matches of another mesh");
  match_anew_.launch(group_, group_, n_vertices_, share_, anew_, matches, ocl::LocalMemory{group_ * 2 * sizeof(float)});
}

}  // namespace livecap
