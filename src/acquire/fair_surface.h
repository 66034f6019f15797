// The surface between its outlines. A carved hull is all that no silhouette cuts away: webs in the armpits, square
// undersides of arms, a filled crotch where the cameras stand at one height. But only where lines of sight graze the
// hull for a short way do they say where the body is; what lies between is the smoothest surface that these places
// hold.
#pragma once

#include "meshing/isosurface.h"
#include "scan/volume.h"
#include "views/view.h"

namespace livecap::acquire {

// Moves vertices inwards to where sum |L x|^2 + sum w |x - x0|^2 has them: L is the umbrella
// Laplacian, w how surely outlines hold a vertex (sum over the views on whose outline it lies, less where a line of
// sight runs along the hull for longer). No farther than a part of the body's thickness. Vertices below lowest_mm (Y)
// stay; 20 mm above it they move wholly. Without outlines nothing moves. views, hull (negative inside): in the
// surface's frame, mm.
void fair_surface(const std::vector<View>& views, const Volume& hull, double lowest_mm, meshing::Surface& surface);

}  // namespace livecap::acquire
