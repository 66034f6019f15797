// The mesh that the true vertices are of: the captured one, or another (eval/other_mesh.h).
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "actor/actor.h"
#include "eval/other_mesh.h"

namespace livecap {

class TrueMesh {
 public:
  // truth: the folder; named: an actor file or builtin:NAME; empty: the actor.glb beside the folder, if it has as many
  // vertices as the truth. captured must outlive this. Throws IoError when the named one has another number.
  TrueMesh(const std::filesystem::path& truth, const std::string& named, const Actor& captured);

  bool is_other() const { return is_other_; }
  const std::optional<Actor>& actor() const { return actor_; }  // nothing when nobody tells
  const RestOverlay& overlay() const { return overlay_; }       // of another mesh

  // How many vertices the truth has to have; 0: the actor tells.
  int n_vertices() const { return is_other_ ? 0 : captured_.n_vertices(); }

  // Where the captured mesh's vertices truly are, given the true ones [3*n]; empty for none.
  std::vector<float> of_captured(const std::vector<float>& true_vertices) const;

 private:
  const Actor& captured_;
  std::optional<Actor> actor_;
  bool is_other_ = false;
  RestOverlay overlay_;
};

}  // namespace livecap
