// Scans: .obj with its material file, and .ply.
#include "base/text.h"
#include "fuzz/check_scan.h"
#include "fuzz/fuzz.h"
#include "image/image_io.h"

namespace livecap::fuzz {
namespace {

constexpr int kSide = 8;  // vertices a side of a sheet of 98 triangles, and two more
const std::vector<std::string> kFiles = {"scan.obj", "scan.mtl", "scan.ply"};

// Every way to name a corner, or with a texture coordinate each, which the texture is used for.
std::string obj(bool textured) {
  std::string text = "mtllib scan.mtl\n";
  for (int i = 0; i < kSide * kSide; ++i)
    text += format("v %d %d %g 1 0.5 0\nvt %g %g\n", i % kSide, i / kSide, 0.1 * (i % 3), i / 64.0, 0.5);
  for (int y = 0; y + 1 < kSide; ++y)
    for (int x = 1; x < kSide; ++x) {
      const int i = y * kSide + x, j = i + kSide;
      text += textured ? format("f %d/%d %d/%d %d/%d %d/%d\n", i, i, i + 1, i + 1, j + 1, j + 1, j, j)
                       : format("f %d/%d %d/%d/1 %d//1 %d\n", i, i, i + 1, i + 1, j + 1, j);
    }
  return text + (textured ? "f -1/-1 -2/-2 -10/-10 -9/-9\n" : "f -1 -2 -10 -9\n");
}

std::string ply(bool binary) {
  std::string text = format(
      "ply\nformat %s 1.0\ncomment made by hand\nelement vertex %d\nproperty float x\nproperty double y\nproperty "
      "short "
      "z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nelement face %d\nproperty list uchar int "
      "vertex_indices\nend_header\n",
      binary ? "binary_little_endian" : "ascii", kSide * kSide, 2 * (kSide - 1) * (kSide - 1) + 2);
  const auto put = [&](auto value, bool last = false) {
    if (binary)
      text.append(reinterpret_cast<const char*>(&value), sizeof(value));
    else
      text += format("%g%c", static_cast<double>(value), last ? '\n' : ' ');
  };
  for (int i = 0; i < kSide * kSide; ++i) {
    put(static_cast<float>(i % kSide)), put(static_cast<double>(i / kSide)), put(static_cast<int16_t>(i % 3));
    put(uint8_t{255}), put(uint8_t{128}), put(static_cast<uint8_t>(i), true);
  }
  const auto face = [&](int a, int b, int c) { put(uint8_t{3}), put(a), put(b), put(c, true); };
  for (int y = 0; y + 1 < kSide; ++y)
    for (int x = 0; x + 1 < kSide; ++x) {
      const int i = y * kSide + x;
      face(i, i + 1, i + kSide), face(i + 1, i + kSide + 1, i + kSide);
    }
  face(0, 1, 2), face(1, 2, 3);
  return text;
}

}  // namespace

std::vector<std::string> seeds() {
  const std::string material = "newmtl skin\nmap_Kd skin.png\n";
  return {join_files({{"scan.obj", obj(false)}, {"scan.mtl", material}}),
          join_files({{"scan.obj", obj(true)}, {"scan.mtl", material}}), join_files({{"scan.ply", ply(false)}}),
          join_files({{"scan.ply", ply(true)}})};
}

}  // namespace livecap::fuzz

extern "C" int LLVMFuzzerTestOneInput(const uint8_t* data, size_t size) {
  using namespace livecap;
  static const fuzz::ScratchFolder folder;
  const auto files = fuzz::split_files({reinterpret_cast<const char*>(data), size}, fuzz::kFiles);
  folder.hold(files);
  if (files.count("scan.mtl")) write_png(ImageRgb{2, 1, {255, 0, 0, 0, 0, 255}}, folder.path() / "skin.png");
  for (const char* name : {"scan.obj", "scan.ply"}) {
    if (!files.count(name)) continue;
    const std::filesystem::path file = folder.path() / name;
    fuzz::accepts(file.string(), [&] {
      std::vector<std::string> notes;
      fuzz::check_scan(read_scan(file, notes));
    });
  }
  return 0;
}
