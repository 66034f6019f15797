#include "scan/volume.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "livecap/error.h"

namespace livecap {

namespace {

using Eigen::Vector3d;

constexpr double kMostNodes = 1 << 28;

// Labels the face-connected regions of the `member` nodes; sizes by region.
std::vector<int> regions(const Volume& volume, const std::vector<char>& member, std::vector<size_t>& sizes) {
  std::vector<int> region(volume.size(), -1);
  std::vector<size_t> queue;
  for (size_t seed = 0; seed < region.size(); ++seed) {
    if (!member[seed] || region[seed] >= 0) continue;
    const int id = static_cast<int>(sizes.size());
    region[seed] = id;
    queue.assign(1, seed);
    for (size_t next = 0; next < queue.size(); ++next) {
      const size_t at = queue[next];
      const int x = static_cast<int>(at % volume.nx), y = static_cast<int>(at / volume.nx % volume.ny),
                z = static_cast<int>(at / (static_cast<size_t>(volume.nx) * volume.ny));
      const auto visit = [&](bool exists, size_t other) {
        if (exists && member[other] && region[other] < 0) {
          region[other] = id;
          queue.push_back(other);
        }
      };
      const size_t row = volume.nx, slab = static_cast<size_t>(volume.nx) * volume.ny;
      visit(x > 0, at - 1);
      visit(x + 1 < volume.nx, at + 1);
      visit(y > 0, at - row);
      visit(y + 1 < volume.ny, at + row);
      visit(z > 0, at - slab);
      visit(z + 1 < volume.nz, at + slab);
    }
    sizes.push_back(queue.size());
  }
  return region;
}

}  // namespace

double Volume::at(const Vector3d& p) const {
  const Vector3d last(nx - 1, ny - 1, nz - 1);
  const Vector3d q = (p - low) / step;
  const Vector3d c = q.cwiseMax(Vector3d::Zero()).cwiseMin(last);
  const int x = std::min(static_cast<int>(c.x()), nx - 2), y = std::min(static_cast<int>(c.y()), ny - 2),
            z = std::min(static_cast<int>(c.z()), nz - 2);
  const double fx = c.x() - x, fy = c.y() - y, fz = c.z() - z;
  const float* d = &distance[index(x, y, z)];
  const size_t row = nx, slab = static_cast<size_t>(nx) * ny;
  const auto along_x = [&](size_t offset) { return (1 - fx) * d[offset] + fx * d[offset + 1]; };
  return (1 - fz) * ((1 - fy) * along_x(0) + fy * along_x(row)) +
         fz * ((1 - fy) * along_x(slab) + fy * along_x(slab + row)) + step * (q - c).norm();
}

Volume make_volume(const Vector3d& low, const Vector3d& high, double step) {
  const Vector3d nodes = ((high - low) / step).array().ceil().max(1) + 1;
  if (!(high - low).allFinite() || !(nodes.prod() <= kMostNodes))
    throw ConfigError(
        format("a solid of %.2f x %.2f x %.2f m on a grid of %g mm has more than 268 million nodes; the "
               "person has to be alone in it and the --unit right, or a hull's --grid coarser",
               (high - low).x() / 1000, (high - low).y() / 1000, (high - low).z() / 1000, step));
  Volume volume;
  volume.low = low;
  volume.step = step;
  volume.nx = static_cast<int>(nodes.x());
  volume.ny = static_cast<int>(nodes.y());
  volume.nz = static_cast<int>(nodes.z());
  volume.distance.assign(volume.size(), 0);
  return volume;
}

std::pair<Vector3d, Vector3d> bounds_within(const Volume& volume, double reach) {
  Vector3d low = Vector3d::Constant(1e9), high = -low;
  for (int z = 0; z < volume.nz; ++z)
    for (int y = 0; y < volume.ny; ++y)
      for (int x = 0; x < volume.nx; ++x) {
        if (volume.distance[volume.index(x, y, z)] >= reach) continue;
        const Vector3d p = volume.low + volume.step * Vector3d(x, y, z);
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
      }
  return {low - Vector3d::Constant(reach), high + Vector3d::Constant(reach)};
}

void blur(Volume& volume, double sigma_mm, double keep_mm) {
  const double sigma = sigma_mm / volume.step;
  const int radius = static_cast<int>(std::ceil(2.5 * sigma));
  if (radius < 1) return;
  std::vector<float> taps(2 * radius + 1);
  float sum = 0;
  for (int i = -radius; i <= radius; ++i)
    sum += taps[i + radius] = static_cast<float>(std::exp(-0.5 * (i / sigma) * (i / sigma)));
  for (float& tap : taps) tap /= sum;
  const int counts[3] = {volume.nx, volume.ny, volume.nz};
  const size_t strides[3] = {1, static_cast<size_t>(volume.nx), static_cast<size_t>(volume.nx) * volume.ny};
  std::vector<float> line;
  const std::vector<float> sharp = volume.distance;
  for (int axis = 0; axis < 3; ++axis) {
    const int n = counts[axis], m1 = counts[(axis + 1) % 3], m2 = counts[(axis + 2) % 3];
    const size_t stride = strides[axis], s1 = strides[(axis + 1) % 3], s2 = strides[(axis + 2) % 3];
    line.resize(n);
    for (int j = 0; j < m2; ++j)
      for (int i = 0; i < m1; ++i) {
        float* first = &volume.distance[i * s1 + j * s2];
        for (int k = 0; k < n; ++k) line[k] = first[k * stride];
        for (int k = 0; k < n; ++k) {
          float value = 0;
          for (int t = -radius; t <= radius; ++t) value += taps[t + radius] * line[std::clamp(k + t, 0, n - 1)];
          first[k * stride] = value;
        }
      }
  }
  const float keep = static_cast<float>(keep_mm);
  for (size_t i = 0; i < sharp.size(); ++i) volume.distance[i] = std::min(volume.distance[i], sharp[i] + keep);
}

int keep_largest_solid(Volume& volume) {
  const float outside = static_cast<float>(volume.step);
  for (int z = 0; z < volume.nz; ++z)
    for (int y = 0; y < volume.ny; ++y)
      for (int x = 0; x < volume.nx; ++x)
        if (x == 0 || y == 0 || z == 0 || x == volume.nx - 1 || y == volume.ny - 1 || z == volume.nz - 1) {
          float& d = volume.distance[volume.index(x, y, z)];
          d = std::max(d, outside);
        }
  std::vector<char> member(volume.size());
  for (size_t i = 0; i < member.size(); ++i) member[i] = volume.distance[i] < 0;
  std::vector<size_t> sizes;
  const std::vector<int> solid = regions(volume, member, sizes);
  if (sizes.empty()) return 0;
  const int largest = static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  const double litre_nodes = 1e6 / std::pow(volume.step, 3);
  int dropped = 0;
  for (size_t i = 0; i < sizes.size(); ++i) dropped += static_cast<int>(i) != largest && sizes[i] > litre_nodes;
  for (size_t i = 0; i < member.size(); ++i) {
    if (solid[i] >= 0 && solid[i] != largest) volume.distance[i] = outside;
    member[i] = solid[i] != largest;
  }
  std::vector<size_t> free_sizes;
  const std::vector<int> space = regions(volume, member, free_sizes);
  const int open = space[0];  // a corner of the grid
  for (size_t i = 0; i < member.size(); ++i)
    if (member[i] && space[i] != open) volume.distance[i] = -outside;
  return dropped;
}

meshing::Surface surface_of(const Volume& volume) {
  const meshing::DistanceField field = [&](const Vector3d& p) { return volume.at(p); };
  const Vector3d inset = Vector3d::Constant(1e-6 * volume.step);
  meshing::Surface surface = meshing::extract_surface(field, volume.low, volume.high() - inset, volume.step);
  if (surface.triangles.empty()) throw ConfigError("there is no solid to take a surface of");
  return surface;
}

}  // namespace livecap
