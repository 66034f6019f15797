#include "scan/scan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string_view>
#include <unordered_map>

#include "base/text.h"
#include "geometry/disjoint_sets.h"
#include "livecap/error.h"
#include "scan/fill_uvs.h"
#include "scan/orient.h"
#include "scan/scan_files.h"

namespace livecap {

namespace {

using Eigen::Vector3d;

struct PositionHash {
  size_t operator()(const Vector3d& p) const {
    return std::hash<std::string_view>{}(std::string_view(reinterpret_cast<const char*>(p.data()), sizeof(double) * 3));
  }
};

// Equal positions become one vertex; triangles without three different vertices go.
void weld(Scan& scan) {
  std::unordered_map<Vector3d, int, PositionHash> ids;
  std::vector<int> id;
  meshing::Surface surface;
  std::vector<Vector3d> colors;
  for (size_t i = 0; i < scan.surface.vertices.size(); ++i) {
    const Vector3d p = scan.surface.vertices[i] + Vector3d::Zero();  // no -0
    const auto [found, is_new] = ids.try_emplace(p, static_cast<int>(surface.vertices.size()));
    if (is_new) {
      surface.vertices.push_back(p);
      if (!scan.colors.empty()) colors.push_back(scan.colors[i]);
    }
    id.push_back(found->second);
  }
  std::vector<Eigen::Vector2d> uvs;
  for (size_t t = 0; t < scan.surface.triangles.size(); ++t) {
    const auto& tri = scan.surface.triangles[t];
    const Eigen::Vector3i welded(id[tri[0]], id[tri[1]], id[tri[2]]);
    if (welded[0] == welded[1] || welded[1] == welded[2] || welded[2] == welded[0]) continue;
    surface.triangles.push_back(welded);
    if (!scan.uvs.empty()) uvs.insert(uvs.end(), &scan.uvs[3 * t], &scan.uvs[3 * t] + 3);
  }
  scan.surface = std::move(surface);
  scan.colors = std::move(colors);
  scan.uvs = std::move(uvs);
  scan.vertex_of_file = std::move(id);
}

// Texts may say "nan", and bytes hold anything.
template <typename Points>
void require_finite(const Points& points, const char* what, const std::filesystem::path& path) {
  for (size_t i = 0; i < points.size(); ++i)
    if (!points[i].allFinite()) throw IoError(path.string() + format(": %s %zu is not finite", what, i));
}

uint64_t edge_key(int a, int b) {
  return static_cast<uint64_t>(static_cast<uint32_t>(a)) << 32 | static_cast<uint32_t>(b);
}

}  // namespace

Vector3d Scan::color_at(const meshing::SurfacePoint& point) const {
  if (!texture.empty()) {
    const Eigen::Vector2d* c = &uvs[3 * point.triangle];
    const Eigen::Vector2d uv = point.weights[0] * c[0] + point.weights[1] * c[1] + point.weights[2] * c[2];
    const auto wrap = [](double x) { return x - std::floor(x); };
    const int x = std::min(texture.width - 1, static_cast<int>(wrap(uv.x()) * texture.width)),
              y = std::min(texture.height - 1, static_cast<int>(wrap(uv.y()) * texture.height));
    const uint8_t* p = &texture.pixels[3 * (static_cast<size_t>(y) * texture.width + x)];
    return Vector3d(p[0], p[1], p[2]) / 255;
  }
  if (colors.empty()) return Vector3d::Constant(0.6);
  const auto& t = surface.triangles[point.triangle];
  return point.weights[0] * colors[t[0]] + point.weights[1] * colors[t[1]] + point.weights[2] * colors[t[2]];
}

Scan read_scan(const std::filesystem::path& path, std::vector<std::string>& notes,
               const std::filesystem::path& texture) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  if (!texture.empty() && extension != ".obj")
    throw IoError(path.string() + ": a texture of its own can only be given to an .obj");
  Scan scan;
  if (extension == ".obj")
    scan = read_obj(path, notes, texture);
  else if (extension == ".ply")
    scan = read_ply(path, notes);
  else if (extension == ".glb")
    scan = read_glb_scan(path, notes);
  else
    throw IoError(path.string() + ": a scan must be .obj, .ply or .glb");
  require_finite(scan.surface.vertices, "vertex", path);
  require_finite(scan.colors, "the colour of vertex", path);
  require_finite(scan.uvs, "texture coordinate", path);
  const size_t n_read = scan.surface.triangles.size();
  weld(scan);
  if (scan.surface.triangles.size() < 100)
    throw IoError(path.string() + format(": %zu triangles are no scan of a person", scan.surface.triangles.size()));
  if (const size_t n = fill_uvs(scan); n > 0)
    notes.push_back(path.string() +
                    format(": %zu of %zu triangles have no texture: they have the colour of what is beside "
                           "them",
                           n, scan.surface.triangles.size()));
  // Files may be inside out, or mirrored in parts.
  if (const size_t n = orient(scan.surface, scan.uvs), n_all = scan.surface.triangles.size(); n == n_all)
    notes.push_back(path.string() + ": the surface was inside out and has been turned");
  else if (n > 0)
    notes.push_back(path.string() + format(": %zu of %zu triangles looked inwards and have been turned", n, n_all));
  if (scan.surface.triangles.size() < n_read)
    notes.push_back(path.string() +
                    format(": %zu triangles without area left out", n_read - scan.surface.triangles.size()));
  return scan;
}

bool is_closed_manifold(const meshing::Surface& surface) {
  std::unordered_map<uint64_t, int> opposite;  // directed edge -> the triangle it belongs to
  opposite.reserve(3 * surface.triangles.size());
  std::vector<int> fan(surface.vertices.size(), 0);
  for (size_t t = 0; t < surface.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      const auto& tri = surface.triangles[t];
      if (!opposite.emplace(edge_key(tri[k], tri[(k + 1) % 3]), tri[(k + 2) % 3]).second) return false;
      ++fan[tri[k]];
    }
  for (const auto& [key, corner] : opposite)
    if (!opposite.count(key << 32 | key >> 32)) return false;
  // Walking around a vertex must meet all its triangles.
  std::vector<char> checked(surface.vertices.size(), 0);
  for (const auto& tri : surface.triangles)
    for (int k = 0; k < 3; ++k) {
      const int v = tri[k];
      if (checked[v]) continue;
      checked[v] = 1;
      const int first = tri[(k + 1) % 3];
      int at = first, count = 0;
      do {
        at = opposite.at(edge_key(v, at));  // the triangle v, at, corner: the next edge starts at its corner
        ++count;
      } while (at != first && count <= fan[v]);
      if (count != fan[v]) return false;
    }
  return true;
}

double keep_largest_piece(Scan& scan) {
  const meshing::Surface& surface = scan.surface;
  DisjointSets pieces(static_cast<int>(surface.vertices.size()));
  for (const auto& t : surface.triangles)
    for (int k = 1; k < 3; ++k) pieces.join(t[k], t[0]);
  std::unordered_map<int, double> area;
  double total = 0;
  for (const auto& t : surface.triangles) {
    const Vector3d& a = surface.vertices[t[0]];
    const double size = (surface.vertices[t[1]] - a).cross(surface.vertices[t[2]] - a).norm();
    area[pieces.find(t[0])] += size;
    total += size;
  }
  int best = -1;
  for (const auto& [piece, size] : area)
    if (best < 0 || size > area[best] || (size == area[best] && piece < best)) best = piece;
  Scan kept;
  std::vector<int> id(surface.vertices.size(), -1);
  for (size_t i = 0; i < surface.triangles.size(); ++i) {
    const auto& t = surface.triangles[i];
    if (pieces.find(t[0]) != best) continue;
    Eigen::Vector3i moved;
    for (int k = 0; k < 3; ++k) {
      if (id[t[k]] < 0) {
        id[t[k]] = static_cast<int>(kept.surface.vertices.size());
        kept.surface.vertices.push_back(surface.vertices[t[k]]);
        if (!scan.colors.empty()) kept.colors.push_back(scan.colors[t[k]]);
      }
      moved[k] = id[t[k]];
      if (!scan.uvs.empty()) kept.uvs.push_back(scan.uvs[3 * i + k]);
    }
    kept.surface.triangles.push_back(moved);
  }
  const double dropped = 1 - area[best] / total;
  kept.texture = std::move(scan.texture);
  scan = std::move(kept);
  return dropped;
}

}  // namespace livecap
