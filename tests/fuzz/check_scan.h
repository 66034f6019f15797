// What read_scan() promises of every format.
#pragma once

#include "fuzz/fuzz.h"
#include "scan/scan.h"

namespace livecap::fuzz {

inline void check_scan(const Scan& scan) {
  const int n = static_cast<int>(scan.surface.vertices.size());
  for (const Eigen::Vector3d& p : scan.surface.vertices) require(p.allFinite(), "finite vertices");
  for (const Eigen::Vector3i& t : scan.surface.triangles)
    require(t.minCoeff() >= 0 && t.maxCoeff() < n, "triangles of the scan's vertices");
  for (int vertex : scan.vertex_of_file) require(vertex >= 0 && vertex < n, "vertices of the file that are the scan's");
  for (int t = 0; t < static_cast<int>(scan.surface.triangles.size()); ++t)
    for (int corner = 0; corner < 3; ++corner) {
      meshing::SurfacePoint point;
      point.triangle = t;
      point.weights[corner] = 1;
      require(scan.color_at(point).allFinite(), "finite colours");
    }
}

}  // namespace livecap::fuzz
