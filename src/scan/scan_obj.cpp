// Wavefront OBJ with the one texture of its materials, and colours behind the coordinates (MeshLab's way).
#include <algorithm>
#include <cstdlib>
#include <map>
#include <set>
#include <sstream>
#include <vector>

#include "base/number_text.h"
#include "base/text.h"
#include "image/image_io.h"
#include "livecap/error.h"
#include "scan/fill_uvs.h"
#include "scan/scan_files.h"

namespace livecap {

namespace {

// What follows the first word of a line, without the spaces around.
std::string rest_of(std::istringstream& fields) {
  std::string rest;
  std::getline(fields >> std::ws, rest);
  rest.erase(rest.find_last_not_of(" \t\r") + 1);
  return rest;
}

struct Material {
  std::string name;
  std::filesystem::path picture;  // empty: none
};

std::vector<Material> read_materials(const std::filesystem::path& file) {
  require_no_pipe(file);
  std::istringstream in(read_file(file));
  std::vector<Material> materials;
  for (std::string line; std::getline(in, line);) {
    std::istringstream fields(line);
    std::string key;
    fields >> key;
    if (key == "newmtl") materials.push_back({rest_of(fields), {}});
    if (key != "map_Kd") continue;
    if (materials.empty()) materials.emplace_back();
    const std::string name = rest_of(fields);
    if (!name.empty()) materials.back().picture = file.parent_path() / name;
  }
  return materials;
}

// What the faces' materials look like. More than one: they do not agree. Faces whose materials the file does not know
// have its first picture. used: the materials of faces, by name.
std::set<std::filesystem::path> pictures_of(const std::vector<Material>& materials,
                                            const std::map<std::string, int>& used) {
  std::set<std::filesystem::path> pictures;
  bool known = false;
  for (const Material& material : materials) {
    if (!used.count(material.name)) continue;
    known = true;
    if (!material.picture.empty()) pictures.insert(material.picture);
  }
  if (known) return pictures;
  for (const Material& material : materials)
    if (!material.picture.empty()) return {material.picture};
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
  std::filesystem::path material_file;
  std::string material;             // of the faces that follow
  std::map<std::string, int> used;  // a number for each material of faces
  std::vector<int> material_of;     // [n_triangles] its number
  bool every_corner_has_uv = true, any_corner_has_uv = false;
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
        const char* behind = read_number(at, line.c_str() + line.size(), out[n]);
        if (behind == at) break;
        at = behind;
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
      const int its_number = used.try_emplace(material, static_cast<int>(used.size())).first->second;
      for (size_t k = 2; k < corners.size(); ++k) {
        scan.surface.triangles.emplace_back(corners[0].first, corners[k - 1].first, corners[k].first);
        for (size_t c : {size_t{0}, k - 1, k}) {
          const bool has_uv = corners[c].second >= 0;
          every_corner_has_uv = every_corner_has_uv && has_uv;
          any_corner_has_uv = any_corner_has_uv || has_uv;
          scan.uvs.push_back(has_uv ? uvs[corners[c].second] : kNoUv);
        }
        material_of.push_back(its_number);
      }
    } else if (line.rfind("usemtl ", 0) == 0) {
      std::istringstream fields(line.substr(7));
      material = rest_of(fields);
    } else if (line.rfind("mtllib ", 0) == 0 && material_file.empty()) {
      std::istringstream fields(line.substr(7));
      material_file = path.parent_path() / rest_of(fields);
    }
  }
  if (scan.colors.size() != scan.surface.vertices.size()) scan.colors.clear();
  if (!texture.empty()) {
    if (!every_corner_has_uv || scan.uvs.empty())
      throw IoError(path.string() + ": a texture needs vt of every corner of every face, and " + texture.string() +
                    " was given");
    scan.texture = read_image_rgb(texture);
  } else if (any_corner_has_uv && !material_file.empty()) {
    try {
      const std::vector<Material> materials = read_materials(material_file);
      const std::set<std::filesystem::path> pictures = pictures_of(materials, used);
      if (pictures.size() > 1) {
        notes.push_back(path.string() + ": more than one texture; the scan is read without them");
      } else if (!pictures.empty()) {
        require_no_pipe(*pictures.begin());
        scan.texture = read_image_rgb(*pictures.begin());
        for (const Material& plain : materials)
          if (const auto found = used.find(plain.name); plain.picture.empty() && found != used.end())
            for (size_t i = 0; i < scan.uvs.size(); ++i)
              if (material_of[i / 3] == found->second) scan.uvs[i] = kNoUv;
      }
    } catch (const IoError& error) {
      notes.push_back(std::string(error.what()) + ": the scan is read without its texture");
    }
  }
  if (scan.texture.empty()) scan.uvs.clear();
  return scan;
}

}  // namespace livecap
