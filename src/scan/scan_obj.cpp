// Wavefront OBJ with the first texture of its material file, and colours behind the coordinates (MeshLab's way).
#include <algorithm>
#include <cstdlib>
#include <sstream>

#include "base/text.h"
#include "image/image_io.h"
#include "livecap/error.h"
#include "scan/scan_files.h"

namespace livecap {

namespace {

std::filesystem::path texture_of(const std::filesystem::path& material) {
  require_no_pipe(material);
  std::istringstream in(read_file(material));
  for (std::string line; std::getline(in, line);) {
    std::istringstream fields(line);
    std::string key, name;
    if (fields >> key && key == "map_Kd" && std::getline(fields >> std::ws, name)) {
      if (!name.empty() && name.back() == '\r') name.pop_back();
      return material.parent_path() / name;
    }
  }
  return {};
}

// An index of a face, 1-based or negative from the end; -1 when it is outside of [0, n).
int resolve(long index, size_t n) {
  const long at = index > 0 ? index - 1 : static_cast<long>(n) + index;
  return index != 0 && at >= 0 && at < static_cast<long>(n) ? static_cast<int>(at) : -1;
}

}  // namespace

Scan read_obj(const std::filesystem::path& path, std::vector<std::string>& notes,
              const std::filesystem::path& texture) {
  const std::string text = read_file(path);
  Scan scan;
  std::vector<Eigen::Vector2d> uvs;
  std::filesystem::path material;
  bool every_corner_has_uv = true;
  int number = 0;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find('\n', begin), text.size());
    const std::string line = text.substr(begin, end - begin);
    begin = end + 1;
    ++number;
    const char* at = line.c_str();
    char* next = nullptr;
    const auto numbers = [&](double* out, int most) {
      int n = 0;
      for (; n < most; ++n) {
        out[n] = std::strtod(at, &next);
        if (next == at) break;
        at = next;
      }
      return n;
    };
    if (line.rfind("v ", 0) == 0) {
      double x[6];
      at += 2;
      const int n = numbers(x, 6);
      if (n < 3) throw IoError(path.string() + format(": line %d: a vertex needs three numbers", number));
      scan.surface.vertices.emplace_back(x[0], x[1], x[2]);
      if (n == 6) scan.colors.emplace_back(x[3], x[4], x[5]);
    } else if (line.rfind("vt ", 0) == 0) {
      double x[2];
      at += 3;
      if (numbers(x, 2) < 2) throw IoError(path.string() + format(": line %d: vt needs two numbers", number));
      uvs.emplace_back(x[0], 1 - x[1]);
    } else if (line.rfind("f ", 0) == 0) {
      at += 2;
      std::vector<std::pair<int, int>> corners;
      while (true) {
        const long v = std::strtol(at, &next, 10);
        if (next == at) break;
        at = next;
        long t = 0;
        if (*at == '/') {
          t = std::strtol(++at, &next, 10);
          at = next;
          if (*at == '/') std::strtol(++at, &next, 10), at = next;
        }
        const int vertex = resolve(v, scan.surface.vertices.size());
        if (vertex < 0) throw IoError(path.string() + format(": line %d: there is no vertex %ld", number, v));
        corners.emplace_back(vertex, resolve(t, uvs.size()));
      }
      for (size_t k = 2; k < corners.size(); ++k) {
        scan.surface.triangles.emplace_back(corners[0].first, corners[k - 1].first, corners[k].first);
        for (size_t c : {size_t{0}, k - 1, k}) {
          every_corner_has_uv = every_corner_has_uv && corners[c].second >= 0;
          scan.uvs.push_back(corners[c].second >= 0 ? uvs[corners[c].second] : Eigen::Vector2d(0, 0));
        }
      }
    } else if (line.rfind("mtllib ", 0) == 0 && material.empty()) {
      std::string name = line.substr(7);
      while (!name.empty() && (name.back() == '\r' || name.back() == ' ')) name.pop_back();
      material = path.parent_path() / name;
    }
  }
  if (scan.colors.size() != scan.surface.vertices.size()) scan.colors.clear();
  const bool has_uvs = every_corner_has_uv && !scan.uvs.empty();
  if (!texture.empty()) {
    if (!has_uvs)
      throw IoError(path.string() + ": a texture needs vt of every corner of every face, and " + texture.string() +
                    " was given");
    scan.texture = read_image_rgb(texture);
  } else if (has_uvs && !material.empty()) {
    try {
      if (const auto picture = texture_of(material); !picture.empty()) {
        require_no_pipe(picture);
        scan.texture = read_image_rgb(picture);
      }
    } catch (const IoError& error) {
      notes.push_back(std::string(error.what()) + ": the scan is read without its texture");
    }
  }
  if (scan.texture.empty()) scan.uvs.clear();
  return scan;
}

}  // namespace livecap
