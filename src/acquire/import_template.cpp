#include "acquire/import_template.h"

#include <algorithm>
#include <cctype>
#include <limits>

#include "acquire/build_actor.h"
#include "acquire/material_labels.h"
#include "acquire/surface_color.h"
#include "acquire/vertex_labels.h"
#include "actor/height_range.h"
#include "actor/rest_axes.h"
#include "base/text.h"
#include "livecap/error.h"
#include "meshing/nearest_vertex.h"
#include "scan/mesh_volume.h"
#include "scan/scan.h"

namespace livecap::acquire {

namespace {

using Eigen::Vector3d;

constexpr double kOutsideShare = 0.1;  // of the mesh's extent that a joint may lie beside it

class Importer {
 public:
  Importer(const TemplateFiles& files, const std::string& name) : files_(files) { result_.actor.name = name; }

  ImportedTemplate run() {
    result_.skeleton = load_skeletool_skeleton(files_.skeleton);
    if (!result_.skeleton.scaled_joint.empty())
      throw IoError(
          files_.skeleton.string() + ": joint \"" + result_.skeleton.scaled_joint +
          "\" is scaled; a skin binds to bones without scales. Skeletool writes them into the offsets when it "
          "saves the skeleton and the mesh");
    result_.rig = find_rig(result_.skeleton, files_.skeleton, files_.bones);
    joints_ = rig_positions(result_.skeleton, result_.rig);
    const SkinWeights skin = load_skeletool_skin(files_.skin, result_.skeleton, result_.notes);
    scan_ = read_scan(files_.mesh, result_.notes, files_.texture);
    const size_t n_file = scan_.vertex_of_file.size();
    if (skin.bones.size() != kMaxInfluences * n_file)
      throw IoError(files_.skin.string() +
                    format(": has weights of %zu vertices, ", skin.bones.size() / kMaxInfluences) +
                    files_.mesh.string() + format(" has %zu", n_file));
    std::vector<uint8_t> labels;
    if (!files_.labels.empty()) labels = read_vertex_labels(files_.labels, n_file, files_.mesh);
    require_around_joints();
    take_vertices(skin, labels);
    take_corners();
    stand_up();
    add_bones();
    add_markers();
    if (labels.empty()) guess();
    return std::move(result_);
  }

 private:
  meshing::Surface& surface() { return result_.actor.surface; }
  void note(const std::string& text) { result_.notes.push_back(text); }

  // In another unit, in another pose or of somebody else the mesh is elsewhere.
  void require_around_joints() const {
    Vector3d low = scan_.surface.vertices[0], high = low;
    for (const Vector3d& p : scan_.surface.vertices) low = low.cwiseMin(p), high = high.cwiseMax(p);
    const double margin = kOutsideShare * (high - low).maxCoeff();
    for (int joint = 0; joint < kRigJointCount; ++joint) {
      if (result_.rig[joint] < 0) continue;
      const Vector3d& p = joints_[joint];
      if (((p - low).array() >= -margin).all() && ((high - p).array() >= -margin).all()) continue;
      throw IoError(
          files_.mesh.string() +
          format(": reaches from (%.4g, %.4g, %.4g) to (%.4g, %.4g, %.4g), and %s is at (%.0f, %.0f, %.0f) mm; it "
                 "must be the mesh of ",
                 low.x(), low.y(), low.z(), high.x(), high.y(), high.z(), std::string(kRigJointNames[joint]).c_str(),
                 p.x(), p.y(), p.z()) +
          files_.skeleton.string() + " at zero angles, in mm");
    }
  }

  // The mesh's vertices in its order, each once, without those of no triangle; weights and labels of the file's.
  void take_vertices(const SkinWeights& skin, const std::vector<uint8_t>& labels) {
    const size_t n_welded = scan_.surface.vertices.size();
    std::vector<char> used(n_welded, 0);
    for (const auto& t : scan_.surface.triangles)
      for (int k = 0; k < 3; ++k) used[t[k]] = 1;
    std::vector<int> id(n_welded, -1);
    for (size_t i = 0; i < scan_.vertex_of_file.size(); ++i) {
      const int welded = scan_.vertex_of_file[i];
      if (!used[welded] || id[welded] >= 0) continue;
      id[welded] = static_cast<int>(surface().vertices.size());
      surface().vertices.push_back(scan_.surface.vertices[welded]);
      if (!scan_.colors.empty()) result_.actor.colors.push_back(scan_.colors[welded]);
      if (!labels.empty()) result_.actor.labels.push_back(labels[i]);
      meshing::Influences influences;
      for (size_t k = 0; k < kMaxInfluences; ++k) {
        const size_t at = kMaxInfluences * i + k;
        influences[k] = {skin.bones[at], skin.weights[at]};
        result_.skin.bones.push_back(skin.bones[at]);
        result_.skin.weights.push_back(skin.weights[at]);
      }
      result_.actor.weights.push_back(influences);
    }
    const size_t n = surface().vertices.size(), n_file = scan_.vertex_of_file.size();
    if (n < kMinVertices || n > kMaxVertices)
      throw IoError(files_.mesh.string() +
                    format(": has %zu vertices, must have %d to %d", n, kMinVertices, kMaxVertices));
    if (n < n_file)
      note(files_.mesh.string() +
           format(": %zu of %zu vertices lie on others or have no triangle; the actor has %zu", n_file - n, n_file, n));
    for (const auto& t : scan_.surface.triangles) surface().triangles.emplace_back(id[t[0]], id[t[1]], id[t[2]]);
  }

  // Each vertex as often as it has texture coordinates, once without a texture.
  void take_corners() {
    std::vector<std::vector<std::pair<Eigen::Vector2d, int>>> copies(surface().vertices.size());
    std::vector<std::pair<int, int>> corner;  // vertex, and which of its copies
    for (size_t t = 0; t < surface().triangles.size(); ++t)
      for (int k = 0; k < 3; ++k) {
        const int vertex = surface().triangles[t][k];
        const Eigen::Vector2d uv = scan_.uvs.empty() ? Eigen::Vector2d(0, 0) : scan_.uvs[3 * t + k];
        auto& list = copies[vertex];
        const auto same = std::find_if(list.begin(), list.end(), [&](const auto& copy) { return copy.first == uv; });
        corner.emplace_back(vertex, static_cast<int>(same - list.begin()));
        if (same == list.end()) list.emplace_back(uv, 0);
      }
    meshing::Atlas& atlas = result_.actor.atlas;
    for (size_t vertex = 0; vertex < copies.size(); ++vertex)
      for (auto& [uv, index] : copies[vertex]) {
        index = static_cast<int>(atlas.vertex.size());
        atlas.vertex.push_back(static_cast<int>(vertex));
        atlas.uvs.push_back(uv);
      }
    const auto textured = [&](size_t i) { return copies[corner[i].first][corner[i].second].second; };
    for (size_t i = 0; i + 2 < corner.size(); i += 3)
      atlas.triangles.emplace_back(textured(i), textured(i + 1), textured(i + 2));
    result_.actor.texture = std::move(scan_.texture);
    if (!result_.actor.texture.empty()) return;
    note(files_.mesh.string() +
         (result_.actor.colors.empty()
              ? ": has neither texture nor colours; the actor is grey (--texture gives it one)"
              : ": has no texture; the colours of its vertices are taken (--texture gives it one)"));
  }

  // To the axes of the rest frame, with the soles at y = 0 and the pelvis above the origin.
  void stand_up() {
    const auto axes = rest_from_file_axes(joints_);
    if (!axes) throw IoError(files_.skeleton.string() + ": hips, shoulders and neck coincide");
    double bottom = std::numeric_limits<double>::max(), top = std::numeric_limits<double>::lowest();
    for (const Vector3d& p : surface().vertices) {
      bottom = std::min(bottom, (*axes * p).y());
      top = std::max(top, (*axes * p).y());
    }
    if (!kActorHeightMm.contains(top - bottom))
      throw IoError(files_.mesh.string() + format(": is %.4g tall; it and ", top - bottom) + files_.skeleton.string() +
                    " must be in mm");
    result_.rest_from_world.linear() = *axes;
    const Vector3d pelvis = *axes * joints_[kRigRoot];
    result_.rest_from_world.translation() = Vector3d(-pelvis.x(), -bottom, -pelvis.z());
    for (Vector3d& p : surface().vertices) p = result_.rest_from_world * p;
    for (Vector3d& p : joints_) p = result_.rest_from_world * p;
  }

  void add_bones() {
    const Skeleton& chain = result_.skeleton.skeleton;
    const PosedSkeleton rest = forward_kinematics(chain, rest_pose(chain));
    for (int b = 0; b < chain.n_bones(); ++b)
      result_.actor.bones.push_back({chain.bones[b].name, chain.bones[b].parent,
                                     result_.rest_from_world * rest.camera_from_bone[b].translation()});
    for (int joint = 0; joint < kRigJointCount; ++joint)
      if (result_.rig[joint] >= 0)
        result_.actor.rig.emplace_back(kRigJointNames[joint], chain.bones[result_.rig[joint]].name);
  }

  // Those of the skeleton's markers that are called as one of the face's.
  void add_markers() {
    constexpr std::pair<const char*, const char*> kNames[] = {
        {"lefteye", "left_eye"}, {"righteye", "right_eye"}, {"nose", "nose"}, {"chin", "chin"}, {"mouth", "chin"}};
    for (const auto& [called, keypoint] : kNames) {
      const auto of_keypoint = [&](const auto& marker) { return marker.first == keypoint; };
      for (const SkeletoolMarker& marker : result_.skeleton.markers) {
        std::string plain;
        for (char c : marker.name)
          if (std::isalnum(static_cast<unsigned char>(c)))
            plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
        auto& markers = result_.actor.markers;
        if (plain != called || std::any_of(markers.begin(), markers.end(), of_keypoint)) continue;
        markers.emplace_back(keypoint,
                             meshing::nearest_vertex(surface(), result_.rest_from_world * marker.rest_position_mm));
      }
    }
  }

  void guess() {
    double top = 0;
    for (const Vector3d& p : surface().vertices) top = std::max(top, p.y());
    const std::vector<BodyBone> bones = body_bones(result_.skeleton, result_.rig);
    std::vector<meshing::Influences> weights = result_.actor.weights;
    for (auto& influences : weights) influences = body_influences(influences, bones);
    std::vector<Vector3d> colors = result_.actor.colors;
    if (!result_.actor.texture.empty()) colors = vertex_colors(surface(), result_.actor.atlas, result_.actor.texture);
    if (colors.empty()) colors.assign(surface().vertices.size(), Vector3d::Constant(0.5));
    result_.actor.labels = guess_labels({surface(),
                                         weights,
                                         body_joints(joints_, result_.rig, top),
                                         volume_of(surface(), BuildOptions().grid_mm),
                                         colors,
                                         result_.actor.marker_vertex("nose"),
                                         {}});
    note("no --labels: materials are guessed from body parts and colours");
  }

  const TemplateFiles& files_;
  Scan scan_;
  RigPositions joints_;  // the skeleton's axes, from stand_up() on the rest frame
  ImportedTemplate result_;
};

}  // namespace

ImportedTemplate import_template(const TemplateFiles& files, const std::string& name) {
  return Importer(files, name).run();
}

}  // namespace livecap::acquire
