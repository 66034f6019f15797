// Hollows that no silhouette shows: vertices of the hull move inwards to where the pictures around them agree in
// colour.
#pragma once

#include <vector>

#include "texture/surface_views.h"

namespace livecap::acquire {

struct RefineOptions {
  double deepest_mm = 45;    // how far a vertex may sink
  double step_mm = 3;        // of the search
  double spacing_mm = 3.5;   // between the samples of a patch of 7 x 7
  double least_score = 0.8;  // correlation that counts as agreement
  double stiffness = 4;      // of neighbours against one vertex with full agreement
};

struct RefineResult {
  int n_evidence = 0;  // vertices whose pictures agree somewhere
};

// surface: rest frame, mm, moved in place. coverage: of the surface as it is. Vertices without evidence follow their
// neighbours and else stay.
RefineResult refine_by_color(const std::vector<View>& views, const std::vector<ViewCoverage>& coverage,
                             const RefineOptions& options, meshing::Surface& surface);

}  // namespace livecap::acquire
