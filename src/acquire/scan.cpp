#include "acquire/scan.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <numeric>
#include <string_view>
#include <unordered_map>

#include "acquire/scan_files.h"
#include "base/text.h"
#include "livecap/error.h"
#include "raster/overlay.h"

namespace livecap::acquire {

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

namespace {

// Files that are inside out, or mirrored by a transform, enclose a negative volume.
void turn_outwards(Scan& scan, const std::filesystem::path& path, std::vector<std::string>& notes) {
  Vector3d middle = Vector3d::Zero();
  for (const Vector3d& p : scan.surface.vertices) middle += p / static_cast<double>(scan.surface.vertices.size());
  double volume = 0;
  for (const auto& t : scan.surface.triangles) {
    const auto corner = [&](int k) -> Vector3d { return scan.surface.vertices[t[k]] - middle; };
    volume += corner(0).dot(corner(1).cross(corner(2)));
  }
  if (volume >= 0) return;
  for (size_t i = 0; i < scan.surface.triangles.size(); ++i) {
    std::swap(scan.surface.triangles[i][1], scan.surface.triangles[i][2]);
    if (!scan.uvs.empty()) std::swap(scan.uvs[3 * i + 1], scan.uvs[3 * i + 2]);
  }
  notes.push_back(path.string() + ": the surface was inside out and has been turned");
}

}  // namespace

Scan read_scan(const std::filesystem::path& path, std::vector<std::string>& notes) {
  std::string extension = path.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return std::tolower(c); });
  Scan scan;
  if (extension == ".obj")
    scan = read_obj(path, notes);
  else if (extension == ".ply")
    scan = read_ply(path, notes);
  else if (extension == ".glb")
    scan = read_glb_scan(path, notes);
  else
    throw IoError(path.string() + ": a scan must be .obj, .ply or .glb");
  for (const Vector3d& p : scan.surface.vertices)
    if (!p.allFinite()) throw IoError(path.string() + ": a vertex is not finite");
  const size_t n_read = scan.surface.triangles.size();
  weld(scan);
  if (scan.surface.triangles.size() < 100)
    throw IoError(path.string() + format(": %zu triangles are no scan of a person", scan.surface.triangles.size()));
  turn_outwards(scan, path, notes);
  if (scan.surface.triangles.size() < n_read)
    notes.push_back(path.string() +
                    format(": %zu triangles without area left out", n_read - scan.surface.triangles.size()));
  return scan;
}

std::vector<View> photograph_scan(const Scan& scan, int n_views) {
  Vector3d low = Vector3d::Constant(1e300), high = -low;
  for (const Vector3d& p : scan.surface.vertices) low = low.cwiseMin(p), high = high.cwiseMax(p);
  const Vector3d size = high - low;
  // Scans stand along Y or, from some tools, along Z.
  const bool z_up = size.z() > 1.3 * size.y();
  const double scale = 1700 / (z_up ? size.z() : size.y());
  Eigen::Matrix3d turn = Eigen::Matrix3d::Identity();
  if (z_up) turn << 1, 0, 0, 0, 0, 1, 0, -1, 0;
  Actor actor;
  for (const Vector3d& p : scan.surface.vertices) {
    const Vector3d q = scale * (turn * (p - (low + high) / 2));
    for (int k = 0; k < 3; ++k) actor.mesh.positions.push_back(static_cast<float>(q[k]));
  }
  for (size_t t = 0; t < scan.surface.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k) {
      actor.mesh.triangles.push_back(scan.surface.triangles[t][k]);
      actor.render.triangles.push_back(static_cast<int32_t>(actor.render.template_vertex.size()));
      actor.render.template_vertex.push_back(scan.surface.triangles[t][k]);
      const Eigen::Vector2d uv = scan.uvs.empty() ? Eigen::Vector2d(0, 0) : scan.uvs[3 * t + k];
      actor.render.uvs.insert(actor.render.uvs.end(), {static_cast<float>(uv.x()), static_cast<float>(uv.y())});
    }
  actor.texture = scan.texture;
  for (const Vector3d& c : scan.colors)
    for (int k = 0; k < 3; ++k) actor.colors.push_back(static_cast<float>(c[k]));
  if (scan.colors.empty()) actor.colors.assign(actor.mesh.positions.size(), 0.6f);

  std::vector<View> views;
  constexpr int kWidth = 480, kHeight = 640;
  for (int i = 0; i < n_views; ++i) {
    const double angle = 2 * M_PI * i / n_views, rise = i % 2 ? 0.25 : -0.05;
    View view;
    view.name = format("scan from %.0f degrees", angle * 180 / M_PI);
    view.camera = camera_from_fov(kWidth, kHeight, 42);
    const Vector3d from =
        2700 * Vector3d(std::sin(angle) * std::cos(rise), std::sin(rise), std::cos(angle) * std::cos(rise));
    const Vector3d forward = -from.normalized(), right = forward.cross(Vector3d::UnitY()).normalized();
    Eigen::Matrix3d rotation;
    rotation << right.transpose(), forward.cross(right).transpose(), forward.transpose();
    std::vector<float> positions(actor.mesh.positions.size());
    for (size_t k = 0; k < positions.size(); k += 3) {
      const Vector3d p = rotation * (Eigen::Map<const Eigen::Vector3f>(&actor.mesh.positions[k]).cast<double>() - from);
      for (int j = 0; j < 3; ++j) positions[k + j] = static_cast<float>(p[j]);
    }
    ImageRgb wall{kWidth, kHeight, std::vector<uint8_t>(size_t(3) * kWidth * kHeight, 200)};
    OverlayOptions options;
    options.alpha = 1;
    options.texture = scan.has_color();
    view.image = render_overlay(actor, positions, view.camera, wall, options);
    view.camera_from_world.linear() = rotation * turn;
    view.camera_from_world.translation() = -rotation * (turn * (low + high) / 2) - rotation * from / scale;
    views.push_back(std::move(view));
  }
  return views;
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

double keep_largest_piece(meshing::Surface& surface) {
  std::vector<int> parent(surface.vertices.size());
  std::iota(parent.begin(), parent.end(), 0);
  const auto root = [&](int v) {
    while (parent[v] != v) v = parent[v] = parent[parent[v]];
    return v;
  };
  for (const auto& t : surface.triangles)
    for (int k = 1; k < 3; ++k) parent[root(t[k])] = root(t[0]);
  std::unordered_map<int, double> area;
  double total = 0;
  for (const auto& t : surface.triangles) {
    const Vector3d& a = surface.vertices[t[0]];
    const double size = (surface.vertices[t[1]] - a).cross(surface.vertices[t[2]] - a).norm();
    area[root(t[0])] += size;
    total += size;
  }
  int best = -1;
  for (const auto& [piece, size] : area)
    if (best < 0 || size > area[best] || (size == area[best] && piece < best)) best = piece;
  meshing::Surface kept;
  std::vector<int> id(surface.vertices.size(), -1);
  for (const auto& t : surface.triangles) {
    if (root(t[0]) != best) continue;
    Eigen::Vector3i moved;
    for (int k = 0; k < 3; ++k) {
      if (id[t[k]] < 0) {
        id[t[k]] = static_cast<int>(kept.vertices.size());
        kept.vertices.push_back(surface.vertices[t[k]]);
      }
      moved[k] = id[t[k]];
    }
    kept.triangles.push_back(moved);
  }
  const double dropped = 1 - area[best] / total;
  surface = std::move(kept);
  return dropped;
}

}  // namespace livecap::acquire
