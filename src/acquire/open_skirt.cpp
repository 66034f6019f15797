#include "acquire/open_skirt.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "acquire/leg_line.h"

namespace livecap::acquire {
namespace {

using Eigen::Vector3d;

constexpr double kBelowHips = 0.2;  // of the leg's length: trousers meet higher
constexpr double kAboveHem = 60;    // mm: where hems that are not level are closed all around
// The roof, as authors of clothed characters close theirs (docs/experiments_actor.md, "A skirt that is closed
// lower"). Deeper would be vertices that nobody sees.
constexpr double kHemMm = 40;          // of cloth stay at the walls
constexpr double kRoofSlope = 0.7;     // 35 degrees
constexpr double kDeepestRoofMm = 60;  // above the lid
constexpr double kLegMm = 150;         // what reaches farther down than that below the slice is a leg

LegLine leg_of(const SpaceKeypoints& seen, int hip, int knee, int ankle) {
  return {seen[hip].position, seen[knee].position, seen[ankle].position};
}

// The columns of a horizontal slice that belong to the solid at (x, z) of `start`: 1.
std::vector<char> solid_in_slice(const Volume& volume, int y, const Vector3d& start) {
  std::vector<char> inside(static_cast<size_t>(volume.nx) * volume.nz, 0);
  const auto node = [&](double value, double low, int n) {
    return std::clamp(static_cast<int>(std::lround((value - low) / volume.step)), 0, n - 1);
  };
  const int x0 = node(start.x(), volume.low.x(), volume.nx), z0 = node(start.z(), volume.low.z(), volume.nz);
  std::vector<std::pair<int, int>> queue;
  const auto visit = [&](int x, int z) {
    if (x < 0 || z < 0 || x >= volume.nx || z >= volume.nz) return;
    char& mark = inside[static_cast<size_t>(z) * volume.nx + x];
    if (mark || volume.distance[volume.index(x, y, z)] >= 0) return;
    mark = 1;
    queue.emplace_back(x, z);
  };
  visit(x0, z0);
  for (size_t next = 0; next < queue.size(); ++next) {
    const auto [x, z] = queue[next];
    visit(x + 1, z), visit(x - 1, z), visit(x, z + 1), visit(x, z - 1);
  }
  return inside;
}

// Makes the marked nodes outside: distances anew around them, as far as a surface's neighbourhood is looked at.
bool take_out(const std::vector<char>& taken, Volume& volume) {
  constexpr int kReach = 5;  // nodes
  std::vector<std::array<int, 3>> ways;
  for (int z = -kReach; z <= kReach; ++z)
    for (int y = -kReach; y <= kReach; ++y)
      for (int x = -kReach; x <= kReach; ++x)
        if (x * x + y * y + z * z <= kReach * kReach && (x || y || z)) ways.push_back({x, y, z});
  std::sort(ways.begin(), ways.end(), [](const auto& a, const auto& b) {
    return a[0] * a[0] + a[1] * a[1] + a[2] * a[2] < b[0] * b[0] + b[1] * b[1] + b[2] * b[2];
  });
  const std::vector<float> before = volume.distance;
  const int counts[3] = {volume.nx, volume.ny, volume.nz};
  int low[3] = {volume.nx, volume.ny, volume.nz}, high[3] = {-1, -1, -1};  // of the marked nodes
  for (int z = 0; z < volume.nz; ++z)
    for (int y = 0; y < volume.ny; ++y)
      for (int x = 0; x < volume.nx; ++x) {
        if (!taken[volume.index(x, y, z)]) continue;
        const int at[3] = {x, y, z};
        for (int k = 0; k < 3; ++k) low[k] = std::min(low[k], at[k]), high[k] = std::max(high[k], at[k]);
      }
  if (high[0] < 0) return false;
  for (int k = 0; k < 3; ++k) {
    low[k] = std::max(0, low[k] - kReach);
    high[k] = std::min(counts[k] - 1, high[k] + kReach);
  }
  for (int z = low[2]; z <= high[2]; ++z)
    for (int y = low[1]; y <= high[1]; ++y)
      for (int x = low[0]; x <= high[0]; ++x) {
        const size_t i = volume.index(x, y, z);
        if (before[i] >= 0) continue;  // air as it was
        for (const auto& [dx, dy, dz] : ways) {
          if (x + dx < 0 || y + dy < 0 || z + dz < 0 || x + dx >= volume.nx || y + dy >= volume.ny ||
              z + dz >= volume.nz)
            continue;
          const size_t other = volume.index(x + dx, y + dy, z + dz);
          const bool solid = before[other] < 0 && !taken[other];
          if (taken[i] ? !solid : !taken[other]) continue;  // the nearest of the other kind
          const auto way = static_cast<float>(volume.step * (std::sqrt(dx * dx + dy * dy + dz * dz) - 0.5));
          volume.distance[i] = taken[i] ? way : std::max(before[i], -way);
          break;
        }
        if (taken[i] && volume.distance[i] < 0) volume.distance[i] = static_cast<float>(volume.step * kReach);
      }
  return true;
}

}  // namespace

bool open_skirt(const SpaceKeypoints& keypoints, Volume& volume) {
  for (int k : {kLeftHip, kRightHip, kLeftKnee, kRightKnee, kLeftAnkle, kRightAnkle})
    if (!keypoints[k].found) return false;
  const double hips = (keypoints[kLeftHip].position.y() + keypoints[kRightHip].position.y()) / 2;
  const double ankles = (keypoints[kLeftAnkle].position.y() + keypoints[kRightAnkle].position.y()) / 2;
  const double highest = hips - kBelowHips * (hips - ankles);
  const LegLine left = leg_of(keypoints, kLeftHip, kLeftKnee, kLeftAnkle),
                right = leg_of(keypoints, kRightHip, kRightKnee, kRightAnkle);
  double hem = ankles;
  while (hem < highest && !around_both_legs(left, right, volume, hem, 0)) hem += volume.step;
  const int slice = static_cast<int>(std::ceil((hem + kAboveHem - volume.low.y()) / volume.step));
  if (hem >= highest || slice < 1 || slice >= volume.ny) return false;

  const double y_slice = volume.low.y() + volume.step * slice;
  const std::vector<char> solid = solid_in_slice(volume, slice, (left.at(y_slice) + right.at(y_slice)) / 2);
  const int leg_nodes = static_cast<int>(kLegMm / volume.step);
  // The lowest node of the lid in every column; -1: a leg, or not of the solid.
  std::vector<int> bottom(solid.size(), -1);
  std::vector<std::pair<int, int>> walls;  // of air around the cloth
  for (int z = 0; z < volume.nz; ++z)
    for (int x = 0; x < volume.nx; ++x) {
      const size_t column = static_cast<size_t>(z) * volume.nx + x;
      int y = slice;
      while (solid[column] && y > 0 && slice - y <= leg_nodes && volume.distance[volume.index(x, y - 1, z)] < 0) --y;
      if (solid[column] && y > 0 && slice - y <= leg_nodes) bottom[column] = y;
    }
  const auto at = [&](int x, int z) {
    return x < 0 || z < 0 || x >= volume.nx || z >= volume.nz ? -1 : bottom[static_cast<size_t>(z) * volume.nx + x];
  };
  for (int z = 0; z < volume.nz; ++z)
    for (int x = 0; x < volume.nx; ++x)
      if (!solid[static_cast<size_t>(z) * volume.nx + x] &&
          std::max({at(x + 1, z), at(x - 1, z), at(x, z + 1), at(x, z - 1)}) >= 0)
        walls.emplace_back(x, z);

  std::vector<char> taken(volume.size(), 0);
  const int kSmooth = std::max(1, static_cast<int>(std::lround(40 / volume.step)));
  for (int z = 0; z < volume.nz; ++z)
    for (int x = 0; x < volume.nx; ++x) {
      if (at(x, z) < 0) continue;
      double nearest = 1e9;
      for (const auto& [wx, wz] : walls) nearest = std::min(nearest, std::hypot(x - wx, z - wz));
      // The lid is the hull of cones, and rough.
      double lid = 0;
      int n_near = 0;
      for (int dz = -kSmooth; dz <= kSmooth; ++dz)
        for (int dx = -kSmooth; dx <= kSmooth; ++dx)
          if (at(x + dx, z + dz) >= 0) lid += at(x + dx, z + dz), ++n_near;
      const double above = std::min(kRoofSlope * (nearest - kHemMm / volume.step), kDeepestRoofMm / volume.step);
      const double roof = lid / n_near + above;
      for (int y = at(x, z); y < volume.ny && y < roof; ++y) taken[volume.index(x, y, z)] = 1;
    }
  return take_out(taken, volume);
}

}  // namespace livecap::acquire
