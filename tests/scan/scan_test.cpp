#include "scan/scan.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cstring>
#include <functional>
#include <sstream>

#include "actor/actor.h"
#include "base/text.h"
#include "image/image_io.h"
#include "livecap/error.h"
#include "support/comma_locale.h"
#include "support/tolerances.h"
#include "synth/synth.h"

namespace livecap {
namespace {

using Eigen::Vector3d;

class Scan : public testing::Test {
 protected:
  Scan() : folder_(std::filesystem::path(testing::TempDir()) / "scan_test") {
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    const meshing::DistanceField field = [](const Vector3d& p) { return p.norm() - 80; };
    ball_ = meshing::extract_surface(field, Vector3d::Constant(-120), Vector3d::Constant(120), 20);
  }
  ~Scan() override { std::filesystem::remove_all(folder_); }

  std::filesystem::path write(const char* name, const std::string& text) {
    write_file_atomically(folder_ / name, text);
    return folder_ / name;
  }
  std::string obj() const {
    std::string text = "# a ball\n";
    for (const Vector3d& p : ball_.vertices) text += format("v %.9g %.9g %.9g 1 0.5 0\n", p.x(), p.y(), p.z());
    for (const auto& t : ball_.triangles) text += format("f %d//1 %d//1 %d//1\n", t[0] + 1, t[1] + 1, t[2] + 1);
    return text;
  }
  std::string ply(bool binary) const {
    std::string text = format(
        "ply\nformat %s 1.0\nelement vertex %zu\nproperty float x\nproperty float y\nproperty float z\nproperty uchar "
        "red\nproperty uchar green\nproperty uchar blue\nelement face %zu\nproperty list uchar int "
        "vertex_indices\nend_header\n",
        binary ? "binary_little_endian" : "ascii", ball_.vertices.size(), ball_.triangles.size());
    const auto bytes = [&](const auto& value) { text.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
    for (const Vector3d& p : ball_.vertices) {
      if (!binary) text += format("%.9g %.9g %.9g 255 128 0\n", p.x(), p.y(), p.z());
      if (binary)
        for (int k = 0; k < 3; ++k) bytes(static_cast<float>(p[k]));
      if (binary)
        for (uint8_t c : {255, 128, 0}) bytes(c);
    }
    for (const auto& t : ball_.triangles) {
      if (!binary) text += format("3 %d %d %d\n", t[0], t[1], t[2]);
      if (binary) bytes(uint8_t{3});
      if (binary)
        for (int k = 0; k < 3; ++k) bytes(static_cast<int32_t>(t[k]));
    }
    return text;
  }
  std::string failure(const std::filesystem::path& path) {
    try {
      std::vector<std::string> notes;
      read_scan(path, notes);
    } catch (const IoError& error) {
      return error.what();
    }
    return "no error";
  }

  std::string bare(const char* name, size_t n, size_t n_all = 0) {
    return (folder_ / name).string() +
           format(": %zu of %zu triangles have no texture: they have the colour of what is beside them", n,
                  n_all > 0 ? n_all : ball_.triangles.size());
  }

  std::filesystem::path folder_;
  meshing::Surface ball_;
};

TEST_F(Scan, EveryFormatGivesTheSameMesh) {
  for (const auto& path : {write("a.obj", obj()), write("a.ply", ply(false)), write("b.ply", ply(true))}) {
    std::vector<std::string> notes;
    const livecap::Scan scan = read_scan(path, notes);
    EXPECT_TRUE(notes.empty());
    ASSERT_EQ(scan.surface.vertices.size(), ball_.vertices.size()) << path;
    ASSERT_EQ(scan.surface.triangles.size(), ball_.triangles.size()) << path;
    EXPECT_TRUE(is_closed_manifold(scan.surface));
    ASSERT_TRUE(scan.has_color());
    EXPECT_NEAR(scan.colors[5].x(), 1, 0.003);  // 8 bit
    EXPECT_NEAR(scan.colors[5].y(), 0.5, 0.003);
  }
}

TEST_F(Scan, NumbersHaveAPointInEveryLocale) {
  const auto an_obj = write("a.obj", obj()), a_ply = write("a.ply", ply(false));
  LIVECAP_COMMA_LOCALE_OR_SKIP(commas);
  for (const auto& path : {an_obj, a_ply}) {
    std::vector<std::string> notes;
    const livecap::Scan scan = read_scan(path, notes);
    ASSERT_EQ(scan.surface.vertices.size(), ball_.vertices.size()) << path;
    EXPECT_LT((scan.surface.vertices[5] - ball_.vertices[5]).norm(), test::kHandComputed);
  }
}

// A file that is inside out gives the same surface, and says so.
TEST_F(Scan, InsideOutIsTurned) {
  std::istringstream lines(obj());
  std::string inside_out;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string kind, a, b, c;
    words >> kind >> a >> b >> c;
    inside_out += kind == "f" ? "f " + a + " " + c + " " + b + "\n" : line + "\n";
  }
  std::vector<std::string> notes;
  const livecap::Scan scan = read_scan(write("out.obj", inside_out), notes);
  ASSERT_EQ(notes.size(), 1u);
  EXPECT_NE(notes[0].find("inside out"), std::string::npos);
  double volume = 0;
  for (const auto& t : scan.surface.triangles)
    volume += scan.surface.vertices[t[0]].dot(scan.surface.vertices[t[1]].cross(scan.surface.vertices[t[2]])) / 6;
  EXPECT_GT(volume, 0);
}

// One half mirrored from the other without turning its triangles, as modellers do; two balls of which one is inside
// out.
TEST_F(Scan, PartsThatLookInwardsAreTurned) {
  const auto enclosed = [](const meshing::Surface& surface) {
    double volume = 0;
    for (const auto& t : surface.triangles)
      volume += surface.vertices[t[0]].dot(surface.vertices[t[1]].cross(surface.vertices[t[2]])) / 6;
    return volume;
  };
  const double whole = enclosed(ball_);
  const meshing::Surface ball = ball_;
  size_t n_turned = 0;
  for (auto& t : ball_.triangles)
    if (ball.vertices[t[0]].x() < -5) std::swap(t[1], t[2]), ++n_turned;
  std::vector<std::string> notes;
  livecap::Scan scan = read_scan(write("half.obj", obj()), notes);
  EXPECT_NEAR(enclosed(scan.surface), whole, 1e-6 * whole);
  EXPECT_TRUE(is_closed_manifold(scan.surface));
  EXPECT_EQ(notes, std::vector<std::string>{(folder_ / "half.obj").string() +
                                            format(": %zu of %zu triangles looked inwards and have been turned",
                                                   n_turned, ball.triangles.size())});
  ball_ = ball;
  const int n = static_cast<int>(ball.vertices.size());
  for (const Vector3d& p : ball.vertices) ball_.vertices.push_back(p + Vector3d(300, 0, 0));
  for (const auto& t : ball.triangles) ball_.triangles.emplace_back(n + t[0], n + t[2], n + t[1]);
  scan = read_scan(write("two.obj", obj()), notes);
  EXPECT_NEAR(enclosed(scan.surface), 2 * whole, 1e-6 * whole);
}

TEST_F(Scan, ReadsARiggedGlbWithItsTexture) {
  const auto path = write("actor.glb", make_builtin_actor_glb("trousers", 1700, 2000));
  std::vector<std::string> notes;
  const livecap::Scan scan = read_scan(path, notes);
  const Actor actor = load_actor(path);
  EXPECT_EQ(static_cast<int>(scan.surface.vertices.size()), actor.n_vertices());
  EXPECT_FALSE(scan.texture.empty());
  EXPECT_EQ(scan.uvs.size(), 3 * scan.surface.triangles.size());
}

// glTF's vertex colours are linear; the scan's are encoded.
TEST_F(Scan, VertexColoursOfAGlbAreEncoded) {
  std::string data;
  const auto bytes = [&](const auto& value) { data.append(reinterpret_cast<const char*>(&value), sizeof(value)); };
  const size_t n = ball_.vertices.size(), m = ball_.triangles.size();
  for (const Vector3d& p : ball_.vertices)
    for (int k = 0; k < 3; ++k) bytes(static_cast<float>(p[k]));
  for (size_t i = 0; i < n; ++i)
    for (float c : {1.0f, 0.2140411f, 0.0f}) bytes(c);  // 0.2140411 is what 0.5 stands for
  for (const auto& t : ball_.triangles)
    for (int k = 0; k < 3; ++k) bytes(static_cast<uint32_t>(t[k]));
  std::string json = format(
      R"({"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"scene":0,"buffers":[{"byteLength":%zu}],)"
      R"("bufferViews":[{"buffer":0,"byteOffset":0,"byteLength":%zu},{"buffer":0,"byteOffset":%zu,"byteLength":%zu},)"
      R"({"buffer":0,"byteOffset":%zu,"byteLength":%zu}],"accessors":[{"bufferView":0,"componentType":5126,"count":%zu,)"
      R"("type":"VEC3","min":[-81,-81,-81],"max":[81,81,81]},{"bufferView":1,"componentType":5126,"count":%zu,"type":"VEC3"},)"
      R"({"bufferView":2,"componentType":5125,"count":%zu,"type":"SCALAR"}],)"
      R"("meshes":[{"primitives":[{"attributes":{"POSITION":0,"COLOR_0":1},"indices":2}]}]})",
      data.size(), 12 * n, 12 * n, 12 * n, 24 * n, 12 * m, n, n, 3 * m);
  json.resize((json.size() + 3) / 4 * 4, ' ');
  std::string glb = "glTF";
  const auto number = [&](size_t value) {
    const uint32_t v = static_cast<uint32_t>(value);
    glb.append(reinterpret_cast<const char*>(&v), 4);
  };
  number(2), number(12 + 8 + json.size() + 8 + data.size());
  number(json.size()), glb += "JSON" + json;
  number(data.size()), glb.append("BIN\0", 4), glb += data;
  std::vector<std::string> notes;
  const livecap::Scan scan = read_scan(write("ball.glb", glb), notes);
  ASSERT_EQ(scan.colors.size(), n);
  EXPECT_NEAR(scan.colors[3].x(), 1, test::kHandComputed);
  EXPECT_NEAR(scan.colors[3].y(), 0.5, test::kHandComputed);
  EXPECT_NEAR(scan.colors[3].z(), 0, test::kHandComputed);
}

TEST_F(Scan, FaultsNameTheFile) {
  const std::string text = obj(), binary = ply(true);
  EXPECT_NE(failure(folder_ / "none.obj").find("none.obj"), std::string::npos);
  EXPECT_NE(failure(write("a.stl", text)).find(".obj, .ply or .glb"), std::string::npos);
  EXPECT_NE(failure(write("few.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")).find("no scan of a person"),
            std::string::npos);
  EXPECT_NE(failure(write("bad.obj", text + "f 1 2 999999\n")).find("no vertex 999999"), std::string::npos);
  EXPECT_NE(failure(write("nan.obj", text + "v nan 0 0\n")).find("not finite"), std::string::npos);
  EXPECT_NE(failure(write("cut.ply", binary.substr(0, binary.size() / 2))).find("ends before"), std::string::npos);
  EXPECT_NE(failure(write("head.ply", binary.substr(0, 40))).find("end_header"), std::string::npos);
  std::string big = ply(false);
  big.replace(big.find("ascii"), 5, "binary_big_endian");
  EXPECT_NE(failure(write("big.ply", big)).find("little endian"), std::string::npos);
  EXPECT_NE(failure(write("cut.glb", "glTF")).find("cut.glb"), std::string::npos);
}

// A colour is looked up with them.
TEST_F(Scan, TextureCoordinatesAndColoursMustBeFinite) {
  write_png(ImageRgb{1, 1, {0, 0, 0}}, folder_ / "skin.png");
  write("skin.mtl", "map_Kd skin.png\n");
  std::string text = "mtllib skin.mtl\nvt inf 0\n" + obj();
  for (size_t at = 0; (at = text.find("//", at)) != std::string::npos;) text.erase(at, 1);
  EXPECT_NE(failure(write("uv.obj", text)).find("texture coordinate 0 is not finite"), std::string::npos);
  text = ply(false);
  text.replace(text.find("uchar red"), 9, "float red");
  text.replace(text.find(" 255 128"), 8, " nan 128");
  EXPECT_NE(failure(write("colour.ply", text)).find("colour of vertex 0 is not finite"), std::string::npos);
}

// Each of the "vertices" would take no byte of the file and 48 of memory, once for every line.
TEST_F(Scan, PlyElementsOfNothingAreRefused) {
  std::string text = "ply\nformat ascii 1.0\n";
  for (int i = 0; i < 1000; ++i) text += "element vertex 20000\n";
  EXPECT_NE(failure(write("nothing.ply", text + "end_header\n")).find("\"vertex\" has no property"), std::string::npos);
}

// Numbers that are not vertices, in every type that a list may have.
TEST_F(Scan, PlyIndicesMustBeVertices) {
  for (const char* index : {"nan", "1e+30", "-1", "0.5", "16777217"}) {
    std::string text = ply(false);
    text.replace(text.rfind("\n3 ") + 3, text.find(' ', text.rfind("\n3 ") + 3) - text.rfind("\n3 ") - 3, index);
    const std::filesystem::path file = write("index.ply", text);
    EXPECT_EQ(failure(file),
              file.string() + format(": face %zu: there is no vertex %s", ball_.triangles.size() - 1, index));
  }
}

TEST_F(Scan, PlyListsHaveAWholeNumberOfEntries) {
  for (const char* count : {"2.5", "-1", "nan"}) {
    std::string text = ply(false);
    text.replace(text.rfind("\n3 ") + 1, 1, count);
    const std::filesystem::path file = write("list.ply", text);
    EXPECT_EQ(failure(file),
              file.string() + format(": face %zu: a list of %s entries", ball_.triangles.size() - 1, count));
  }
}

// A PLY whose vertices have nothing but a place, or 16 bit colours, and whose faces have colours of their own.
TEST_F(Scan, PlyColoursAreThoseOfItsVertices) {
  for (const bool colored : {false, true}) {
    std::string text = format(
        "ply\nformat ascii 1.0\nelement vertex %zu\nproperty float x\nproperty float y\n"
        "property float z\n",
        ball_.vertices.size());
    if (colored) text += "property ushort red\nproperty ushort green\nproperty ushort blue\n";
    text += format(
        "element face %zu\nproperty list uchar int vertex_indices\nproperty uchar red\n"
        "property uchar green\nproperty uchar blue\nend_header\n",
        ball_.triangles.size());
    for (const Vector3d& p : ball_.vertices)
      text += format("%.9g %.9g %.9g%s\n", p.x(), p.y(), p.z(), colored ? " 65535 32768 0" : "");
    for (const auto& t : ball_.triangles) text += format("3 %d %d %d 10 20 30\n", t[0], t[1], t[2]);
    std::vector<std::string> notes;
    const livecap::Scan scan = read_scan(write("faces.ply", text), notes);
    EXPECT_EQ(scan.has_color(), colored);
    if (!colored) continue;
    EXPECT_LT((scan.colors[5] - Vector3d(1, 32768.0 / 65535, 0)).norm(), test::kHandComputed);
  }
}

// As with a GLB: which face has which picture is not kept.
TEST_F(Scan, ObjOfSeveralTexturesIsReadWithoutThem) {
  write_png(ImageRgb{1, 1, {250, 0, 0}}, folder_ / "skin.png");
  write_png(ImageRgb{1, 1, {0, 250, 0}}, folder_ / "cloth.png");
  write("two.mtl", "newmtl cloth\nmap_Kd cloth.png\r\nnewmtl skin 1\nKd 1 1 1\nmap_Kd skin.png\nnewmtl plain\n");
  std::string faces = obj();
  for (size_t at = 0; (at = faces.find("//", at)) != std::string::npos;) faces.replace(at, 2, "/");
  const size_t last = faces.rfind("f ");
  const auto read = [&](const std::string& first, const std::string& second, std::vector<std::string>& notes) {
    std::string text = faces;
    text.insert(last, second);
    text.insert(text.find("f "), first);
    return read_scan(write("two.obj", "mtllib two.mtl\nvt 0 0\n" + text), notes).texture.pixels;
  };
  std::vector<std::string> notes;
  EXPECT_EQ(read("usemtl skin 1\r\n", "", notes), (std::vector<uint8_t>{250, 0, 0})) << "not the first of the file";
  EXPECT_EQ(read("", "", notes), (std::vector<uint8_t>{0, 250, 0})) << "the first of the file";
  EXPECT_EQ(read("usemtl plain\n", "", notes), std::vector<uint8_t>());
  EXPECT_TRUE(notes.empty());
  EXPECT_EQ(read("usemtl skin 1\n", "usemtl cloth\n", notes), std::vector<uint8_t>());
  EXPECT_EQ(notes, std::vector<std::string>{(folder_ / "two.obj").string() +
                                            ": more than one texture; the scan is read without them"});
  notes.clear();
  EXPECT_EQ(read("usemtl skin 1\n", "usemtl plain\n", notes), (std::vector<uint8_t>{250, 0, 0}));
  EXPECT_EQ(notes, std::vector<std::string>{bare("two.obj", 1)});
}

// Red left and green right; faces of the upper half have no vt, and of a piece of its own one corner alone has one.
TEST_F(Scan, FacesWithoutTextureCoordinatesHaveTheColourBesideThem) {
  write_png(ImageRgb{2, 2, {250, 0, 0, 0, 250, 0, 0, 0, 250, 9, 9, 9}}, folder_ / "skin.png");
  write("skin.mtl", "newmtl skin\nmap_Kd skin.png\nnewmtl plain\n");
  const size_t n_ball = ball_.vertices.size();
  for (const bool far_piece : {false, true}) {
    std::string text = "mtllib skin.mtl\nusemtl skin\nvt 0.25 0.75\nvt 0.75 0.75\n";
    size_t n_bare = 0;
    for (const Vector3d& p : ball_.vertices) text += format("v %.9g %.9g %.9g\n", p.x(), p.y(), p.z());
    if (far_piece) text += "v 300 0 0\nv 300 9 0\nv 300 0 9\n";
    for (const auto& t : ball_.triangles) {
      const Vector3d& p = ball_.vertices[t[0]];
      const bool has_uv = p.y() < 0;
      n_bare += !has_uv;
      for (int k = 0; k < 3; ++k)
        text += (k == 0 ? "f " : " ") + std::to_string(t[k] + 1) + (!has_uv ? "" : p.x() < 0 ? "/1" : "/2");
      text += "\n";
    }
    if (far_piece) {
      text += format("f %zu %zu/1 %zu\nusemtl plain\n", n_ball + 1, n_ball + 2, n_ball + 3);
      text += format("f %zu/2 %zu/2 %zu/2\n", n_ball + 1, n_ball + 3, n_ball + 2);
      n_bare += 2;
    }
    std::vector<std::string> notes;
    const livecap::Scan scan = read_scan(write("holes.obj", text), notes);
    EXPECT_EQ(notes, std::vector<std::string>{bare("holes.obj", n_bare, ball_.triangles.size() + (far_piece ? 2 : 0))});
    ASSERT_EQ(scan.uvs.size(), 3 * scan.surface.triangles.size());
    for (size_t t = 0; t < scan.surface.triangles.size(); ++t) {
      const Vector3d color = scan.color_at({static_cast<int>(t), {1.0 / 3, 1.0 / 3, 1.0 / 3}});
      const double x = scan.surface.vertices[scan.surface.triangles[t][0]].x();
      EXPECT_LT(color.z(), 0.1) << "a place that no face has";
      if (t >= ball_.triangles.size()) EXPECT_GT(color.x(), 0.9) << "of the one corner";
      if (t < ball_.triangles.size() && std::abs(x) > 45) EXPECT_GT(x < 0 ? color.x() : color.y(), 0.9) << x;
    }
  }
}

// A pipe that nobody writes to: opened, it would wait for ever.
TEST_F(Scan, PipesAreNeitherMaterialNorTexture) {
  const std::filesystem::path pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  write("pipe.mtl", "map_Kd pipe\n");
  for (const char* material : {"pipe", "pipe.mtl"}) {
    std::string text = std::string("mtllib ") + material + "\nvt 0 0\n" + obj();
    for (size_t at = 0; (at = text.find("//", at)) != std::string::npos;) text.erase(at, 1);
    std::vector<std::string> notes;
    EXPECT_TRUE(read_scan(write("pipe.obj", text), notes).texture.empty());
    EXPECT_EQ(notes,
              std::vector<std::string>{
                  pipe.string() + ": is a pipe or a device, expected a file: the scan is read without its texture"});
  }
}

}  // namespace
}  // namespace livecap
