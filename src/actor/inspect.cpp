#include "actor/inspect.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "actor/labels.h"
#include "base/text.h"

namespace livecap {

std::string inspect_actor(const Actor& actor) {
  constexpr double kDegPerRad = 180 / std::numbers::pi;
  std::string text;
  auto line = [&](const std::string& s) { text += s + "\n"; };

  float low[3], high[3];
  std::fill_n(low, 3, std::numeric_limits<float>::infinity());
  std::fill_n(high, 3, -std::numeric_limits<float>::infinity());
  for (size_t i = 0; i < actor.mesh.positions.size(); ++i) {
    low[i % 3] = std::min(low[i % 3], actor.mesh.positions[i]);
    high[i % 3] = std::max(high[i % 3], actor.mesh.positions[i]);
  }
  line("actor       " + actor.name);
  line(format("template    %d vertices, %d triangles, %d connected component(s)", actor.n_vertices(),
              actor.mesh.n_triangles(), connected_components(actor.n_vertices(), actor.mesh.triangles)));
  line(format("drawn as    %zu vertices (UV seams repeated)", actor.render.template_vertex.size()));
  if (actor.guessed_weights) line("weights     guessed");
  if (actor.rough_shape) line("shape       rough");
  line(format("size        %.0f x %.0f x %.0f mm (left-right, height, depth), feet at y = %.0f", high[0] - low[0],
              high[1] - low[1], high[2] - low[2], low[1]));
  line(actor.texture.empty() ? std::string("texture     none")
                             : format("texture     %d x %d", actor.texture.width, actor.texture.height));

  line(format("\nbones (%d)                 parent            vertices  position mm", actor.skeleton.n_bones()));
  std::vector<int> followers(actor.skeleton.n_bones(), 0);
  for (int v = 0; v < actor.n_vertices(); ++v) ++followers[actor.skin.bones[4 * v]];
  const PosedSkeleton rest = forward_kinematics(actor.skeleton, rest_pose(actor.skeleton));
  for (int b = 0; b < actor.skeleton.n_bones(); ++b) {
    const Bone& bone = actor.skeleton.bones[b];
    const Eigen::Vector3d p = rest.camera_from_bone[b].translation();
    line(format("  %-22s %-18s %7d  %7.0f %7.0f %7.0f", bone.name.c_str(),
                bone.parent < 0 ? "-" : actor.skeleton.bones[bone.parent].name.c_str(), followers[b], p.x(), p.y(),
                p.z()));
  }
  line(format("\njoint angles (%d), degrees   rest      min      max", actor.skeleton.n_dofs()));
  for (const Dof& dof : actor.skeleton.dofs)
    line(format("  %-22s %8.1f %8.1f %8.1f", dof.name.c_str(), dof.rest_rad * kDegPerRad, dof.min_rad * kDegPerRad,
                dof.max_rad * kDegPerRad));

  line("\nmaterial            vertices  rigidity");
  for (int label = 0; label < kLabelCount; ++label) {
    const auto n = std::count(actor.labels.begin(), actor.labels.end(), label);
    if (n > 0)
      line(format("  %-18s %7ld  %8.1f", std::string(kLabelNames[label]).c_str(), static_cast<long>(n),
                  rigidity_of_label(label)));
  }
  line("\nkeypoint            bone               position mm");
  for (int k = 0; k < kKeypointCount; ++k) {
    const KeypointAnchor& anchor = actor.keypoints[k];
    const std::string name(kKeypointNames[k]);
    if (anchor.bone < 0) {
      line(format("  %-18s none", name.c_str()));
    } else {
      line(format("  %-18s %-16s %7.0f %7.0f %7.0f", name.c_str(), actor.skeleton.bones[anchor.bone].name.c_str(),
                  anchor.rest_position_mm.x(), anchor.rest_position_mm.y(), anchor.rest_position_mm.z()));
    }
  }
  line("\nnotes");
  for (const std::string& note : actor.notes) line("  " + note);
  if (actor.notes.empty()) line("  none");
  return text;
}

}  // namespace livecap
