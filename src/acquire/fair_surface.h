// The surface between its outlines. A carved hull is all that no silhouette cuts away: webs in the armpits, square
// undersides of arms, a filled crotch where the cameras stand at one height. A line of sight that grazes the hull for a
// short way says where the body is, one that runs along it for long does not: there the surface becomes the smoothest
// one that the other places hold.
#pragma once

#include "acquire/seen_outlines.h"
#include "meshing/isosurface.h"
#include "scan/volume.h"

namespace livecap::acquire {

// Moves vertices to where sum |L x|^2 + sum w |x - x0|^2 has them, if that is inwards: L is the umbrella Laplacian, w
// how surely outlines hold a vertex: of three views at most on whose outline it lies, less where the line of sight runs
// along the hull for longer. At most 40 mm and three tenths of the thickness. Vertices below lowest_mm (Y) stay; 20 mm
// above it they move wholly. Without outlines nothing moves. hull: what was carved; solid: what the surface is of, open
// below a skirt (both negative inside). All in the surface's frame, mm.
void fair_surface(const std::vector<SeenOutline>& seen, const Volume& hull, const Volume& solid, double lowest_mm,
                  meshing::Surface& surface);

}  // namespace livecap::acquire
