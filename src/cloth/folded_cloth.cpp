#include "cloth/folded_cloth.h"

#include <vector>

#include "base/round_up.h"
#include "cloth/cloth_graph.h"
#include "ocl/lanes.h"

namespace livecap {
namespace {

constexpr size_t kGroup = 64;  // on a GPU

std::vector<float> sides(const Actor& actor) {
  const std::vector<char> outer = outer_cloth(actor);
  std::vector<float> side(actor.n_vertices(), 1);
  for (int i = 0; i < actor.n_vertices(); ++i)
    if (hangs(actor, i) && !outer[i]) side[i] = -1;
  return side;
}

}  // namespace

FoldedCloth::FoldedCloth(ocl::DeviceContext& device, const Actor& actor, const SkinWeights& hung_weights, float opening)
    : opening_(opening),
      lanes_(device.lanes()),
      n_(actor.n_vertices()),
      hung_skinner_(device, actor, hung_weights, actor.skeleton.n_bones() + 1),
      zero_(device, size_t(3) * n_),
      hung_(device, size_t(3) * n_),
      side_(device, sides(actor)),
      open_(device, "cloth/cloth.cl", "open_folds") {
  zero_.fill(0);
}

void FoldedCloth::open(std::span<const float> dual_quats, const ocl::Buffer<float>& normals,
                       ocl::Buffer<float>& carried, ocl::Buffer<float>& start, ocl::Buffer<float>& start_before) {
  hung_skinner_.set_pose(dual_quats);
  hung_skinner_.skin(zero_, hung_);
  const size_t local = lanes_ > 1 ? 1 : kGroup;
  const size_t items = round_up(ocl::lane_items(n_, lanes_), local);
  open_.launch(ocl::Range{items, 1, local, 1}, n_, opening_, hung_, normals, side_, carried, start, start_before);
}

}  // namespace livecap
