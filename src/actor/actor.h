// The actor model: a skinned, textured, labelled template mesh with a LiveCap-32 skeleton (paper, "Actor Model
// Acquisition").
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "base/detections.h"
#include "base/image_rgb.h"
#include "geometry/mesh.h"
#include "geometry/skeleton.h"

namespace livecap {

inline constexpr int kMaxInfluences = 4;
inline constexpr int kMinVertices = 200;
inline constexpr int kMaxVertices = 50000;

// At most four bones per vertex, strongest first, weights sum to one, unused slots have weight 0 and bone 0.
struct SkinWeights {
  std::vector<int32_t> bones;  // [4*n_vertices]
  std::vector<float> weights;  // [4*n_vertices]
};

// A point fixed to a bone that a network may observe.
struct KeypointAnchor {
  int bone = -1;                                               // -1: this actor has no such point
  Eigen::Vector3d rest_position_mm = Eigen::Vector3d::Zero();  // template rest frame
};

// The mesh as the file drew it: glTF repeats vertices along UV seams.
struct RenderMesh {
  std::vector<int32_t> template_vertex;  // [n_render_vertices] welded vertex of each
  std::vector<float> uvs;                // [2*n_render_vertices] glTF convention: v down
  std::vector<int32_t> triangles;        // [3*n_triangles] render-vertex indices
};

struct Actor {
  std::string name;
  Mesh mesh;  // welded template, rest frame (see geometry/skeleton.h), mm
  Skeleton skeleton;
  SkinWeights skin;
  bool guessed_weights = false;  // of `skin`: nobody painted them (`actor build`)
  bool rough_shape = false;      // sizes are some mm off (`actor build --video`: a turn's masks lose soles)
  std::array<KeypointAnchor, kKeypointCount> keypoints;
  std::vector<float> colors;    // [3*n_vertices] sRGB in [0,1]: C_i
  std::vector<uint8_t> labels;  // [n_vertices] LIP id 0..19
  std::vector<float> rigidity;  // [n_vertices] paper Table 1
  RenderMesh render;
  ImageRgb texture;                // empty when the file has none
  std::vector<std::string> notes;  // what was defaulted or looks wrong, one line each

  int n_vertices() const { return mesh.n_vertices(); }
};

// Hanging cloth: dress, coat, jumpsuit, skirt, the softest class of the paper's Table 1 (and what has no label).
inline bool hangs(const Actor& actor, int vertex) {
  return actor.rigidity[vertex] <= 1;
}

// Reads an actor.glb. height_mm > 0 scales it so that the template (top to sole) has that height.
// Throws IoError naming the file and what is wrong (not a GLB, no skin, no mapped bones, vertex count out of range
// ...).
Actor load_actor(const std::filesystem::path& path, double height_mm = 0);

// The same from the bytes of a GLB; `name` stands for the file in messages.
Actor load_actor_bytes(const std::string& bytes, const std::string& name, double height_mm = 0);

}  // namespace livecap
