// The surface where the pictures' outlines have it. A carved hull is what lies inside of every silhouette, so wherever
// outlines are uncertain (pixels, blur of the grid) the innermost of them wins: limbs come out a millimetre too thin
// and shoes two per cent too short, and a capture takes a smaller shoe for a nearer one.
#pragma once

#include "acquire/seen_outlines.h"
#include "meshing/isosurface.h"
#include "ocl/context.h"
#include "views/view.h"

namespace livecap::acquire {

// Moves vertices along their normals until the surface, drawn into the views, ends where their masks end, in the mean
// of the views that see a place edge-on. Where no outline tells, vertices stay, and so do those below lowest_mm (Y);
// 20 mm above it they move wholly. views: in the surface's frame, mm;
// seen: seen_outlines(views).
void fit_outlines(ocl::DeviceContext& device, const std::vector<View>& views, const std::vector<SeenOutline>& seen,
                  double lowest_mm, meshing::Surface& surface);

}  // namespace livecap::acquire
