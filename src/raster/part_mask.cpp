#include "raster/part_mask.h"

#include <algorithm>
#include <cctype>
#include <string>

#include "base/text.h"
#include "livecap/error.h"
#include "raster/layout.h"

namespace livecap {
namespace {

constexpr char kPartFile[] = "raster/raster.cl";
constexpr size_t kLocalX = 16;

bool has_any(const std::string& name, std::initializer_list<const char*> words) {
  return std::any_of(words.begin(), words.end(),
                     [&](const char* word) { return name.find(word) != std::string::npos; });
}

int part_of_name(std::string name, int parents_part) {
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  if (has_any(name, {"neck", "head"})) return kHead;
  if (has_any(name, {"root", "pelvis", "spine", "chest", "clavicle"})) return kTorso;
  const bool left = has_any(name, {"left"});
  const bool right = has_any(name, {"right"});
  if (left || right) {
    if (has_any(name, {"shoulder", "arm", "elbow", "wrist", "hand"})) return left ? kLeftArm : kRightArm;
    if (has_any(name, {"hip", "leg", "knee", "ankle", "foot", "toe"})) return left ? kLeftLeg : kRightLeg;
  }
  return parents_part;
}

}  // namespace

std::vector<int32_t> body_parts_of_bones(const Skeleton& skeleton) {
  std::vector<int32_t> parts;
  for (const Bone& bone : skeleton.bones) {
    parts.push_back(bone.parent < 0 ? kTorso : part_of_name(bone.name, parts[bone.parent]));
  }
  return parts;
}

std::vector<int32_t> body_parts_of_vertices(const Skeleton& skeleton, const SkinWeights& skin) {
  const std::vector<int32_t> bone_part = body_parts_of_bones(skeleton);
  std::vector<int32_t> parts(skin.weights.size() / kMaxInfluences);
  for (size_t i = 0; i < parts.size(); ++i) {
    const auto first = skin.weights.begin() + kMaxInfluences * i;
    const auto strongest = std::max_element(first, first + kMaxInfluences);
    parts[i] = bone_part.at(skin.bones[strongest - skin.weights.begin()]);
  }
  return parts;
}

PartMask::PartMask(ocl::DeviceContext& device, const Mesh& mesh, const std::vector<int32_t>& vertex_part, int width,
                   int height, int dilation_px)
    : width_(width), height_(height), dilation_px_(dilation_px) {
  if (width <= 0 || height <= 0)
    throw ConfigError(format("part mask: image size %dx%d is not positive", width, height));
  if (dilation_px < 0 || dilation_px >= LC_PART_PAD)
    throw ConfigError(format("part mask: dilation of %d px, must be 0..%d", dilation_px, LC_PART_PAD - 1));
  if (vertex_part.size() != static_cast<size_t>(mesh.n_vertices()))
    throw LogicError(format("part mask: %zu parts for %d vertices", vertex_part.size(), mesh.n_vertices()));
  for (int32_t part : vertex_part) {
    if (part <= kNoPart || part >= kBodyPartCount)
      throw LogicError(format("part mask: part id %d, must be 1..%d", part, kBodyPartCount - 1));
  }
  std::vector<int32_t> triangle_part(mesh.n_triangles());
  for (int t = 0; t < mesh.n_triangles(); ++t) {
    const int a = vertex_part[mesh.triangles[3 * t]];
    const int b = vertex_part[mesh.triangles[3 * t + 1]];
    const int c = vertex_part[mesh.triangles[3 * t + 2]];
    triangle_part[t] = b == c ? b : a;
  }
  n_groups_ = (width + LC_PART_PIXELS - 1) / LC_PART_PIXELS;
  stride_ = n_groups_ * LC_PART_PIXELS + 2 * LC_PART_PAD;
  vertex_part_ = ocl::Buffer<int32_t>(device, vertex_part);
  triangle_part_ = ocl::Buffer<int32_t>(device, triangle_part);
  const std::vector<uint8_t> zeros(size_t(stride_) * (height + 2 * dilation_px + LC_PART_ROWS), 0);
  bits_ = ocl::Buffer<uint8_t>(device, zeros);
  grown_ = ocl::Buffer<uint8_t>(device, zeros);
  part_image_ = ocl::Buffer<uint8_t>(device, size_t(width) * height);
  bits_kernel_ = ocl::Kernel(device, kPartFile, "part_bits");
  rows_kernel_ = ocl::Kernel(device, kPartFile, "part_grow_rows");
  columns_kernel_ = ocl::Kernel(device, kPartFile, "part_grow_columns");
}

void PartMask::update(const DepthRasterizer& raster) {
  if (raster.width() != width_ || raster.height() != height_ ||
      static_cast<size_t>(raster.n_triangles()) != triangle_part_.size())
    throw LogicError("part mask: the rasteriser has another size or mesh");
  auto range = [&](size_t columns, int rows) {
    return ocl::Range{(columns + kLocalX - 1) / kLocalX * kLocalX, static_cast<size_t>(rows), kLocalX, 1};
  };
  bits_kernel_.launch(range(n_groups_, height_), width_, height_, stride_, dilation_px_,
                      raster.drawn() ? *raster.drawn() : raster.triangle_ids(), raster.triangle_ids(), triangle_part_,
                      bits_);
  rows_kernel_.launch(range(n_groups_, height_), n_groups_, height_, stride_, dilation_px_, bits_, grown_);
  columns_kernel_.launch(range(n_groups_, (height_ + LC_PART_ROWS - 1) / LC_PART_ROWS), n_groups_, width_, height_,
                         stride_, dilation_px_, bits_, grown_, part_image_);
}

}  // namespace livecap
