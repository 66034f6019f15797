// Scans in glTF: where a file's transforms put the surface and its texture.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "actor/glb_fixture.h"
#include "base/text.h"
#include "image/image_io.h"
#include "scan/scan.h"
#include "support/tolerances.h"

namespace livecap {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;
using nlohmann::json;

constexpr double kRadius = 80;

// A ball around the origin; each vertex has its own place in the texture.
class ScanGlb : public testing::Test {
 protected:
  ScanGlb() : folder_(std::filesystem::path(testing::TempDir()) / "scan_glb_test") {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    ball_ = meshing::extract_surface([](const Vector3d& p) { return p.norm() - kRadius; }, Vector3d::Constant(-120),
                                     Vector3d::Constant(120), 20);
    std::vector<float> positions, uvs;
    std::vector<uint32_t> indices;
    for (const Vector3d& p : ball_.vertices) {
      for (int k = 0; k < 3; ++k) positions.push_back(static_cast<float>(p[k]));
      for (int k = 0; k < 2; ++k) uvs.push_back(static_cast<float>(uv_at(p)[k]));
    }
    for (const auto& t : ball_.triangles)
      for (int k = 0; k < 3; ++k) indices.push_back(static_cast<uint32_t>(t[k]));
    document_ = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", {0}}}}}};
    document_["nodes"] = {{{"mesh", 0}}};
    add(positions, 5126, "VEC3", 3);
    add(uvs, 5126, "VEC2", 2);
    add(indices, 5125, "SCALAR", 1);
    document_["meshes"] = {
        {{"primitives", {{{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}}, {"indices", 2}, {"material", 0}}}}}};
    const std::string png = encode_png(ImageRgb{1, 1, {9, 9, 9}});
    document_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bin_.size()}, {"byteLength", png.size()}});
    bin_ += png;
    bin_.resize((bin_.size() + 3) / 4 * 4);
    document_["buffers"] = {{{"byteLength", bin_.size()}}};
    document_["images"] = {{{"bufferView", 3}, {"mimeType", "image/png"}}};
    document_["textures"] = {{{"source", 0}}};
    document_["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  }
  ~ScanGlb() override { std::filesystem::remove_all(folder_); }

  template <typename T>
  void add(const std::vector<T>& data, int component_type, const char* type, size_t per_element) {
    const size_t size = data.size() * sizeof(T), view = document_["bufferViews"].size();
    document_["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", bin_.size()}, {"byteLength", size}});
    document_["accessors"].push_back({{"bufferView", view},
                                      {"componentType", component_type},
                                      {"count", data.size() / per_element},
                                      {"type", type}});
    bin_.append(reinterpret_cast<const char*>(data.data()), size);
  }
  static Vector2d uv_at(const Vector3d& p) { return {0.5 + p.x() / 400, 0.5 + p.y() / 400}; }

  std::filesystem::path write() {
    write_file_atomically(folder_ / "ball.glb", test::Fixture::pack(document_, bin_));
    return folder_ / "ball.glb";
  }
  Scan read() {
    Scan scan = read_scan(write(), notes_);
    EXPECT_EQ(scan.uvs.size(), 3 * scan.surface.triangles.size());
    return scan;
  }

  std::filesystem::path folder_;
  meshing::Surface ball_;
  json document_;
  std::string bin_;
  std::vector<std::string> notes_;
};

// One ball as it is and one that its node mirrors: the second's triangles run the other way around.
TEST_F(ScanGlb, WhatANodeMirrorsIsTurned) {
  document_["nodes"] = {{{"mesh", 0}}, {{"mesh", 0}, {"scale", {-1, 1, 1}}, {"translation", {500, 0, 0}}}};
  const Scan scan = read();
  EXPECT_TRUE(notes_.empty());
  EXPECT_EQ(scan.surface.triangles.size(), 2 * ball_.triangles.size());
  for (size_t i = 0; i < scan.surface.triangles.size(); ++i) {
    const auto& t = scan.surface.triangles[i];
    const Vector3d &a = scan.surface.vertices[t[0]], &b = scan.surface.vertices[t[1]], &c = scan.surface.vertices[t[2]];
    const bool mirrored = a.x() > 250;
    const Vector3d middle(mirrored ? 500 : 0, 0, 0);
    ASSERT_GT((b - a).cross(c - a).dot(a - middle), 0) << "triangle " << i << " looks outwards";
    for (int k = 0; k < 3; ++k) {
      Vector3d p = scan.surface.vertices[t[k]] - middle;
      if (mirrored) p.x() = -p.x();
      ASSERT_LT((scan.uvs[3 * i + k] - uv_at(p)).norm(), test::kHandComputed) << "corner " << k << " of " << i;
    }
  }
}

// A second ball that has no material, then one that has no coordinates, then another texture.
TEST_F(ScanGlb, APrimitiveWithoutTextureDoesNotCostTheOthersTheirs) {
  json plain = document_["meshes"][0]["primitives"][0], bare = plain;
  plain.erase("material");
  bare["attributes"].erase("TEXCOORD_0");
  document_["nodes"] = {{{"mesh", 0}}, {{"mesh", 1}, {"translation", {500, 0, 0}}}};
  const size_t n = ball_.triangles.size();
  for (const json& second : {plain, bare}) {
    document_["meshes"][1] = {{"primitives", {second}}};
    notes_.clear();
    const Scan scan = read();
    EXPECT_FALSE(scan.texture.empty());
    EXPECT_EQ(notes_, std::vector<std::string>{
                          (folder_ / "ball.glb").string() +
                          format(": %zu of %zu triangles have no texture: they have the colour of what is beside them",
                                 n, 2 * n)});
    for (size_t i = 3 * n; i < scan.uvs.size(); ++i)  // of the first ball's right end
      ASSERT_LT((scan.uvs[i] - uv_at({kRadius, 0, 0})).norm(), 0.1);
  }
  document_["meshes"][0]["primitives"] = {bare};
  notes_.clear();
  Scan scan = read_scan(write(), notes_);
  EXPECT_TRUE(scan.texture.empty());
  EXPECT_EQ(notes_, std::vector<std::string>{(folder_ / "ball.glb").string() +
                                             ": no texture coordinates; the scan is read without its texture"});
  document_["meshes"][0]["primitives"] = {document_["meshes"][0]["primitives"][0]};
  document_["meshes"][1]["primitives"][0]["material"] = 1;
  document_["materials"].push_back(document_["materials"][0]);
  document_["materials"][1]["pbrMetallicRoughness"]["baseColorTexture"]["index"] = 1;
  document_["textures"].push_back({{"source", 1}});
  document_["images"].push_back(document_["images"][0]);
  notes_.clear();
  scan = read_scan(write(), notes_);
  EXPECT_TRUE(scan.texture.empty());
  EXPECT_EQ(notes_, std::vector<std::string>{(folder_ / "ball.glb").string() +
                                             ": more than one texture; the scan is read without them"});
}

// gltfpack writes quantised coordinates so, and requires it; others only say that they use it.
TEST_F(ScanGlb, TheTextureOfAMaterialMayBeMoved) {
  json& texture = document_["materials"][0]["pbrMetallicRoughness"]["baseColorTexture"];
  texture["extensions"]["KHR_texture_transform"] = {
      {"offset", {0, 1}}, {"rotation", 1.5707963267948966}, {"scale", {0.5, 0.25}}};
  for (const char* list : {"extensionsUsed", "extensionsRequired"}) {
    document_[list] = {"KHR_texture_transform"};
    const Scan scan = read();
    for (size_t i = 0; i < scan.surface.triangles.size(); ++i)
      for (int k = 0; k < 3; ++k) {
        const Vector2d uv = uv_at(scan.surface.vertices[scan.surface.triangles[i][k]]);
        ASSERT_LT((scan.uvs[3 * i + k] - Vector2d(0.25 * uv.y(), 1 - 0.5 * uv.x())).norm(), test::kHandComputed);
      }
  }
  // Another set of coordinates, which only the transform names.
  texture["extensions"]["KHR_texture_transform"] = {{"texCoord", 1}, {"scale", {2, 2}}};
  json& attributes = document_["meshes"][0]["primitives"][0]["attributes"];
  attributes["TEXCOORD_1"] = 1;
  attributes.erase("TEXCOORD_0");
  const Scan scan = read();
  const Vector2d uv = uv_at(scan.surface.vertices[scan.surface.triangles[0][1]]);
  EXPECT_LT((scan.uvs[1] - 2 * uv).norm(), test::kHandComputed);
}

}  // namespace
}  // namespace livecap
