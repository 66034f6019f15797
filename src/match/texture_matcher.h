// Dense correspondences between the template and the picture: the actor is drawn with its texture, lit as far as the
// light is known, where it is thought to be, and small patches around its visible vertices are moved onto the camera's
// picture. Both pictures are normalised locally, so that how bright they are does not count. The paper's E_photo
// compares single vertex colours within a few px of the right place; this finds places from further away and tells in
// which direction it is certain of them.
//
//   TextureMatcher matcher(device, actor, camera, options);
//   matcher.set_picture(frame, silhouette.box);                    // once per frame
//   matcher.match(raster, positions, normals, visible, share, level); // `raster` has rendered `positions`
//   Matches matches = matcher.read();
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "actor/actor.h"
#include "geometry/shaded_vertex.h"
#include "geometry/vertex_match.h"
#include "image/device_frame.h"
#include "image/person_gate.h"
#include "match/harmonic_light.h"
#include "match/layout.h"
#include "ocl/buffer.h"
#include "ocl/kernel.h"
#include "raster/depth.h"

namespace livecap {

inline constexpr char kMatchProgram[] = "match/match.cl";
inline constexpr char kClothMatchProgram[] = "match/match_cloth.cl";

struct MatchOptions {
  int iterations = 4;
  float blur = 0.3f;             // of the drawn actor: what a neighbour of a pixel counts (kernels/match/blur.cl)
  float variance_floor = 5e-4f;  // of luminance in [0,1]: contrast below is noise
  float softness = 0.002f;       // contrast^2 per px^2 of normalised pictures whose direction counts half
  float max_move_px = 4;         // of the level; further away a match is accidental
  // Of the two patches: in stage I a match counts nothing there, all of its weight at 1. At true poses matches on shoes
  // are 1.2 to 1.5 px off with 0.6 to 0.8, 0.3 to 0.5 with more than 0.98.
  float min_correlation = 0.6f;
  float depth_range_mm = 80;  // pixels of a patch further from its vertex belong to another limb
  float weight_area_px = 25;  // a match that stands for so many pixels has weight 1

  void validate() const;  // throws ConfigError
};

struct Matches {
  std::vector<VertexMatch> found;  // by vertex
  double missed_weight = 0;        // what the visible vertices' weights fall short of that of perfect matches
  double seen_weight = 0;          // what all of those would weigh
};

class TextureMatcher {
 public:
  // Keeps no reference to the actor. camera: undistorted. program: kMatchProgram, or another one of the same kernels
  // for a second matcher whose queue works beside the first one's (ocl/program_twins.h).
  TextureMatcher(ocl::DeviceContext& device, const Actor& actor, const Camera& camera, const MatchOptions& options,
                 const char* program = kMatchProgram);

  // False for an actor without texture: then nothing is ever matched.
  bool usable() const { return texture_width_ > 0; }

  // person: the box around the silhouette. finest: level of the finest matches to come. Enqueued, nothing blocks.
  // Throws LogicError for a frame of another size.
  void set_picture(const DeviceFrame& frame, const PixelBox& person, int finest = 0);
  // The same without looking at the picture, for ActorSight.
  void set_box(const DeviceFrame& frame, const PixelBox& person);

  // How brightly the actor is lit at a normal (kernels/match/lit.h), from the next match on; 1 everywhere before the
  // first call.
  void set_light(const Light& light) { lit_by_ = light; }
  const Light& light() const { return lit_by_; }

  // raster: rendered the positions. positions, normals [3*n_vertices] mm and unit, camera frame; visible [n_vertices];
  // share [n_vertices]: factor of each vertex's weight, 0 = not wanted. level: pictures of 2^-level of the resolution,
  // 0..LC_MATCH_LEVELS (LogicError); coarse ones find what is further away and take less time. Enqueued.
  void match(const DepthRasterizer& raster, const ocl::Buffer<float>& positions, const ocl::Buffer<float>& normals,
             const ocl::Buffer<int32_t>& visible, const ocl::Buffer<float>& share, int level);

  // How bright the picture shows the vertices that the last match drew, if that was at level 0; otherwise nothing. With
  // the same arguments. Blocking.
  std::vector<LightSample> sample_light(const DeviceFrame& frame, const DepthRasterizer& raster,
                                        const ocl::Buffer<float>& positions, const ocl::Buffer<float>& normals,
                                        const ocl::Buffer<int32_t>& visible);

  // What the last match found. Blocking.
  Matches read();
  // In two parts: found() once a blocking read through the same queue has come after read_later().
  void read_later();
  Matches found() const;
  // What there is to read, on the device: [LC_MATCH*n_vertices]; and the px^2 of a match of weight 1.
  const ocl::Buffer<float>& matches() const { return matches_; }
  ocl::Buffer<float>& matches() { return matches_; }  // for who adds to them
  float weight_area_px() const { return options_.weight_area_px; }

 private:
  friend class ActorSight;  // does the same in one launch with more
  static void require_level(int level);
  MatchBox level_box(int level) const;
  int level_offset(int level) const;
  PatchOptions patch_options(int level) const;
  void normalise(int level, int offset, const ocl::Buffer<float>& light, ocl::Buffer<float>& normal);

  MatchOptions options_;
  int width_, height_;
  float focal_px_;
  int n_vertices_;
  bool is_cpu_;
  int texture_width_ = 0;
  struct Texture {
    int texels, width, height;  // of texture_, from `texels` on
  };
  std::array<Texture, LC_MATCH_LEVELS + 1> textures_{};  // by level
  MatchBox box_{0, 0, 0, 0};
  Light lit_by_{1};
  int drawn_level_ = -1, drawn_at_ = 0;  // of the last match, and where it lies in light_ and weight_
  std::vector<float> host_, light_host_;

  ocl::Buffer<uint16_t> texture_;  // luminance, see texel_pairs
  ocl::Buffer<float> uvs_;         // [6*n_triangles]
  ocl::Buffer<float> areas_;       // [n_vertices] mm^2
  ocl::Buffer<float> shade_;       // [n_vertices] see match/light.cl
  ocl::Buffer<float> light_;       // of the camera's pyramid, then of the actor
  ocl::Buffer<float> weight_;      // likewise
  ocl::Buffer<float> sums_;        // 3 boxes, on CPUs
  ocl::Buffer<float> blurred_;     // the actor's light, box of the level
  ocl::Buffer<float> actor_;       // box of the level
  ocl::Buffer<float> depth_;       // likewise
  ocl::Buffer<float> camera_;      // pyramid, full resolution first
  ocl::Buffer<float> matches_;     // [LC_MATCH*n_vertices], see match/layout.h
  ocl::Buffer<float> samples_;     // [LC_LIT_SAMPLE*n_vertices], likewise
  ocl::Kernel light_vertices_;
  ocl::Kernel textured_actor_;
  ocl::Kernel camera_picture_;
  ocl::Kernel blur_actor_;
  ocl::Kernel normalise_;
  ocl::Kernel halve_picture_;
  ocl::Kernel match_patches_;
  ocl::Kernel sample_light_;
};

// Known-answer tests of kernels/match.
std::vector<ocl::SelfTestResult> match_self_test(ocl::DeviceContext& device);

}  // namespace livecap
