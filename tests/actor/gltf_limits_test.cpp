// Small files that ask for much memory or time.
#include <gtest/gtest.h>

#include <algorithm>

#include "actor/actor.h"
#include "actor/glb_fixture.h"
#include "base/text.h"
#include "livecap/error.h"

namespace livecap {
namespace {

using nlohmann::json;
using test::Fixture;
using test::make_fixture;

std::string message_of(const json& document, const std::string& bin) {
  try {
    load_actor_bytes(Fixture::pack(document, bin), "small.glb");
  } catch (const IoError& e) {
    return e.what();
  }
  return "";
}

// Puts bytes behind the others; returns their buffer view.
size_t append(json& document, std::string& bin, const std::string& bytes) {
  json& views = document["bufferViews"];
  views.push_back({{"buffer", 0}, {"byteOffset", bin.size()}, {"byteLength", bytes.size()}});
  bin += bytes;
  bin.resize((bin.size() + 3) / 4 * 4);
  document["buffers"][0]["byteLength"] = bin.size();
  return views.size() - 1;
}

size_t accessor(json& document, size_t view, int component_type, size_t count, const char* type) {
  document["accessors"].push_back(
      {{"bufferView", view}, {"componentType", component_type}, {"count", count}, {"type", type}});
  return document["accessors"].size() - 1;
}

// A black picture, as PNG without compression; readers do not look at its checksums.
std::string black_png(int width, int height) {
  const auto big_endian = [](uint32_t v) {
    return std::string{static_cast<char>(v >> 24), static_cast<char>(v >> 16), static_cast<char>(v >> 8),
                       static_cast<char>(v)};
  };
  const auto chunk = [&](const std::string& type, const std::string& data) {
    return big_endian(static_cast<uint32_t>(data.size())) + type + data + big_endian(0);
  };
  const size_t size = static_cast<size_t>(width + 1) * height;  // every row begins with the number of its filter
  std::string zlib = "\x78\x01";
  for (size_t at = 0; at < size;) {
    const auto n = static_cast<uint16_t>(std::min<size_t>(size - at, 0xffff));
    at += n;
    zlib += at == size ? '\1' : '\0';
    for (const uint16_t length : {n, static_cast<uint16_t>(~n)})
      zlib += {static_cast<char>(length & 0xff), static_cast<char>(length >> 8)};
    zlib += std::string(n, '\0');
  }
  return "\x89PNG\r\n\x1a\n" + chunk("IHDR", big_endian(width) + big_endian(height) + std::string("\x08\0\0\0\0", 5)) +
         chunk("IDAT", zlib + big_endian(0)) + chunk("IEND", "");
}

// Two narrow pictures side by side in one texture, which is as high as the one and as wide as the other.
TEST(GltfLimits, TexturesSideBySide) {
  const auto with_sides = [](int side) {
    Fixture f = make_fixture();
    json primitive = f.document["meshes"][0]["primitives"][0];
    json& primitives = f.document["meshes"][0]["primitives"];
    primitives.clear();
    for (int i = 0; i < 2; ++i) {
      const size_t view = append(f.document, f.bin, i == 0 ? black_png(side, 1) : black_png(1, side));
      f.document["images"].push_back({{"bufferView", view}, {"mimeType", "image/png"}});
      f.document["textures"].push_back({{"source", i}});
      f.document["materials"].push_back({{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
      primitive["material"] = i;
      primitives.push_back(primitive);
    }
    return message_of(f.document, f.bin);
  };
  EXPECT_EQ(with_sides(100), "");
  EXPECT_EQ(with_sides(20000),
            "small.glb: the textures of all materials side by side are 20001 x 20000 pixels, too large");
}

// Triangles of one vertex, from the same indices again and again.
TEST(GltfLimits, Triangles) {
  Fixture f = make_fixture();
  const size_t zeros = append(f.document, f.bin, std::string(3000, '\0'));
  json primitive = f.document["meshes"][0]["primitives"][0];
  for (auto& [name, index] : primitive["attributes"].items()) {
    json one = f.document["accessors"][index.get<size_t>()];
    one["count"] = 1;
    f.document["accessors"].push_back(one);
    index = f.document["accessors"].size() - 1;
  }
  primitive["indices"] = accessor(f.document, zeros, 5123, 1500, "SCALAR");
  for (int i = 0; i < 1000; ++i) f.document["meshes"][0]["primitives"].push_back(primitive);
  EXPECT_EQ(message_of(f.document, f.bin), format("small.glb: more than %d triangles", 8 * kMaxVertices));
}

// The same bones and weights again and again.
TEST(GltfLimits, SkinAttributes) {
  Fixture f = make_fixture();
  json& attributes = f.document["meshes"][0]["primitives"][0]["attributes"];
  for (int set = 1; set < 200; ++set) {
    attributes["JOINTS_" + std::to_string(set)] = attributes["JOINTS_0"];
    attributes["WEIGHTS_" + std::to_string(set)] = attributes["WEIGHTS_0"];
  }
  EXPECT_EQ(message_of(f.document, f.bin), "small.glb: meshes[0].primitives[0].JOINTS_16: at most 16 sets");
}

// Nodes one below the other, all of them meshes of a skin that has all of them as its bones, though they do not stand
// where it was bound.
Fixture chain(int n_nodes) {
  Fixture f = make_fixture();
  json& nodes = f.document["nodes"];
  json& skin = f.document["skins"][0];
  const json& binds = f.document["accessors"][skin["inverseBindMatrices"].get<size_t>()];
  const json& view = f.document["bufferViews"][binds["bufferView"].get<size_t>()];
  std::string matrices = f.bin.substr(view["byteOffset"].get<size_t>(), view["byteLength"].get<size_t>());
  const size_t n_bones = binds["count"].get<size_t>() + n_nodes;
  f.document["meshes"].push_back({{"primitives", json::array()}});
  nodes.back()["children"] = {nodes.size()};
  const Eigen::Matrix4f identity = Eigen::Matrix4f::Identity();
  for (int i = 0; i < n_nodes; ++i) {
    skin["joints"].push_back(nodes.size());
    matrices.append(reinterpret_cast<const char*>(identity.data()), sizeof(float) * identity.size());
    nodes.push_back({{"mesh", 1}, {"skin", 0}, {"children", {nodes.size() + 1}}});
  }
  nodes.push_back(json::object());
  skin["inverseBindMatrices"] = accessor(f.document, append(f.document, f.bin, matrices), 5126, n_bones, "MAT4");
  return f;
}

TEST(GltfLimits, AncestorsOfANode) {
  const Fixture few = chain(1000), many = chain(1100);
  EXPECT_EQ(message_of(few.document, few.bin), "");
  EXPECT_EQ(message_of(many.document, many.bin),
            format("small.glb: nodes[%zu] has more than 1024 ancestors, or is its own",
                   make_fixture().document["nodes"].size() + 1023));
}

// Where the bones of a skin stand is computed once, and said once, not for every mesh.
TEST(GltfLimits, MeshesOfOneSkin) {
  const Fixture f = chain(20);
  const std::vector<std::string> notes = load_actor_bytes(Fixture::pack(f.document, f.bin), "small.glb").notes;
  EXPECT_EQ(std::count(notes.begin(), notes.end(),
                       "the file's default pose differs from its bind pose; the bind pose is used"),
            1);
}

}  // namespace
}  // namespace livecap
