#include "eval/true_mesh.h"

#include "base/text.h"
#include "eval/capture_folder.h"
#include "export/pc2.h"
#include "livecap/error.h"

namespace livecap {
namespace {

namespace fs = std::filesystem;

std::optional<Actor> true_actor(const fs::path& truth, const std::string& named) {
  std::error_code ignored;
  const fs::path points = truth / "vertices.pc2";
  if (!fs::exists(points, ignored)) return {};
  const fs::path beside = fs::weakly_canonical(truth / "..") / "actor.glb";
  if (named.empty() && !fs::exists(beside, ignored)) return {};
  const std::string name = named.empty() ? beside.string() : named;
  Actor actor = load_actor_named(name, 0);
  if (const int n = Pc2Reader(points).n_points(); actor.n_vertices() != n) {
    if (named.empty()) return {};
    throw IoError(name + format(": has %d vertices, %s has %d; the actor the truth was made with is needed "
                                "(--truth-actor)",
                                actor.n_vertices(), points.string().c_str(), n));
  }
  return actor;
}

}  // namespace

TrueMesh::TrueMesh(const fs::path& truth, const std::string& named, const Actor& captured)
    : captured_(captured), actor_(true_actor(truth, named)), is_other_(actor_ && !same_mesh(captured, *actor_)) {
  if (is_other_) overlay_ = overlay_rest(captured, *actor_);
}

std::vector<float> TrueMesh::of_captured(const std::vector<float>& true_vertices) const {
  if (!is_other_ || true_vertices.empty()) return true_vertices;
  return resample(overlay_.nearest, actor_->mesh.triangles, true_vertices);
}

}  // namespace livecap
