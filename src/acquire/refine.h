// Hollows that no silhouette shows: vertices of the hull move inwards to where the pictures around them agree in
// colour.
#pragma once

#include <vector>

#include "texture/surface_views.h"

namespace livecap::acquire {

struct RefineResult {
  int n_evidence = 0;  // vertices whose pictures agree somewhere
};

// surface: rest frame, mm, moved in place. coverage: of the surface as it is. Vertices without evidence follow their
// neighbours and else stay.
RefineResult refine_by_color(const std::vector<View>& views, const std::vector<ViewCoverage>& coverage,
                             meshing::Surface& surface);

}  // namespace livecap::acquire
